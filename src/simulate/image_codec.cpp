// One model for both directions: predict, code the difference, adapt.
#include "src/simulate/image_codec.h"

#include "src/core/error.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>

namespace eventide {

namespace {

constexpr int kEscape = 24;  // zeros before a difference told in eight plain bits

class BitWriter {
public:
    void put(unsigned value, int bits) {
        for (int i = bits - 1; i >= 0; --i) {
            held_ = (held_ << 1) | ((value >> i) & 1);
            if (++count_ == 8) flush();
        }
    }
    std::vector<std::byte> finish() {
        while (count_ != 0) put(0, 1);
        return std::move(bytes_);
    }

private:
    void flush() {
        bytes_.push_back(std::byte(held_));
        held_ = 0;
        count_ = 0;
    }
    std::vector<std::byte> bytes_;
    unsigned held_ = 0;
    int count_ = 0;
};

class BitReader {
public:
    explicit BitReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
    unsigned bit() {
        if (at_ >= bytes_.size() * 8)
            throw Error(ErrorKind::input, "a texture pack's image ends before its last pixel");
        const unsigned byte = std::to_integer<unsigned>(bytes_[at_ / 8]);
        const unsigned value = (byte >> (7 - at_ % 8)) & 1;
        ++at_;
        return value;
    }
    unsigned take(int bits) {
        unsigned value = 0;
        while (bits-- > 0) value = (value << 1) | bit();
        return value;
    }

private:
    std::span<const std::byte> bytes_;
    std::size_t at_ = 0;
};

/// What both sides know of a pixel before it is told.
class Model {
public:
    explicit Model(const GreyImage& image) : image_(image) {}

    void look(int y, int x) {
        const int left = at(y, x - 1), above = at(y - 1, x), corner = at(y - 1, x - 1);
        const int right = at(y - 1, x + 1);
        prediction_ =
            std::clamp(left + above - corner, std::min(left, above), std::max(left, above));
        // Busy and quiet places have differences of different size: eight kinds of surroundings.
        const int activity =
            std::abs(left - corner) + std::abs(corner - above) + std::abs(above - right);
        context_ = &contexts_[std::size_t(std::min(7, int(std::bit_width(unsigned(activity)))))];
        rice_ = 0;
        while ((context_->count << rice_) < context_->sum && rice_ < 7) ++rice_;
    }
    void learn(unsigned folded) {
        context_->sum += folded;
        if (++context_->count < 64) return;
        context_->sum /= 2;
        context_->count /= 2;
    }
    int prediction() const { return prediction_; }
    int rice() const { return rice_; }

private:
    struct Context {
        unsigned sum = 8, count = 1;
    };
    int at(int y, int x) const {
        if (y < 0) return x > 0 ? 0 : 128;
        if (x < 0) return y > 0 ? int(image_(y - 1, 0)) : 128;
        return int(image_(y, std::min(x, image_.width() - 1)));
    }

    const GreyImage& image_;
    std::array<Context, 8> contexts_;
    Context* context_ = nullptr;
    int prediction_ = 0, rice_ = 0;
};

/// 0 -1 1 -2 2 ... -> 0 1 2 3 4 ..., differences taken modulo 256.
unsigned fold(int difference) {
    const auto d = std::int8_t(difference);
    return d >= 0 ? 2u * unsigned(d) : 2u * unsigned(-(d + 1)) + 1u;
}
int unfold(unsigned folded) {
    return folded % 2 == 0 ? int(folded / 2) : -int(folded / 2) - 1;
}

}  // namespace

std::vector<std::byte> encode_grey(const GreyImage& image) {
    BitWriter bits;
    Model model{image};
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) {
            model.look(y, x);
            const unsigned folded = fold(int(image(y, x)) - model.prediction());
            const int zeros = int(folded >> model.rice());
            if (zeros < kEscape) {
                bits.put(1, zeros + 1);
                bits.put(folded & ((1u << model.rice()) - 1), model.rice());
            } else {
                bits.put(0, kEscape);
                bits.put(folded, 8);
            }
            model.learn(folded);
        }
    return bits.finish();
}

GreyImage decode_grey(std::span<const std::byte> code, int height, int width) {
    GreyImage image(height, width);
    BitReader bits{code};
    Model model{image};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            model.look(y, x);
            int zeros = 0;
            while (zeros < kEscape && bits.bit() == 0) ++zeros;
            const unsigned folded = zeros == kEscape
                                        ? bits.take(8)
                                        : unsigned(zeros) << model.rice() | bits.take(model.rice());
            image(y, x) = std::uint8_t(model.prediction() + unfold(folded));
            model.learn(folded);
        }
    return image;
}

}  // namespace eventide
