// APS reads of AEDAT 2.0 -> reference images.
#include "src/codec/aedat/aedat2_frame.h"

#include "src/codec/inivation/davis_pixel.h"

#include <algorithm>
#include <utility>

namespace eventide {

namespace {

void clear(Array2<std::uint16_t>& samples) {
    std::fill(samples.values().begin(), samples.values().end(), std::uint16_t{0});
}

}  // namespace

Aedat2FrameAssembler::Aedat2FrameAssembler(int width, int height, bool is_davis240)
    : is_davis240_(is_davis240), reset_(height, width), signal_(height, width) {}

void Aedat2FrameAssembler::drop() {
    if (resets_ + signals_ > 0) {
        clear(reset_);
        clear(signal_);
    }
    resets_ = signals_ = 0;
    rolling_ = false;
}

bool Aedat2FrameAssembler::is_complete() const {
    return resets_ == signals_ && resets_ > 0 && resets_ == box_.area();
}

void Aedat2FrameAssembler::read(bool is_signal, int x, int y, std::uint16_t sample, SensorTime t,
                                Batch& into, Damage& damage) {
    Array2<std::uint16_t>& samples = is_signal ? signal_ : reset_;
    if (samples(y, x) != 0) {
        if (is_complete())
            emit(into);
        else
            damage.count(DamageReason::bad_record);
        drop();
    }
    if (resets_ + signals_ == 0) box_ = {x, y, x, y};
    box_ = {std::min(box_.x0, x), std::min(box_.y0, y), std::max(box_.x1, x), std::max(box_.y1, y)};
    samples(y, x) = std::uint16_t(davis_sample(sample, is_davis240_) + 1);
    if (is_signal) {
        if (signals_++ == 0) first_signal_ = t;
    } else {
        if (resets_++ == 0) first_reset_ = t;
        last_reset_ = t;
        rolling_ |= signals_ > 0;
    }
    if (std::size_t(signals_) == samples.values().size() && is_complete()) {
        emit(into);
        drop();
    }
}

void Aedat2FrameAssembler::emit(Batch& into) {
    ReferenceImage image;
    image.exposure_begin = rolling_ ? first_reset_ : last_reset_;
    image.exposure_end = std::max(first_signal_, image.exposure_begin);
    image.t = image.exposure_begin + (image.exposure_end - image.exposure_begin) / 2;
    image.x0 = box_.x0;
    image.y0 = box_.y0;
    image.pixels = Array2<std::uint16_t>(box_.y1 - box_.y0 + 1, box_.x1 - box_.x0 + 1);
    for (int y = 0; y < image.pixels.height(); ++y)
        for (int x = 0; x < image.pixels.width(); ++x) {
            const int from_y = box_.y0 + y, from_x = box_.x0 + x;
            image.pixels(y, x) = davis_intensity(std::uint16_t(reset_(from_y, from_x) - 1),
                                                 std::uint16_t(signal_(from_y, from_x) - 1));
        }
    into.add_image(std::move(image));
    last_box_ = box_;
}

void Aedat2FrameAssembler::finish(Batch& into, Damage& damage) {
    if (is_complete() && last_box_ == box_)
        emit(into);
    else if (resets_ + signals_ > 0)
        damage.count(DamageReason::truncated);
    drop();
}

}  // namespace eventide
