// Too much for a part of the pipeline: recordings wait, windows become one, frames are skipped.
#include "tests/pipeline/toy_pipeline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <semaphore>
#include <thread>

namespace eventide {
namespace {

using namespace test;

TEST(Pipeline, ARecordingWaitsForASlowSinkAndLosesNothing) {
    const auto packets = one_frame_per_packet(300);
    PipelineSettings settings = quick_settings();
    settings.rate = {};
    settings.buffers = {4, 2, 2};
    PipelineUnderTest line(packets, settings);
    std::atomic<std::size_t> read{0};
    std::counting_semaphore<> tokens{0};
    std::size_t furthest = 0;
    line.source.before_read = [&](std::size_t packet) {
        read = packet;
        tokens.release();
    };
    line.sink.before_write = [&](std::uint64_t frame) {
        // Never quicker than the source: all buffers are full most of the time.
        if (frame % 10 == 0) std::this_thread::yield();
        furthest = std::max(furthest, read - std::size_t(frame));
    };
    line.run();
    EXPECT_EQ(line.sink.count, 301U);
    EXPECT_EQ(line.snapshot().lost_packets, 0U);
    // Packets, grids and latents lent, one in each thread's hands, and the one not yet cut.
    EXPECT_LE(furthest, 4U + 2U + 2U + 4U) << "pressure must walk back to the source";
}

TEST(Pipeline, WindowsThatWaitGoOnWhenThereIsRoomThoughNothingMoreComes) {
    constexpr std::size_t kPackets = 20;
    std::vector<std::vector<std::byte>> packets = one_frame_per_packet(kPackets);
    packets.resize(packets.size() + 2);  // timeouts
    PipelineSettings settings = quick_settings();
    settings.rate = {};
    settings.buffers.grids = 2;
    settings.latency = std::chrono::hours{1};
    PipelineUnderTest line(packets, settings, true);
    std::binary_semaphore released{0};
    line.encoder.before_encode = [&, calls = 0]() mutable {
        if (++calls == 1) released.acquire();
    };
    const auto wait_until = [&](auto counter, std::uint64_t number) {
        while (line.made().snapshot().*counter < number) std::this_thread::yield();
    };
    line.source.before_read = [&](std::size_t packet) {
        if (packet == kPackets + 1) {
            wait_until(&Snapshot::events, kPackets + 1);
            released.release();
            wait_until(&Snapshot::encoded, 2);
        }
        if (packet == kPackets + 2) wait_until(&Snapshot::encoded, 3);
    };
    line.run();
    EXPECT_GT(line.snapshot().merged_windows, kPackets - 5);
    EXPECT_EQ(line.sink.seen.back().sigma.front(), 1.0F + float(kPackets + 1)) << "events";
}

TEST(Pipeline, LearnsWhatAWindowTakesAndHandsOnNoneThatWouldBeLate) {
    constexpr std::size_t kPackets = 20;
    PipelineSettings settings = quick_settings();
    settings.frames_from = from_us(1'000'000);  // none
    settings.buffers.grids = 16;
    settings.latency = std::chrono::nanoseconds{1};  // any window that waits would be late
    PipelineUnderTest line(one_frame_per_packet(kPackets), settings, true);
    const auto wait_until = [&](auto counter, std::uint64_t number) {
        while (line.made().snapshot().*counter < number) std::this_thread::yield();
    };
    line.source.before_read = [&](std::size_t packet) {
        wait_until(&Snapshot::events, packet);
        if (packet == 2) wait_until(&Snapshot::encoded, 1);
    };
    line.encoder.before_encode = [&, calls = 0]() mutable {
        if (++calls == 2) wait_until(&Snapshot::events, kPackets + 1);
    };
    line.run();
    EXPECT_EQ(line.snapshot().lost_packets, 0U);
    EXPECT_LE(line.snapshot().encoded, 5U);
}

TEST(Pipeline, WindowsThatWaitWhenTheSourceEndsAreStillEncoded) {
    constexpr std::size_t kPackets = 20;
    PipelineSettings settings = quick_settings();
    settings.rate = {};
    settings.buffers.grids = 1;
    settings.latency = std::chrono::hours{1};
    PipelineUnderTest line(one_frame_per_packet(kPackets), settings, true);
    line.encoder.before_encode = [&] {
        while (line.made().snapshot().events <= kPackets) std::this_thread::yield();
    };
    line.run();
    const Snapshot s = line.snapshot();
    EXPECT_EQ(s.lost_packets, 0U);
    EXPECT_EQ(s.event_windows + s.merged_windows, kPackets + 1) << "each is counted";
    EXPECT_EQ(line.sink.seen.back().sigma.front(), 1.0F + float(kPackets + 1)) << "events";
}

TEST(Pipeline, WindowsThatWaitForASlowModelBecomeOneAndNothingIsLost) {
    constexpr std::size_t kPackets = 400, kReleasedAt = 390;
    PipelineSettings settings = quick_settings();
    settings.rate = {};
    settings.buffers = {16, 2, 4};
    settings.latency = std::chrono::hours{1};  // room decides, not how busy the machine is
    PipelineUnderTest line(one_frame_per_packet(kPackets), settings, true);
    std::binary_semaphore released{0};
    line.encoder.before_encode = [&, calls = 0]() mutable {
        if (++calls == 1) released.acquire();
    };
    // The bin thread has taken all but a few packets while the encoder had one window in hand.
    line.source.before_read = [&](std::size_t packet) {
        while (packet > 8 && line.made().snapshot().events + 8 < packet) std::this_thread::yield();
        if (packet == kReleasedAt) released.release();
    };
    line.run();
    const Snapshot s = line.snapshot();
    EXPECT_EQ(s.lost_packets, 0U);
    EXPECT_EQ(s.events, kPackets + 1);
    EXPECT_GT(s.merged_windows, kReleasedAt - 20);
    EXPECT_EQ(s.event_windows + s.merged_windows, kPackets + 1) << "each is counted";
    EXPECT_EQ(s.frames + s.skipped_frames, s.event_windows);
    for (std::size_t i = 1; i < line.sink.seen.size(); ++i)
        EXPECT_GE(line.sink.seen[i].begin_us, line.sink.seen[i - 1].end_us);
    // The toy model counts the events it is given: sigma is 1 more at a window's end.
    EXPECT_EQ(line.sink.seen.back().sigma.front(), 1.0F + float(kPackets + 1));
}

TEST(Pipeline, ALiveSourceSkipsTheOldestFramesWhenRenderingIsSlow) {
    constexpr std::size_t kPackets = 60;
    PipelineSettings settings = quick_settings();
    settings.rate = {20'000, 1};  // 20 frames per event window
    settings.buffers = {64, 2, 4};
    PipelineUnderTest line(one_frame_per_packet(kPackets), settings, true);
    std::binary_semaphore behind{0};
    line.sink.before_write = [&](std::uint64_t frame) {
        if (frame == 5) behind.acquire();
    };
    // At the fifth event window the second to fourth wait behind the one being rendered.
    line.encoder.before_encode = [&, calls = 0]() mutable {
        if (++calls == 5) behind.release();
    };
    line.run();
    const Snapshot s = line.snapshot();
    EXPECT_GT(s.skipped_frames, 0U);
    EXPECT_EQ(s.frames, line.sink.seen.size());
    EXPECT_EQ(s.frames + s.skipped_frames, line.sink.seen.back().index + 1)
        << "each frame of the clock is written or counted, and the newest is written";
    EXPECT_GT(line.sink.seen[6].index, 6U) << "the oldest waiting ones go";
}

TEST(Pipeline, NoFrameOfALiveSourceKeepsTheEncoderWaitingForABuffer) {
    PipelineSettings settings = quick_settings();
    settings.rate = {20'000, 1};  // 20 frames per event window
    settings.buffers = {64, 2, 2};
    PipelineUnderTest line(one_frame_per_packet(10), settings, true);
    std::binary_semaphore begun{0}, waits{0}, goes_on{0};
    line.sink.before_write = [&](std::uint64_t frame) {
        if (frame == 6) goes_on.release();
        if (frame != 5) return;
        begun.release();
        waits.acquire();
    };
    // While the sixth frame is written one map waits, and the other buffer is being filled.
    line.encoder.before_encode = [&, calls = 0]() mutable {
        if (++calls == 2) begun.acquire();
        if (calls != 3) return;
        waits.release();
        goes_on.acquire();
    };
    line.run();
    EXPECT_GT(line.sink.seen[6].index, 20U) << "the first window's others are left out";
}

TEST(Pipeline, ALiveLineGoesOnGivingFramesInSilence) {
    std::vector<std::vector<std::byte>> packets = one_frame_per_packet(3);
    packets.emplace_back();  // a timeout, again and again
    PipelineSettings settings = quick_settings();
    settings.event_windows.silence_margin = SensorDuration{1000};
    PipelineUnderTest line(packets, settings, true);
    line.source.endless = true;
    line.sink.wants = 40;
    line.run();
    EXPECT_EQ(line.sink.count, 40U);
    EXPECT_GE(line.sink.seen.back().t_us, 19'000) << "events ended at 3001";
    EXPECT_GT(line.snapshot().silent_windows, 0U);
    EXPECT_LT(line.snapshot().silent_windows, line.snapshot().event_windows);
}

}  // namespace
}  // namespace eventide
