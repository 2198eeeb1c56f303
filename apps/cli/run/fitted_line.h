// One line for a terminal of any width: its parts get shorter, the least important first.
#pragma once

#include <chrono>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace eventide::app {

/// One part of a line in ever shorter forms; an empty one leaves it out.
using LinePart = std::vector<std::string>;

/// The parts side by side, in at most `columns`. `gives_way` are indices of parts: each in turn
/// takes its next form until the line fits. What still does not fit is cut.
std::string fitted_line(const std::vector<LinePart>& parts, std::span<const std::size_t> gives_way,
                        std::size_t columns);

/// "[=====>    ]  43 %", then with a shorter bar, then "43 %".
LinePart share_part(double share);

/// "1:23 left", then "-1:23"; empty while too little is done to tell.
LinePart left_part(std::chrono::duration<double> elapsed, double share);

}  // namespace eventide::app
