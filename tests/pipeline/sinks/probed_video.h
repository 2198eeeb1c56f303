// What ffprobe says of a video.
#pragma once

#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

namespace eventide::test {

inline std::string probe(const std::string& file, const std::vector<std::string>& what) {
    std::vector<std::string> arguments{"ffprobe", "-v", "error", "-select_streams", "v:0"};
    arguments.insert(arguments.end(), what.begin(), what.end());
    arguments.insert(arguments.end(), {"-of", "csv=p=0", file});
    const Result result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.error;
    return result.output;
}

/// Of the container's clock.
inline std::vector<std::int64_t> packet_times(const std::string& file) {
    std::istringstream lines{probe(file, {"-show_entries", "packet=pts"})};
    std::vector<std::int64_t> times;
    for (std::string line; std::getline(lines, line);) times.push_back(std::stoll(line));
    return times;
}

}  // namespace eventide::test
