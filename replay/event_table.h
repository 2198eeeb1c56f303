// Events and images as rows of arrays, whatever file they are in.
#pragma once

#include "src/core/event.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace eventide {

/// Stands for a time that is none (not a number, farther away than 30,000 years).
constexpr std::int64_t kNoTimeUs = std::numeric_limits<std::int64_t>::min();

/// Seconds in floating point, as microseconds.
std::int64_t us_from_seconds(double seconds);
/// `base_us` added; kNoTimeUs where that is too far away.
std::int64_t us_from_integer(std::int64_t us, std::int64_t base_us = 0);
/// False for a row that cannot be read: what is not known is not passed over.
bool is_before(std::int64_t row_us, std::int64_t t_us);

/// Columns of as many numbers, unchecked.
struct EventRows {
    std::vector<std::int64_t> t_us;
    std::vector<std::int32_t> x, y;
    std::vector<std::uint8_t> on;  ///< 0 or 1

    void resize(std::size_t n) {
        t_us.resize(n);
        x.resize(n);
        y.resize(n);
        on.resize(n);
    }
};

class EventTable {
public:
    virtual ~EventTable() = default;
    virtual std::uint64_t rows() const = 0;
    /// Rows [first, first + count), which there are. False where they are stored and cannot be read
    /// (a packed block that does not unpack).
    virtual bool read(std::uint64_t first, std::size_t count, EventRows& into) = 0;
    /// kNoTimeUs where it cannot be read.
    virtual std::int64_t time_us(std::uint64_t row) = 0;
    /// The file's own index: a row, or rows(), before which no event at or after t lies. Empty
    /// where there is none.
    virtual std::optional<std::uint64_t> look_up(std::int64_t) { return {}; }
};

/// Images in order of time.
class ImageTable {
public:
    virtual ~ImageTable() = default;
    virtual std::uint64_t rows() const = 0;
    virtual std::int64_t time_us(std::uint64_t row) = 0;
    /// Empty where it cannot be read.
    virtual std::optional<ReferenceImage> read(std::uint64_t row) = 0;
};

}  // namespace eventide
