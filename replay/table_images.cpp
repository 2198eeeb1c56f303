// Which images are due.
#include "replay/table_images.h"

#include "src/core/partition_row.h"
#include "src/core/whole_sensor.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace eventide {

/// An image that lies behind the one after it has a wrong time: it goes with that one.
bool TableImages::is_due(std::int64_t until_us) const {
    if (next_time_us() <= until_us) return true;
    if (next_ + 1 >= images_->rows()) return false;
    const std::int64_t after = images_->time_us(next_ + 1);
    return after > last_us_ && after <= until_us;
}

bool TableImages::take(std::int64_t until_us, int width, int height, Batch& into, Damage& damage) {
    for (int n = 0; !is_at_end() && is_due(until_us); ++n) {
        if (n == kAtATime) return false;
        const std::int64_t t = next_time_us();
        auto image = t == kNoTimeUs ? std::nullopt : images_->read(next_);
        ++next_;
        if (t <= until_us) last_us_ = std::max(last_us_, t);
        // One of another size is another camera's: nothing says where its pixels lie.
        if (!image || !covers_sensor(*image, width, height)) {
            damage.count(DamageReason::bad_record);
            continue;
        }
        image->t = from_us(t);
        image->exposure_begin = image->exposure_end = image->t;
        into.images.push_back(*std::move(image));
    }
    return true;
}

void TableImages::seek(std::int64_t t_us) {
    if (!images_) return;
    last_us_ = kNoTimeUs;
    next_ = partition_row(
        images_->rows(), [&](std::uint64_t row) { return is_before(images_->time_us(row), t_us); });
}

}  // namespace eventide
