// What a recording or a camera says about its sensor.
#pragma once

#include <string>

namespace eventide {

struct SensorInfo {
    std::string name;           ///< "DAVIS346", or what the recording says; may be empty
    std::string serial;         ///< may be empty
    std::string format;         ///< "aedat4", "evt3", "davis", "text", ...
    int width = 0, height = 0;  ///< px; 0 where a recording does not say
};

}  // namespace eventide
