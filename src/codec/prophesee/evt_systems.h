// Prophesee's camera systems by number: what old RAW headers say of their sensor and format.
#pragma once

#include <string_view>

namespace eventide {

struct EvtSystem {
    int number;               ///< "system_ID"
    std::string_view sensor;  ///< "Gen3.1", "IMX636"
    std::string_view format;  ///< of the files that do not say it: "evt2", "evt3"
    int width, height;        ///< px
};

/// Null where it is none of those known.
const EvtSystem* find_evt_system(int number);

}  // namespace eventide
