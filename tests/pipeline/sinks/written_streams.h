// What a stream that was written says.
#pragma once

#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace eventide::test {

inline std::string probe(const std::string& file, const std::string& entries) {
    const Result result = run({"ffprobe", "-v", "error", "-count_frames", "-select_streams", "v:0",
                               "-show_entries", "stream=" + entries, "-of", "csv=p=0", file});
    EXPECT_EQ(result.exit_code, 0) << result.error;
    return result.output;
}

/// The times in the headers of Y4M frames.
inline std::vector<std::int64_t> y4m_times(const std::string& bytes) {
    constexpr std::string_view kHeader = "FRAME XT=";
    std::vector<std::int64_t> times;
    for (std::size_t at = 0; (at = bytes.find(kHeader, at)) != bytes.npos; ++at)
        times.push_back(std::stoll(bytes.substr(at + kHeader.size(), 20)));
    return times;
}

}  // namespace eventide::test
