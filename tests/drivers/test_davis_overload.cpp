// A DAVIS sends more than the pipeline takes: the pipeline's own counters, and the mark in the
// stream.
#include "pipeline/pipeline.h"
#include "tests/drivers/davis_streams.h"
#include "tests/support/toy_stages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <thread>

namespace eventide::test {
namespace {

constexpr int kWidth = 64, kHeight = 48;

std::string text_of(const Damage& damaged) {
    std::string text;
    for (std::size_t i = 0; i < kDamageReasons; ++i)
        if (const auto reason = DamageReason(i); damaged[reason] > 0)
            text += std::string{name_of(reason)} + " " + std::to_string(damaged[reason]) + " ";
    return text;
}

TEST(DavisOverload, WhatThePipelineCannotTakeIsCountedAndTheStreamCarriesAGap) {
    testing_support::DavisModelSettings small;
    small.sensor.dvs_columns = small.sensor.aps_columns = kHeight;
    small.sensor.dvs_rows = small.sensor.aps_rows = kWidth;
    PluggedIn camera_side{small, {.events = 100'000, .longest_pause_us = 3}};
    DavisOptions options = at_once();
    options.settings.transfers = {4, 8 << 10};
    DavisCamera camera{options};

    ToyEncoder encoder{kHeight, kWidth};
    ToyRenderer renderer{kHeight, kWidth};
    ToySink sink;
    sink.wants = 20;
    PipelineSettings settings;
    settings.bins = 3;
    settings.event_windows.slicer.width = SensorDuration{1000};
    settings.buffers = {2, 1, 1};
    Pipeline pipeline{{camera, encoder, renderer, {&sink}}, settings};
    // The network takes its time until something was lost.
    encoder.before_encode = [&] {
        while (pipeline.snapshot().lost() == 0) std::this_thread::yield();
    };
    pipeline.run();

    const Snapshot end = pipeline.snapshot();
    EXPECT_GT(end.lost_packets, 0U);
    EXPECT_GT(end.lost_bytes, 0U);
    EXPECT_EQ(end.bytes, camera.counters()[CameraCount::bytes])
        << "every byte was taken or counted as lost";
    EXPECT_GE(end.gaps, 1U);
    EXPECT_TRUE(std::any_of(sink.seen.begin(), sink.seen.end(),
                            [](const ToySink::Seen& frame) { return frame.gap; }));
    // On a busy machine the loss may be long enough for the clock to be set right after it.
    EXPECT_EQ(end.damaged.total(), end.damaged[DamageReason::time_corrected])
        << "nothing behind the gap is garbled: " << text_of(end.damaged);
}

}  // namespace
}  // namespace eventide::test
