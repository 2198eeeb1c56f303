// Gaps in the data, and clocks that were reset.
#include "tests/pipeline/toy_pipeline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>
#include <thread>
#include <tuple>
#include <vector>

namespace eventide {
namespace {

using namespace test;

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

/// Keeps the age of one pixel in each event window.
class AgeKeeper final : public EncodeStage {
public:
    explicit AgeKeeper(int x) : x_(x) {}
    LatentMap make_output() const override { return toy_.make_output(); }
    void reset() noexcept override { toy_.reset(); }

    std::vector<float> ages;

private:
    void step(const VoxelGrid& grid, LatentMap& latent) noexcept override {
        ages.push_back(grid.values.pixel(0, x_).back());
        toy_.encode(grid, latent);
    }
    int x_;
    ToyEncoder toy_;
};

TEST(Pipeline, KnowsNoEventsOfBeforeAGapWhereItsStateBeginsAnew) {
    for (const bool reset : {false, true}) {
        PipelineSettings settings = quick_settings();
        settings.reset_on_gap = reset;
        ToySource toy(one_frame_per_packet(15));
        GappySource source(toy);
        source.gaps = {10};
        AgeKeeper encoder{7};  // has an event in window 7; data are missing in window 9
        ToyRenderer renderer;
        ToySink sink;
        Pipeline pipeline({source, encoder, renderer, {&sink}}, settings);
        pipeline.run_sequential();
        ASSERT_GT(encoder.ages.size(), 10U);
        EXPECT_EQ(encoder.ages[7], 0);
        EXPECT_EQ(encoder.ages[8], 1 / 8.F);
        EXPECT_EQ(encoder.ages[9], reset ? 1 : 2 / 8.F);
    }
}

TEST(Pipeline, KnowsNoEventsOfBeforeTheCamerasClockWasReset) {
    std::vector<std::vector<std::byte>> packets(4);
    for (const auto& [packet, us, x] :
         {std::tuple{0, 100'001, 7}, {1, 101'001, 6}, {2, 1, 5}, {3, 2001, 5}})
        append_record(packets[std::size_t(packet)], ToyKind::event, us, x);
    ToySource toy(packets);
    AgeKeeper encoder{7};
    ToyRenderer renderer;
    ToySink sink;
    Pipeline pipeline({toy, encoder, renderer, {&sink}}, quick_settings());
    pipeline.run_sequential();
    ASSERT_GE(encoder.ages.size(), 4U);
    EXPECT_EQ(encoder.ages[1], 1 / 8.F);
    EXPECT_EQ(encoder.ages[2], 1) << "the new stream's first";
    EXPECT_EQ(to_us(pipeline.snapshot().begin), 100'000) << "of the run";
}

/// Is busy with the first event window for as long as it is told.
class BusyEncoder final : public EncodeStage {
public:
    LatentMap make_output() const override { return toy_.make_output(); }
    void reset() noexcept override { toy_.reset(); }

    std::function<void()> before_first;
    std::vector<WindowStamp> given;

private:
    void step(const VoxelGrid& grid, LatentMap& latent) noexcept override {
        if (given.empty()) before_first();
        given.push_back(grid);
        toy_.encode(grid, latent);
    }
    ToyEncoder toy_;
};

TEST(Pipeline, WindowsThatWaitAreNoneOverAGapWhereStateBeginsAnew) {
    for (const bool reset : {false, true}) {
        PipelineSettings settings = quick_settings();
        settings.reset_on_gap = reset;
        settings.buffers.grids = 1;
        settings.latency = std::chrono::hours{1};
        ToySource toy(one_frame_per_packet(15), true);
        GappySource source(toy);
        source.gaps = {10};  // in the window from 9000 us on
        BusyEncoder encoder;
        ToyRenderer renderer;
        ToySink sink;
        Pipeline pipeline({source, encoder, renderer, {&sink}}, settings);
        encoder.before_first = [&] {
            while (pipeline.snapshot().events < 11) std::this_thread::yield();
        };
        pipeline.run();
        const auto after = std::ranges::find(encoder.given, true, &WindowStamp::gap_before);
        ASSERT_NE(after, encoder.given.end());
        EXPECT_EQ(to_us(after->window.begin), reset ? 9000 : 1000);
    }
}

TEST(Pipeline, BeginsANewStreamWhereTheCamerasClockWasReset) {
    auto first = toy_events(1000, 1, 500'000), second = toy_events(1000, 2, 1000);
    auto both = first;
    both.insert(both.end(), second.begin(), second.end());
    for (const bool threaded : {true, false}) {
        PipelineUnderTest line(ToySource::packets_of(bytes_of(both), 333), quick_settings());
        threaded ? line.run() : line.run_sequential();
        EXPECT_EQ(line.encoder.resets, 1);
        EXPECT_EQ(line.snapshot().slicing.time_resets, 1U);
        PipelineUnderTest alone({bytes_of(second)}, quick_settings());
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

}  // namespace
}  // namespace eventide
