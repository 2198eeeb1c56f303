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

bool is_before(std::int64_t row_us, std::int64_t t_us) {
    return row_us != kNoTimeUs && row_us < t_us;
}

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
        if (read_rows(part * kRowsAtATime, damage)) take_rows(batch, damage);
        search.add(batch);
        batch.clear();
    }
    search.conclude(path, damage, header_, remarks_);
}

void TableReader::check_order(const std::string& path) {
    constexpr std::size_t kRowsThatTell = 100;
    Batch read, in_order;
    Damage damage;
    if (read_rows(0, damage)) take_rows(read, damage);
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
bool TableReader::read_rows(std::uint64_t first, Damage& damage) {
    const auto n = std::size_t(std::min<std::uint64_t>(kRowsAtATime, events_->rows() - first));
    if (events_->read(first, n, rows_)) return true;
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
        if (images_.is_at_end()) return false;
        take_images(std::numeric_limits<std::int64_t>::max(), into, damage);
        return true;
    }
    if (!read_rows(next_row_, damage)) {
        next_row_ += std::min<std::uint64_t>(kRowsAtATime, events_->rows() - next_row_);
        return true;
    }
    const bool more_due = !take_images(last_time_us(), into, damage);
    if (more_due) rows_.resize(rows_until(images_.next_time_us()));
    take_rows(into, damage);
    next_row_ += rows_.t_us.size();
    return true;
}

bool TableReader::take_images(std::int64_t until_us, Batch& into, Damage& damage) {
    return images_.take(until_us, header_.width, header_.height, into, damage);
}

/// Of the rows read.
std::int64_t TableReader::last_time_us() const {
    const auto known = std::find_if(rows_.t_us.rbegin(), rows_.t_us.rend(),
                                    [](std::int64_t t) { return t != kNoTimeUs; });
    return known == rows_.t_us.rend() ? kNoTimeUs : *known;
}

/// How many come before the first that is later.
std::size_t TableReader::rows_until(std::int64_t t_us) const {
    const auto later =
        std::ranges::find_if(rows_.t_us, [t_us](std::int64_t t) { return t > t_us; });
    return std::size_t(later - rows_.t_us.begin());
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
    images_.seek(t_us);
}

double TableReader::progress() const {
    return events_->rows() == 0 ? 1 : double(next_row_) / double(events_->rows());
}

}  // namespace eventide
