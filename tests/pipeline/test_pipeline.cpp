// The whole line over a toy model: the same frames on four threads as on one, errors, overload,
// stops.
#include "pipeline/pipeline.h"
#include "src/core/error.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/toy_line.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>
#include <random>
#include <semaphore>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace eventide {
namespace {

using namespace test;

PipelineSettings quick_settings() {
    PipelineSettings settings;
    settings.bins = 3;
    settings.event_frames.slicer.width = SensorDuration{1000};
    settings.rate = {2000, 1};
    return settings;
}

/// One run of the line over toy parts.
struct Line {
    Line(std::vector<std::vector<std::byte>> packets, const PipelineSettings& line_settings,
         bool live = false)
        : source(std::move(packets), live), settings(line_settings) {}

    Pipeline& made() {
        if (!pipeline)
            pipeline = std::make_unique<Pipeline>(
                PipelineParts{source, encoder, renderer, {&sink}, filter}, settings);
        return *pipeline;
    }
    void run() { made().run(); }
    void run_sequential() { made().run_sequential(); }
    Snapshot snapshot() const { return pipeline->snapshot(); }

    ToySource source;
    ToyEncoder encoder;
    ToyRenderer renderer;
    ToySink sink;
    EventFilter* filter = nullptr;
    PipelineSettings settings;
    std::unique_ptr<Pipeline> pipeline;
};

/// One event in each of n event frames of 1000 us, one packet each, and one packet that ends them.
std::vector<std::vector<std::byte>> one_frame_per_packet(std::size_t n) {
    std::vector<std::vector<std::byte>> packets(n + 1);
    for (std::size_t i = 0; i <= n; ++i)
        append_record(packets[i], ToyKind::event, std::int64_t(1000 * i + 1), int(i % kToyWidth));
    return packets;
}

// ---- the same on four threads as on one
// ----------------------------------------------------------

TEST(Pipeline, GivesTheSameFramesThreadedAsSequentialForAnySplitOfTheBytes) {
    std::vector<PipelineSettings> variants;
    for (const int lookahead : {0, 1, 2})
        for (const FrameRate rate : {FrameRate{}, FrameRate{2997, 100}, FrameRate{3000, 1}}) {
            PipelineSettings settings = quick_settings();
            settings.rate = rate;
            settings.lookahead = lookahead;
            settings.event_preview = lookahead == 1;
            if (lookahead == 2) {
                settings.event_frames.slicer = parse_window("40ev,3ms");
                settings.buffers = {1, 1, 1};
            }
            variants.push_back(settings);
        }
    variants.push_back(quick_settings());
    variants.back().event_frames.slicer.begin = from_us(10'000);
    variants.back().event_frames.slicer.end = from_us(31'500);
    variants.back().frames_from = from_us(20'500);

    const auto bytes = bytes_of(toy_events(3000));
    for (std::size_t v = 0; v < variants.size(); ++v) {
        SCOPED_TRACE(v);
        Line whole({bytes}, variants[v]);
        whole.run_sequential();
        ASSERT_GT(whole.sink.seen.size(), 1U);
        for (const std::size_t size : {5U, 100U, 3000U}) {
            std::mt19937 rng{unsigned(v)};
            Line split(ToySource::packets_of(bytes, size, &rng), variants[v]);
            split.run();
            ASSERT_EQ(split.sink.seen, whole.sink.seen) << size;
            EXPECT_EQ(split.sink.closed, 1);
            if (!variants[v].event_frames.slicer.end) {
                EXPECT_EQ(split.snapshot().events, 3000U);
            }
            EXPECT_EQ(split.snapshot().lost_packets, 0U);
        }
    }
}

TEST(Pipeline, TheComparisonSeesOneEventLess) {
    auto events = toy_events(3000);
    Line all({bytes_of(events)}, quick_settings());
    all.run();
    events.erase(events.begin() + 1500);
    Line fewer({bytes_of(events)}, quick_settings());
    fewer.run();
    EXPECT_NE(all.sink.seen, fewer.sink.seen);
}

TEST(Pipeline, AsksForFramesAtTheirTimesWhateverTheEventsDo) {
    Line line({bytes_of(toy_events(3000))}, quick_settings());
    line.run();
    for (std::size_t i = 0; i < line.sink.seen.size(); ++i) {
        EXPECT_EQ(line.sink.seen[i].index, i);
        EXPECT_EQ(line.sink.seen[i].t_us, line.sink.seen[0].t_us + 500 * std::int64_t(i));
    }
    const Snapshot s = line.snapshot();
    EXPECT_EQ(s.frames, line.sink.seen.size());
    EXPECT_EQ(s.skipped_frames, 0U);
    EXPECT_EQ(s.latency.count, s.frames);
    EXPECT_EQ(s.encoded, s.event_frames);
    EXPECT_EQ(to_us(s.newest_frame), line.sink.seen.back().t_us);
}

TEST(Pipeline, PreviewsTheSumOfPolaritiesOfTheEventFrame) {
    std::vector<std::byte> bytes;
    for (int i = 0; i < 5; ++i) append_record(bytes, ToyKind::event, 1 + 100 * i, 2, 3, true);
    append_record(bytes, ToyKind::event, 600, 2, 3, false);
    append_record(bytes, ToyKind::event, 600, 4, 5, false);
    append_record(bytes, ToyKind::event, 1500, 0, 0, true);
    PipelineSettings settings = quick_settings();
    settings.rate = {};
    settings.event_preview = true;
    settings.lookahead = 1;
    Line line({bytes}, settings);
    line.run();
    ASSERT_EQ(line.sink.seen.size(), 2U);
    EXPECT_EQ(line.sink.seen[0].preview[3 * kToyWidth + 2], 4);
    EXPECT_EQ(line.sink.seen[0].preview[5 * kToyWidth + 4], -1);
    EXPECT_EQ(line.sink.seen[1].preview[3 * kToyWidth + 2], 0);
    EXPECT_EQ(line.sink.seen[1].preview[0], 1);
}

// ---- starting and stopping
// -----------------------------------------------------------------------

TEST(Pipeline, StartsAndStopsAThousandTimes) {
    const auto packets = one_frame_per_packet(50);
    for (int round = 0; round < 1000; ++round) {
        Line line(packets, quick_settings());
        line.sink.keeps = false;
        line.source.endless = true;
        if (round % 4 == 0)
            line.source.before_read = [&](std::size_t packet) {
                if (packet == std::size_t(round % 50)) line.made().stop();
            };
        else if (round % 4 == 1)
            line.sink.before_write = [&](auto frame) {
                if (frame == std::uint64_t(round % 30)) line.made().stop();
            };
        line.made();
        std::jthread stopper;
        if (round % 4 == 2) stopper = std::jthread{[&] { line.made().stop(); }};
        if (round % 4 == 3) line.made().stop();
        line.run();
        ASSERT_EQ(line.sink.closed, 1);
    }
}

TEST(Pipeline, CanBeWatchedWhileItRuns) {
    const auto bytes = bytes_of(toy_events(20'000));
    Line line(ToySource::packets_of(bytes, 200), quick_settings());
    line.made();
    std::atomic<bool> done{false};
    std::jthread watcher{[&] {
        std::uint64_t frames = 0;
        while (!done) {
            const Snapshot s = line.snapshot();
            EXPECT_GE(s.frames, frames);
            frames = s.frames;
        }
    }};
    line.run();
    done = true;
}

TEST(Pipeline, EndsWhenASinkWantsNoMore) {
    for (const bool threaded : {true, false}) {
        Line line(one_frame_per_packet(50), quick_settings());
        line.source.endless = true;
        line.sink.wants = 10;
        threaded ? line.run() : line.run_sequential();
        EXPECT_EQ(line.sink.count, 10U);
        EXPECT_EQ(line.sink.closed, 1);
    }
}

TEST(Pipeline, EndsAtTheAskedTime) {
    for (const bool threaded : {true, false}) {
        PipelineSettings settings = quick_settings();
        settings.rate = {};
        settings.event_frames.slicer.end = from_us(20'500);
        Line line(one_frame_per_packet(50), settings);
        line.source.endless = true;
        threaded ? line.run() : line.run_sequential();
        EXPECT_EQ(line.sink.seen.back().t_us, 20'500);
        EXPECT_EQ(line.sink.count, 21U);
    }
}

TEST(Pipeline, OfAnEmptySourceWritesNothingAndClosesItsSinks) {
    for (const bool threaded : {true, false}) {
        Line line({}, quick_settings());
        threaded ? line.run() : line.run_sequential();
        EXPECT_EQ(line.sink.count, 0U);
        EXPECT_EQ(line.sink.closed, 1);
    }
}

TEST(Pipeline, RefusesImpossibleSettings) {
    PipelineSettings no_bins = quick_settings(), no_buffers = quick_settings(),
                     far = quick_settings();
    no_bins.bins = 0;
    no_buffers.buffers.grids = 0;
    far.lookahead = 3;
    for (const auto& settings : {no_bins, no_buffers, far})
        EXPECT_THROW(Line({}, settings).made(), Error);
}

// ---- errors
// --------------------------------------------------------------------------------------

struct FailingFilter final : EventFilter {
    void process(std::vector<Event>& events) override {
        seen += events.size();
        if (seen > 20) throw std::runtime_error("filter");
    }
    std::size_t seen = 0;
};

/// Makes one part of the line fail; returns the sentence it fails with.
std::string break_part(Line& line, const std::string& part, FailingFilter& filter) {
    const auto fail = [part](auto... at) {
        const bool now = (true && ... && (at == 20));
        if (now) throw std::runtime_error(part);
    };
    if (part == "source") line.source.before_read = fail;
    if (part == "parser") line.source.parser_fails_at_us = 20'000;
    if (part == "filter") line.filter = &filter;
    if (part == "sink") line.sink.before_write = fail;
    if (part == "close") line.sink.before_close = [fail] { fail(); };
    return part;
}

TEST(Pipeline, RethrowsAnErrorOfEachPartAndClosesTheSinks) {
    const auto packets = one_frame_per_packet(200);
    Line healthy(packets, quick_settings());
    healthy.run();
    for (const std::string part : {"source", "parser", "filter", "sink", "close"})
        for (const bool threaded : {true, false})
            for (int round = 0; round < 20; ++round) {
                SCOPED_TRACE(part + (threaded ? " threaded" : " sequential"));
                FailingFilter filter;
                Line line(packets, quick_settings());
                line.source.endless = part != "close";
                break_part(line, part, filter);
                try {
                    threaded ? line.run() : line.run_sequential();
                    ADD_FAILURE() << "no error";
                } catch (const std::runtime_error& error) {
                    EXPECT_EQ(error.what(), part);
                }
                EXPECT_EQ(line.sink.closed, 1);
                // What was written before is right: an error takes nothing back.
                ASSERT_LE(line.sink.seen.size(), healthy.sink.seen.size());
                EXPECT_TRUE(std::equal(line.sink.seen.begin(), line.sink.seen.end(),
                                       healthy.sink.seen.begin()));
            }
}

TEST(Pipeline, WritesWhatWasReadBeforeTheSourceFailed) {
    for (const bool threaded : {true, false}) {
        Line line(one_frame_per_packet(200), quick_settings());
        line.source.before_read = [](std::size_t packet) {
            if (packet == 100) throw Error(ErrorKind::device, "unplugged");
        };
        EXPECT_THROW(threaded ? line.run() : line.run_sequential(), Error);
        EXPECT_EQ(line.sink.seen.back().t_us, 99'000) << "the last of the event frames up to 99001";
    }
}

TEST(Pipeline, KeepsTheFirstErrorOfTwo) {
    Line line(one_frame_per_packet(200), quick_settings());
    line.sink.before_write = [](auto frame) {
        if (frame == 3) throw std::runtime_error("first");
    };
    line.sink.before_close = [] { throw std::runtime_error("second"); };
    try {
        line.run();
        ADD_FAILURE();
    } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), "first");
    }
}

// ---- overload
// ------------------------------------------------------------------------------------

TEST(Pipeline, ARecordingWaitsForASlowSinkAndLosesNothing) {
    const auto packets = one_frame_per_packet(300);
    PipelineSettings settings = quick_settings();
    settings.rate = {};
    settings.buffers = {4, 2, 2};
    Line line(packets, settings);
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

TEST(Pipeline, ALiveSourceLosesWhatASlowModelCannotTakeAndSaysSo) {
    constexpr std::size_t kPackets = 400, kReleasedAt = 200;
    PipelineSettings settings = quick_settings();
    settings.rate = {};
    settings.buffers = {4, 1, 1};
    Line line(one_frame_per_packet(kPackets), settings, true);
    std::binary_semaphore released{0}, goes_on{0};
    line.encoder.before_encode = [&, calls = 0]() mutable {
        if (++calls == 1) released.acquire();
        if (calls == 3) goes_on.release();
    };
    line.source.before_read = [&](std::size_t packet) {
        if (packet == kReleasedAt) {
            released.release();
            goes_on.acquire();
        }
    };
    line.run();
    const Snapshot s = line.snapshot();
    EXPECT_EQ(s.packets, kPackets + 1) << "a live source is never made to wait";
    EXPECT_GE(s.lost_packets, kReleasedAt - 10);
    EXPECT_EQ(s.events + s.lost_packets, s.packets) << "one event each: nothing else is missing";
    EXPECT_EQ(s.lost_bytes, 14 * s.lost_packets);
    const auto marked = std::count_if(line.sink.seen.begin(), line.sink.seen.end(),
                                      [](const auto& seen) { return seen.gap; });
    EXPECT_GE(marked, 1);
    EXPECT_LE(std::uint64_t(marked), s.gaps) << "two gaps may fall into one event frame";
    EXPECT_EQ(line.encoder.resets, 0) << "state is kept over a gap by default";
}

TEST(Pipeline, ALiveSourceSkipsTheOldestFramesWhenRenderingIsSlow) {
    constexpr std::size_t kPackets = 60;
    PipelineSettings settings = quick_settings();
    settings.rate = {20'000, 1};  // 20 frames per event frame
    settings.buffers = {64, 2, 4};
    Line line(one_frame_per_packet(kPackets), settings, true);
    std::binary_semaphore behind{0};
    line.sink.before_write = [&](std::uint64_t frame) {
        if (frame == 5) behind.acquire();
    };
    // At the fourth event frame the second and third wait behind the one being rendered.
    line.encoder.before_encode = [&, calls = 0]() mutable {
        if (++calls == 4) behind.release();
    };
    line.run();
    const Snapshot s = line.snapshot();
    EXPECT_GT(s.skipped_frames, 0U);
    EXPECT_EQ(s.frames, line.sink.seen.size());
    EXPECT_EQ(s.frames + s.skipped_frames, line.sink.seen.back().index + 1)
        << "each frame of the clock is written or counted, and the newest is written";
    EXPECT_GT(line.sink.seen[6].index, 6U) << "the oldest waiting ones go";
}

TEST(Pipeline, ALiveLineGoesOnGivingFramesInSilence) {
    std::vector<std::vector<std::byte>> packets = one_frame_per_packet(3);
    packets.emplace_back();  // a timeout, again and again
    PipelineSettings settings = quick_settings();
    settings.event_frames.silence_margin = SensorDuration{1000};
    Line line(packets, settings, true);
    line.source.endless = true;
    line.sink.wants = 40;
    line.run();
    EXPECT_EQ(line.sink.count, 40U);
    EXPECT_GE(line.sink.seen.back().t_us, 19'000) << "events ended at 3001";
    EXPECT_GT(line.snapshot().silent_frames, 0U);
}

// ---- gaps and resets
// -----------------------------------------------------------------------------

/// Marks chosen packets as coming after a loss, as drivers do.
struct GappySource final : Source {
    explicit GappySource(ToySource& toy) : toy_(toy) {}
    const SensorInfo& info() const override { return toy_.info(); }
    bool is_live() const noexcept override { return toy_.is_live(); }
    ReadStatus read(RawPacket& into) override {
        const ReadStatus status = toy_.read(into);
        into.gap_before = gaps.count(next_++) > 0;
        return status;
    }
    void stop() noexcept override { toy_.stop(); }
    std::unique_ptr<Parser> make_parser() const override { return toy_.make_parser(); }

    std::set<std::size_t> gaps;

private:
    ToySource& toy_;
    std::size_t next_ = 0;
};

TEST(Pipeline, KeepsOrResetsItsStateOverAGapAsAsked) {
    for (const bool reset : {false, true})
        for (const bool threaded : {true, false}) {
            PipelineSettings settings = quick_settings();
            settings.rate = {};
            settings.reset_on_gap = reset;
            ToySource toy(one_frame_per_packet(30));
            GappySource source(toy);
            source.gaps = {10, 20};
            ToyEncoder encoder;
            ToyRenderer renderer;
            ToySink sink;
            Pipeline pipeline({source, encoder, renderer, {&sink}}, settings);
            threaded ? pipeline.run() : pipeline.run_sequential();
            EXPECT_EQ(encoder.resets, reset ? 2 : 0);
            EXPECT_EQ(pipeline.snapshot().state_resets, reset ? 2U : 0U);
            EXPECT_EQ(pipeline.snapshot().gaps, 2U);
            std::vector<std::size_t> marked;
            for (std::size_t i = 0; i < sink.seen.size(); ++i)
                if (sink.seen[i].gap) marked.push_back(i);
            EXPECT_EQ(marked, (std::vector<std::size_t>{9, 19})) << "the frame data are missing in";
        }
}

TEST(Pipeline, BeginsANewStreamWhereTheCamerasClockWasReset) {
    auto first = toy_events(1000, 1, 500'000), second = toy_events(1000, 2, 1000);
    auto both = first;
    both.insert(both.end(), second.begin(), second.end());
    for (const bool threaded : {true, false}) {
        Line line(ToySource::packets_of(bytes_of(both), 333), quick_settings());
        threaded ? line.run() : line.run_sequential();
        EXPECT_EQ(line.encoder.resets, 1);
        EXPECT_EQ(line.snapshot().slicing.time_resets, 1U);
        Line alone({bytes_of(second)}, quick_settings());
        alone.run();
        ASSERT_GT(line.sink.seen.size(), alone.sink.seen.size());
        ASSERT_EQ(line.sink.seen.back().t_us, alone.sink.seen.back().t_us);
        const auto offset = line.sink.seen.size() - alone.sink.seen.size();
        for (std::size_t i = 0; i < alone.sink.seen.size(); ++i) {
            ASSERT_EQ(line.sink.seen[offset + i].t_us, alone.sink.seen[i].t_us);
            EXPECT_EQ(line.sink.seen[offset + i].sigma, alone.sink.seen[i].sigma);
            EXPECT_EQ(line.sink.seen[offset + i].index, offset + i);
        }
    }
}

// ---- allocation
// ----------------------------------------------------------------------------------

TEST(AllocationCounter, SeesAnAllocation) {
    if (!can_count_allocations()) GTEST_SKIP() << "sanitizers bring their own malloc";
    AllocationCount count;
    const auto with_new = std::make_unique<int>(1);
    std::vector<int, CacheLineAllocator<int>> aligned(100);
    std::jthread other{[] { free(malloc(10)); }};
    other.join();
    EXPECT_GE(count.stop(), 3);
}

TEST(Pipeline, AllocatesNothingOnceWarm) {
    if (!can_count_allocations()) GTEST_SKIP() << "sanitizers bring their own malloc";
    for (const bool threaded : {true, false}) {
        constexpr std::size_t kFrames = 4000;
        std::vector<std::vector<std::byte>> packets(kFrames);
        for (std::size_t i = 0; i < kFrames; ++i)
            for (int n = 0; n < 30; ++n)
                append_record(packets[i], ToyKind::event, std::int64_t(1000 * i + 1) + 30 * n,
                              n % kToyWidth, n % kToyHeight, n % 2 == 0);
        PipelineSettings settings = quick_settings();
        settings.lookahead = 2;
        settings.event_preview = true;
        Line line(packets, settings);
        line.sink.keeps = false;
        std::int64_t allocations = -1;
        line.sink.before_write = [&](std::uint64_t frame) {
            if (frame == 1000) start_counting_allocations();
            if (frame == 7000) allocations = stop_counting_allocations();
        };
        threaded ? line.run() : line.run_sequential();
        EXPECT_EQ(allocations, 0) << (threaded ? "threaded" : "sequential");
    }
}

}  // namespace
}  // namespace eventide
