// Images out of arrays, among the events of their time.
#pragma once

#include "replay/event_table.h"
#include "src/core/damage.h"
#include "src/core/event.h"

#include <cstdint>
#include <memory>
#include <utility>

namespace eventide {

class TableImages {
public:
    /// `images` may be null: then there are none.
    explicit TableImages(std::unique_ptr<ImageTable> images) : images_(std::move(images)) {}

    /// Appends those up to `until_us`, but no more than kAtATime: a part of a recording is bounded.
    /// False where more are due. Those that cannot be read, or are not of the sensor's size (px),
    /// count as bad_record. One with a wrong time holds back none behind it.
    bool take(std::int64_t until_us, int width, int height, Batch& into, Damage& damage);

    bool is_at_end() const { return !images_ || next_ >= images_->rows(); }
    /// Not at the end; kNoTimeUs where it cannot be read.
    std::int64_t next_time_us() const { return images_->time_us(next_); }
    /// Goes to the first at or after that time.
    void seek(std::int64_t t_us);

private:
    static constexpr int kAtATime = 8;

    bool is_due(std::int64_t until_us) const;

    std::unique_ptr<ImageTable> images_;
    std::uint64_t next_ = 0;
    std::int64_t last_us_ = kNoTimeUs;  ///< of those that came in their time
};

}  // namespace eventide
