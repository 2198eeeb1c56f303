// Rows of arrays as events.
#include "replay/numpy/numpy_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace eventide {

namespace {

double us_per(TextTimeUnit unit) {
    switch (unit) {
        case TextTimeUnit::seconds:
            return 1e6;
        case TextTimeUnit::milliseconds:
            return 1e3;
        case TextTimeUnit::automatic:
        case TextTimeUnit::microseconds:
            return 1;
        case TextTimeUnit::nanoseconds:
            return 1e-3;
    }
    return 1;
}

class NumpyTable final : public EventTable {
public:
    NumpyTable(NumpyEvents found, const TextLayout& layout) : rows_(std::move(found.rows)) {
        count_ = found.count;
        for (std::size_t i = 0; i < found.columns.size(); ++i)
            columns_[std::size_t(layout.columns[i])] = std::move(found.columns[i]);
        us_ = us_per(layout.unit);
        off_ = layout.off;
    }

    std::uint64_t rows() const override { return count_; }

    bool read(std::uint64_t first, std::size_t count, EventRows& into) override {
        into.resize(count);
        for (NumpyRows& rows : rows_)
            if (!rows.read(first, count)) return false;
        const auto at = [&](std::size_t field, std::size_t row) {
            const NumpyColumn& column = columns_[field];
            const NumpyRows& rows = rows_[column.rows];
            return rows.block.data() + row * rows.stride + column.field.offset;
        };
        for (std::size_t i = 0; i < count; ++i) {
            into.t_us[i] = time_of(at(0, i));
            into.x[i] = place(columns_[1].field, at(1, i));
            into.y[i] = place(columns_[2].field, at(2, i));
            into.on[i] = std::uint8_t(numpy_number(columns_[3].field, at(3, i)) > off_);
        }
        return true;
    }

    std::int64_t time_us(std::uint64_t row) override {
        NumpyRows& rows = rows_[columns_[0].rows];
        if (!rows.read(row, 1)) return kNoTimeUs;
        return time_of(rows.block.data() + columns_[0].field.offset);
    }

    /// Deflated arrays are read once up to the time, instead of to many places.
    std::optional<std::uint64_t> look_up(std::int64_t t_us) override {
        NumpyRows& rows = rows_[columns_[0].rows];
        if (!rows.source->is_sequential()) return {};
        constexpr std::size_t kAtATime = 8192;
        for (std::uint64_t first = 0; first < count_; first += kAtATime) {
            const auto n = std::size_t(std::min<std::uint64_t>(kAtATime, count_ - first));
            if (!rows.read(first, n)) return first;
            for (std::size_t i = 0; i < n; ++i)
                if (time_of(rows.block.data() + i * rows.stride + columns_[0].field.offset) >= t_us)
                    return first + i;
        }
        return count_;
    }

private:
    static std::int32_t place(const NumpyField& field, const std::byte* at) {
        const std::int64_t value = numpy_integer(field, at);
        return value >= 0 && value < 1'000'000'000 ? std::int32_t(value) : std::int32_t{-1};
    }

    std::int64_t time_of(const std::byte* at) const {
        const NumpyField& field = columns_[0].field;
        if (field.kind == 'f') return us_from_seconds(numpy_number(field, at) * us_ * 1e-6);
        const std::int64_t t = numpy_integer(field, at);
        if (us_ >= 1) {
            constexpr std::int64_t kFarthest = 1'000'000'000'000;  // s
            const auto factor = std::int64_t(us_);
            const std::int64_t seconds = t / (1'000'000 / factor);
            return seconds >= -kFarthest && seconds <= kFarthest ? us_from_integer(t * factor)
                                                                 : kNoTimeUs;
        }
        return us_from_integer(t / 1000 + (t % 1000 >= 500) - (t % 1000 <= -500));
    }

    std::vector<NumpyRows> rows_;
    std::array<NumpyColumn, 4> columns_;
    std::uint64_t count_ = 0;
    double us_ = 1;   // per unit of time
    double off_ = 0;  // the largest polarity that is off
};

}  // namespace

std::unique_ptr<EventTable> make_numpy_table(NumpyEvents events, const TextLayout& layout) {
    return std::make_unique<NumpyTable>(std::move(events), layout);
}

}  // namespace eventide
