// Rows of arrays become events; bisection finds the first row of a time.
#include "replay/table_reader.h"

#include "replay/stream/scan_geometry.h"
#include "src/codec/event_validator.h"
#include "src/core/error.h"
#include "src/core/partition_row.h"
#include "src/core/sensor_limits.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace eventide {

namespace {

/// Of a row that cannot be read it is not known: what is not known is not passed over.
bool is_before(std::int64_t row_us, std::int64_t t_us) {
    return row_us != kNoTimeUs && row_us < t_us;
}

}  // namespace

std::int64_t us_from_seconds(double seconds) {
    const double us = seconds * 1e6;
    return std::abs(us) <= double(kFarthestUs) ? std::llround(us) : kNoTimeUs;  // NaN is not
}

std::int64_t us_from_integer(std::int64_t us, std::int64_t base_us) {
    const auto near = [](std::int64_t t) { return t >= -kFarthestUs && t <= kFarthestUs; };
    return near(us) && near(base_us) ? us + base_us : kNoTimeUs;
}

TableReader::TableReader(const std::string& path, StreamHeader header,
                         std::unique_ptr<EventTable> events, std::unique_ptr<ImageTable> images,
                         const OpenOptions& options)
    : header_(std::move(header)), events_(std::move(events)), images_(std::move(images)) {
    if (options.width > 0) {
        header_.width = options.width;
        header_.height = options.height;
    }
    if (header_.width <= 0 || header_.height <= 0) find_size(path);
    if (events_->rows() > 0) check_order(path);
}

void TableReader::find_size(const std::string& path) {
    SensorSizeSearch search;
    Damage damage;
    Batch batch;
    header_.width = header_.height = kLargestSensorSide;
    const std::uint64_t parts = (events_->rows() + kRowsAtATime - 1) / kRowsAtATime;
    const std::uint64_t samples = std::min(parts, kSamples);
    for (std::uint64_t i = 0; i < samples; ++i) {
        const std::uint64_t part = samples < 2 ? 0 : i * (parts - 1) / (samples - 1);
        read_rows(part * kRowsAtATime, batch, damage);
        search.add(batch);
        batch.clear();
    }
    search.conclude(path, damage, header_, remarks_);
}

void TableReader::check_order(const std::string& path) {
    constexpr std::size_t kRowsThatTell = 100;
    Batch read, in_order;
    Damage damage;
    read_rows(0, read, damage);
    damage = {};
    EventValidator validator{1, 1};
    for (const Event& event : read.events)
        validator.add(to_us(event.t), 0, 0, true, in_order, damage);
    const std::size_t events = read.events.size();
    const std::uint64_t late = damage[DamageReason::time_backwards];
    if (events < kRowsThatTell || 2 * late <= events) return;
    throw Error(ErrorKind::input, path + ": expected events in order of time, found " +
                                      std::to_string(late) + " of the first " +
                                      std::to_string(events) +
                                      " earlier than ones before them; sort them by time");
}

/// False where they cannot be read.
bool TableReader::read_rows(std::uint64_t first, Batch& into, Damage& damage) {
    const auto n = std::size_t(std::min<std::uint64_t>(kRowsAtATime, events_->rows() - first));
    if (events_->read(first, n, rows_)) {
        take_rows(into, damage);
        return true;
    }
    damage.count(DamageReason::bad_compression);
    return false;
}

void TableReader::take_rows(Batch& into, Damage& damage) const {
    const auto inside = [](std::int32_t at, int side) { return at >= 0 && at < side; };
    into.events.reserve(into.events.size() + rows_.t_us.size());
    for (std::size_t i = 0; i < rows_.t_us.size(); ++i) {
        if (rows_.t_us[i] == kNoTimeUs)
            damage.count(DamageReason::bad_record);
        else if (!inside(rows_.x[i], header_.width) || !inside(rows_.y[i], header_.height))
            damage.count(DamageReason::out_of_range);
        else
            into.events.push_back({from_us(rows_.t_us[i]), std::uint16_t(rows_.x[i]),
                                   std::uint16_t(rows_.y[i]), Polarity(rows_.on[i])});
    }
}

bool TableReader::read(Batch& into, Damage& damage) {
    damage.count(DamageReason::bad_table, std::exchange(bad_tables_, 0));
    if (next_row_ >= events_->rows()) {
        if (!images_ || next_image_ >= images_->rows()) return false;
        take_images(std::numeric_limits<std::int64_t>::max(), into, damage);
        return true;
    }
    read_rows(next_row_, into, damage);
    next_row_ += std::min<std::uint64_t>(kRowsAtATime, events_->rows() - next_row_);
    if (!into.events.empty()) take_images(to_us(into.events.back().t), into, damage);
    return true;
}

/// At most some at a time: a part is bounded.
void TableReader::take_images(std::int64_t until_us, Batch& into, Damage& damage) {
    constexpr int kAtATime = 8;
    const bool rest = until_us == std::numeric_limits<std::int64_t>::max();
    for (int n = 0; images_ && next_image_ < images_->rows() && (!rest || n < kAtATime); ++n) {
        const std::int64_t t = images_->time_us(next_image_);
        if (t != kNoTimeUs && t > until_us) return;
        auto image = t == kNoTimeUs ? std::nullopt : images_->read(next_image_);
        ++next_image_;
        if (!image) {
            damage.count(DamageReason::bad_record);
            continue;
        }
        image->t = from_us(t);
        image->exposure_begin = image->exposure_end = image->t;
        into.images.push_back(*std::move(image));
    }
}

/// What an index says of a row agrees with the times around it.
bool TableReader::fits(std::uint64_t row, std::int64_t t_us) const {
    if (row > events_->rows()) return false;
    return row == 0 || is_before(events_->time_us(row - 1), t_us);
}

void TableReader::seek(SensorTime t) {
    const std::int64_t t_us = to_us(t);
    const auto indexed = events_->look_up(t_us);
    if (indexed && fits(*indexed, t_us)) {
        next_row_ = *indexed;
    } else {
        if (indexed) ++bad_tables_;
        next_row_ = partition_row(events_->rows(), [&](std::uint64_t row) {
            return is_before(events_->time_us(row), t_us);
        });
    }
    next_image_ = !images_ ? 0 : partition_row(images_->rows(), [&](std::uint64_t row) {
        return is_before(images_->time_us(row), t_us);
    });
}

double TableReader::progress() const {
    return events_->rows() == 0 ? 1 : double(next_row_) / double(events_->rows());
}

}  // namespace eventide
