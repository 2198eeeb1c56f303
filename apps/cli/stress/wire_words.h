// Events as the words of cameras and files whose counters wrap.
#pragma once

#include "apps/cli/stress/made_stream.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace eventide::stress {

struct Wire {
    std::string name;           ///< "EVT3"
    int width = 0, height = 0;  ///< px, of a sensor whose events it carries
    std::int64_t begin_us = 0;  ///< where events begin so that some counter wraps in the 3 s after
    std::string wraps;          ///< "every 16.8 s"
    std::function<std::vector<std::byte>(std::span<const Event>)> bytes;
    EncodedStream::MakeParser make_parser;
};

/// DAVIS, DVS128, EVT2, EVT3 and DAT.
std::vector<Wire> wires();

}  // namespace eventide::stress
