// The unit of a text recording's times: guessed where nobody states it, doubted where it cannot be.
#pragma once

#include "src/codec/text/text_layout.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace eventide {

/// Of the times of a recording's first rows. Fractions are seconds. Whole numbers are microseconds,
/// unless no sensor sends so few or so many events in them and another unit makes sense;
/// nanoseconds since 1970 stand out by themselves. Whole numbers with a decimal point are what
/// numpy.savetxt() writes of microseconds. What was guessed with little to go by is added to
/// `remarks`.
TextTimeUnit guess_time_unit(std::span<const std::string_view> times,
                             std::vector<std::string>& remarks);

/// A stated unit is taken at its word, but seconds stated as microseconds all become one moment:
/// adds a remark where no sensor sends so many events.
void doubt_time_unit(std::span<const std::string_view> times, TextTimeUnit stated,
                     std::vector<std::string>& remarks);

}  // namespace eventide
