// The whole pipeline over a toy model: the same frames on four threads as on one; starts and stops.
#include "src/core/error.h"
#include "tests/pipeline/toy_pipeline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <thread>

namespace eventide {
namespace {

using namespace test;

TEST(Pipeline, GivesTheSameFramesThreadedAsSequentialForAnySplitOfTheBytes) {
    std::vector<PipelineSettings> variants;
    for (const int lookahead : {0, 1, 2})
        for (const FrameRate rate : {FrameRate{}, FrameRate{2997, 100}, FrameRate{3000, 1}}) {
            PipelineSettings settings = quick_settings();
            settings.rate = rate;
            settings.lookahead = lookahead;
            settings.event_preview = lookahead == 1;
            if (lookahead == 2) {
                settings.event_windows.slicer = parse_window("40ev,3ms");
                settings.buffers = {1, 1, 1};
            }
            variants.push_back(settings);
        }
    variants.push_back(quick_settings());
    variants.back().event_windows.slicer.begin = from_us(10'000);
    variants.back().event_windows.slicer.end = from_us(31'500);
    variants.back().frames_from = from_us(20'500);

    const auto bytes = bytes_of(toy_events(3000));
    for (std::size_t v = 0; v < variants.size(); ++v) {
        SCOPED_TRACE(v);
        PipelineUnderTest whole({bytes}, variants[v]);
        whole.run_sequential();
        ASSERT_GT(whole.sink.seen.size(), 1U);
        for (const std::size_t size : {5U, 100U, 3000U}) {
            std::mt19937 rng{unsigned(v)};
            PipelineUnderTest split(ToySource::packets_of(bytes, size, &rng), variants[v]);
            split.run();
            ASSERT_EQ(split.sink.seen, whole.sink.seen) << size;
            EXPECT_EQ(split.sink.closed, 1);
            if (!variants[v].event_windows.slicer.end) {
                EXPECT_EQ(split.snapshot().events, 3000U);
            }
            EXPECT_EQ(split.snapshot().lost_packets, 0U);
        }
    }
}

TEST(Pipeline, ALongSilenceHasFramesWhereThatIsAllowedAndOnlyThoseOfAHalvedRateAreRendered) {
    std::vector<std::byte> bytes;
    for (const std::int64_t us : {1, 1'200'001}) append_record(bytes, ToyKind::event, us, 0);
    for (const bool allowed : {false, true}) {
        PipelineSettings settings = quick_settings();
        settings.rate = {1'000'000, 1};
        settings.halvings = 10;
        settings.allow_silence = allowed;
        PipelineUnderTest line({bytes}, settings);
        if (!allowed) {
            EXPECT_THROW(line.run_sequential(), Error) << "more than a million";
            continue;
        }
        line.run_sequential();
        for (std::size_t i = 0; i < line.sink.seen.size(); ++i)
            ASSERT_EQ(line.sink.seen[i].index, 1024 * i);
        EXPECT_GT(line.sink.seen.back().t_us, 1'200'001 - 1024);
    }
}

TEST(Pipeline, TheComparisonSeesOneEventLess) {
    auto events = toy_events(3000);
    PipelineUnderTest all({bytes_of(events)}, quick_settings());
    all.run();
    events.erase(events.begin() + 1500);
    PipelineUnderTest fewer({bytes_of(events)}, quick_settings());
    fewer.run();
    EXPECT_NE(all.sink.seen, fewer.sink.seen);
}

TEST(Pipeline, AsksForFramesAtTheirTimesWhateverTheEventsDo) {
    PipelineUnderTest line({bytes_of(toy_events(3000))}, quick_settings());
    line.run();
    for (std::size_t i = 0; i < line.sink.seen.size(); ++i) {
        EXPECT_EQ(line.sink.seen[i].index, i);
        EXPECT_EQ(line.sink.seen[i].t_us, line.sink.seen[0].t_us + 500 * std::int64_t(i));
    }
    const Snapshot s = line.snapshot();
    EXPECT_EQ(s.frames, line.sink.seen.size());
    EXPECT_EQ(s.skipped_frames, 0U);
    EXPECT_EQ(s.latency.count, s.frames);
    EXPECT_EQ(s.encoded, s.event_windows);
    EXPECT_EQ(s.window_events, 3000U);
    EXPECT_EQ(to_us(s.newest_frame), line.sink.seen.back().t_us);
}

TEST(Pipeline, PreviewsTheSumOfPolaritiesOfTheEventWindow) {
    std::vector<std::byte> bytes;
    for (int i = 0; i < 5; ++i) append_record(bytes, ToyKind::event, 1 + 100 * i, 2, 3, true);
    append_record(bytes, ToyKind::event, 600, 2, 3, false);
    append_record(bytes, ToyKind::event, 600, 4, 5, false);
    append_record(bytes, ToyKind::event, 1500, 0, 0, true);
    PipelineSettings settings = quick_settings();
    settings.rate = {};
    settings.event_preview = true;
    settings.lookahead = 1;
    PipelineUnderTest line({bytes}, settings);
    line.run();
    ASSERT_EQ(line.sink.seen.size(), 2U);
    EXPECT_EQ(line.sink.seen[0].preview[3 * kToyWidth + 2], 4);
    EXPECT_EQ(line.sink.seen[0].preview[5 * kToyWidth + 4], -1);
    EXPECT_EQ(line.sink.seen[1].preview[3 * kToyWidth + 2], 0);
    EXPECT_EQ(line.sink.seen[1].preview[0], 1);
}

TEST(Pipeline, StartsAndStopsAThousandTimes) {
    const auto packets = one_frame_per_packet(50);
    for (int round = 0; round < 1000; ++round) {
        PipelineUnderTest line(packets, quick_settings());
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

TEST(Pipeline, HalfARecordIsNoDamageWhereTheEndWasAskedFor) {
    auto packets = one_frame_per_packet(5);
    packets[2].pop_back();
    packets.resize(3);
    for (const bool asked : {false, true}) {
        PipelineUnderTest line(packets, quick_settings());
        line.source.before_read = [&](std::size_t packet) {
            if (asked && packet == 3) line.made().stop();
        };
        line.run();
        EXPECT_EQ(line.snapshot().damaged[DamageReason::truncated], asked ? 0U : 1U);
    }
}

TEST(Pipeline, CanBeWatchedWhileItRuns) {
    const auto bytes = bytes_of(toy_events(20'000));
    PipelineUnderTest line(ToySource::packets_of(bytes, 200), quick_settings());
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
        PipelineUnderTest line(one_frame_per_packet(50), quick_settings());
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
        settings.event_windows.slicer.end = from_us(20'500);
        PipelineUnderTest line(one_frame_per_packet(50), settings);
        line.source.endless = true;
        threaded ? line.run() : line.run_sequential();
        EXPECT_EQ(line.sink.seen.back().t_us, 20'500);
        EXPECT_EQ(line.sink.count, 21U);
    }
}

TEST(Pipeline, CutsAsItIsAskedWhileItRuns) {
    const auto has_width = [](const ToySink& sink, std::int64_t us) {
        return std::ranges::any_of(
            sink.seen, [us](const auto& frame) { return frame.end_us - frame.begin_us == us; });
    };
    for (const bool threaded : {true, false}) {
        LiveChanges changes;
        PipelineSettings settings = quick_settings();  // windows of 1000 us
        settings.changes = &changes;
        PipelineUnderTest line{one_frame_per_packet(6), settings};
        line.source.before_read = [&](std::size_t packet) {
            SlicerSettings narrow;
            narrow.width = SensorDuration{500};
            if (packet == 3) changes.set_window(narrow);
        };
        threaded ? line.run() : line.run_sequential();
        EXPECT_TRUE(has_width(line.sink, 500));
        EXPECT_TRUE(threaded || has_width(line.sink, 1000)) << "until then";
        EXPECT_FALSE(changes.take_window()) << "it was taken";
    }
    PipelineUnderTest unchanged{one_frame_per_packet(6), quick_settings()};
    unchanged.run();
    EXPECT_FALSE(has_width(unchanged.sink, 500)) << "the detector detects";
}

TEST(Pipeline, OfAnEmptySourceWritesNothingAndClosesItsSinks) {
    for (const bool threaded : {true, false}) {
        PipelineUnderTest line({}, quick_settings());
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
        EXPECT_THROW(PipelineUnderTest({}, settings).made(), Error);
}

}  // namespace
}  // namespace eventide
