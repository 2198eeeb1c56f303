// The pack's file: a header, and one code per image.
#include "src/simulate/scene/texture_pack.h"

#include "src/core/error.h"
#include "src/io/input_file.h"
#include "src/io/output_file.h"
#include "src/simulate/image_codec.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <span>
#include <string_view>

namespace eventide {

namespace {

constexpr std::string_view kMagic = "EVTEXTURES1\n";
constexpr std::uint32_t kLargestSide = 16384;

void put(std::vector<std::byte>& out, std::uint32_t value) {
    for (int i = 0; i < 4; ++i) out.push_back(std::byte(value >> (8 * i)));
}

Error bad(const std::filesystem::path& file, const std::string& what) {
    return {ErrorKind::input, file.string() + ": expected a pack of textures, found " + what};
}

class PackReader {
public:
    explicit PackReader(const std::filesystem::path& file)
        : file_(file), bytes_(read_bytes_of_file(file)) {
        if (bytes_.size() < kMagic.size() ||
            std::memcmp(bytes_.data(), kMagic.data(), kMagic.size()) != 0)
            throw bad(file, "another beginning");
        at_ = kMagic.size();
    }
    std::span<const std::byte> take(std::size_t n) {
        if (n > bytes_.size() - at_) throw bad(file_, "an early end");
        at_ += n;
        return std::span{bytes_}.subspan(at_ - n, n);
    }
    std::uint32_t number() {
        std::uint32_t value = 0;
        const auto bytes = take(4);
        for (std::size_t i = 4; i-- > 0;)
            value = value << 8 | std::to_integer<std::uint32_t>(bytes[i]);
        return value;
    }
    std::uint32_t side() {
        const std::uint32_t n = number();
        if (n < 2 || n > kLargestSide) throw bad(file_, "a side of " + std::to_string(n) + " px");
        return n;
    }
    bool at_end() const { return at_ == bytes_.size(); }

private:
    std::filesystem::path file_;
    std::vector<std::byte> bytes_;
    std::size_t at_ = 0;
};

/// Calls take(i, height, width, code) for each image.
template <typename Take>
void read_pack(const std::filesystem::path& file, Take take) {
    PackReader reader{file};
    const std::uint32_t count = reader.number();
    for (std::uint32_t i = 0; i < count; ++i) {
        const int width = int(reader.side()), height = int(reader.side());
        const std::uint32_t length = reader.number();
        const auto code = reader.take(length);
        // A pixel takes at least a bit: what claims more is damaged, and must not ask for memory.
        if (std::uint64_t(width) * std::uint64_t(height) > std::uint64_t(length) * 8)
            throw bad(file, "image " + std::to_string(i) + " larger than its code can be");
        take(std::size_t(i), height, width, code);
    }
    if (!reader.at_end()) throw bad(file, "bytes after the last image");
}

}  // namespace

void write_texture_pack(const std::filesystem::path& file, const std::vector<GreyImage>& images) {
    std::vector<std::byte> out;
    for (const char c : kMagic) out.push_back(std::byte(c));
    put(out, std::uint32_t(images.size()));
    for (const GreyImage& image : images) {
        const std::vector<std::byte> code = encode_grey(image);
        put(out, std::uint32_t(image.width()));
        put(out, std::uint32_t(image.height()));
        put(out, std::uint32_t(code.size()));
        out.insert(out.end(), code.begin(), code.end());
    }
    write_file(file, out, true);
}

std::vector<GreyImage> read_texture_pack(const std::filesystem::path& file) {
    std::vector<GreyImage> images;
    read_pack(file, [&](std::size_t, int height, int width, std::span<const std::byte> code) {
        images.push_back(decode_grey(code, height, width));
    });
    return images;
}

std::shared_ptr<TextureLibrary> textures_from_pack(const std::filesystem::path& file,
                                                   const std::function<bool(std::size_t)>& keep) {
    auto library = std::make_shared<TextureLibrary>();
    read_pack(file, [&](std::size_t i, int height, int width, std::span<const std::byte> code) {
        if (!keep || keep(i)) library->add(decode_grey(code, height, width));
    });
    return library;
}

GreyImage shrunk(const GreyImage& image, int longest) {
    const double factor = double(std::max(image.width(), image.height())) / longest;
    if (factor <= 1) return image;
    const auto length = [&](int n) { return std::max(2, int(std::lround(n / factor))); };
    GreyImage out(length(image.height()), length(image.width()));
    // Which pixels of m lie below each of n, with the shares of its area.
    struct Part {
        int first = 0;
        std::vector<double> shares;
    };
    const auto parts = [](int m, int n) {
        std::vector<Part> all;
        const double step = double(m) / n;
        for (int i = 0; i < n; ++i) {
            Part part{.first = int(i * step), .shares = {}};
            for (int j = part.first; j < m && j < (i + 1) * step; ++j)
                part.shares.push_back(
                    (std::min(j + 1.0, (i + 1) * step) - std::max(double(j), i * step)) / step);
            all.push_back(std::move(part));
        }
        return all;
    };
    const auto rows = parts(image.height(), out.height());
    const auto columns = parts(image.width(), out.width());
    std::vector<double> sums(static_cast<std::size_t>(image.width()));
    for (int y = 0; y < out.height(); ++y) {
        const Part& row = rows[std::size_t(y)];
        std::ranges::fill(sums, 0.0);
        for (std::size_t j = 0; j < row.shares.size(); ++j)
            for (std::size_t x = 0; x < sums.size(); ++x)
                sums[x] += row.shares[j] * double(image.row(row.first + int(j))[x]);
        for (int x = 0; x < out.width(); ++x) {
            const Part& column = columns[std::size_t(x)];
            double sum = 0;
            for (std::size_t i = 0; i < column.shares.size(); ++i)
                sum += column.shares[i] * sums[std::size_t(column.first) + i];
            out(y, x) = std::uint8_t(std::lround(sum));
        }
    }
    return out;
}

}  // namespace eventide
