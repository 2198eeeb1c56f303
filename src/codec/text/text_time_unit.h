// The unit of a text recording's times: guessed where nobody states it, doubted where it cannot be.
#pragma once

#include "src/codec/text/text_layout.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace eventide {

/// The unit of `times`, those of a recording's first rows. Fractions are seconds. Whole numbers are
/// microseconds, unless hardly a sensor sends so few events in them (100/s), or none so many, and
/// another unit makes sense; microseconds and nanoseconds since 1970 stand out by themselves. Whole
/// numbers with a decimal point are what numpy.savetxt() writes of microseconds. What was guessed
/// with little to go by is added to `remarks`.
TextTimeUnit guess_time_unit(std::span<const std::string_view> times,
                             std::vector<std::string>& remarks);

/// A stated unit is taken at its word, but seconds stated as microseconds all become one moment,
/// and microseconds stated as seconds years of frames: adds a remark where no sensor sends so many
/// events, or its noise alone is more.
void doubt_time_unit(std::span<const std::string_view> times, TextTimeUnit stated,
                     std::vector<std::string>& remarks);

}  // namespace eventide
