// What viewers may change while a run goes on, and what they are only told.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace eventide {

/// One slider or switch of the page.
struct HttpControl {
    std::string name;         ///< in JSON: "fps"
    std::string label, unit;  ///< for people
    double least = 0, most = 1, step = 1;
    /// Any thread.
    std::function<double()> get;
    /// Any thread, with a value in range. Empty: it cannot be changed while the run goes on.
    std::function<void(double)> set = {};
    std::string fixed = {};  ///< why not, for people
    std::string text = {};   ///< the value for people, where it is no number
};

using ControlChange = std::pair<const HttpControl*, double>;

/// The largest body that is read.
constexpr std::size_t kMaxControlBytes = 4096;

/// A JSON object such as {"fps": 60, "pause": 1}; true and false are 1 and 0. All or nothing:
/// throws Error (usage) for what is no object, an unknown name, a control that is fixed, or a value
/// that is no number in range. Values are rounded to the control's step.
std::vector<ControlChange> parse_changes(std::string_view body,
                                         const std::vector<HttpControl>& controls);

/// The controls as a JSON list, as they stand.
std::string controls_json(const std::vector<HttpControl>& controls);

}  // namespace eventide
