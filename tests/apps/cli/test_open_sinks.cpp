// What the sinks of a run are told of its frames.
#include "apps/cli/run/open_sinks.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <string>

namespace eventide::app {
namespace {

/// Bytes of a stream that is to repeat what was skipped, of frames 0 and 3, 4 bytes each.
std::size_t bytes_of_stream(bool constant_rate) {
    const test::TempFolder temp;
    const std::string file = temp / "stream";
    RunSettings settings;
    settings.out = {"gray8:" + file};
    settings.overload = Overload::repeat;
    SinkPlan plan;
    plan.constant_rate = constant_rate;
    Frame frame;
    frame.intensity = Array2<float>(2, 2);
    for (const auto& sink : open_sinks(settings, plan)) {
        for (const std::uint64_t index : {0U, 3U}) {
            frame.index = index;
            sink->write(frame);
        }
        sink->close();
    }
    return std::filesystem::file_size(file);
}

TEST(OpenSinks, OnlyAStreamOfConstantRateRepeatsFrames) {
    EXPECT_EQ(bytes_of_stream(true), 16U);
    EXPECT_EQ(bytes_of_stream(false), 8U) << "numbers of event windows say nothing of time";
}

}  // namespace
}  // namespace eventide::app
