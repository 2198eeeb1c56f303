// The real model in the pipeline: threads and splits change no bit, and nothing is allocated.
#include "pipeline/model_render_stage.h"
#include "pipeline/parallel_tbb.h"
#include "pipeline/pipeline.h"
#include "src/model/encode/encoder.h"
#include "tests/model/streams.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/random_model.h"
#include "tests/support/toy_stages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <new>
#include <random>
#include <vector>

namespace eventide {
namespace {

using namespace test;

constexpr int kHeight = 45, kWidth = 61;

/// Edges that wander, 5 events in each millisecond, a pause in between.
std::vector<std::byte> moving_scene(int milliseconds) {
    std::mt19937 rng{9};
    std::vector<std::byte> bytes;
    for (int ms = 0; ms < milliseconds; ++ms) {
        if (ms % 400 > 300) continue;
        for (int n = 0; n < 5; ++n)
            append_record(bytes, ToyKind::event, 1000 * ms + 1 + 190 * n,
                          (ms / 7 + int(rng() % 9)) % kWidth, int(rng() % unsigned(kHeight)),
                          rng() % 2 == 0);
    }
    return bytes;
}

struct ModelRun {
    ModelRun(std::vector<std::vector<std::byte>> packets, const Model& model,
             const PipelineSettings& settings, const EngineOptions& options)
        : source(std::move(packets), false, kHeight, kWidth),
          encoder(model, kWidth, kHeight, options),
          renderer(model, kWidth, kHeight, options),
          render(renderer, request(settings.lookahead)),
          pipeline({source, encoder, render, {&sink}}, settings) {}

    static RenderRequest request(int lookahead) {
        RenderRequest request;
        request.lookahead = lookahead;
        return request;
    }

    ToySource source;
    Encoder encoder;
    Renderer renderer;
    ModelRenderStage render;
    ToySink sink;
    Pipeline pipeline;
};

PipelineSettings settings_for(const Model& model, int lookahead) {
    PipelineSettings settings;
    settings.bins = model.config.bins;
    settings.event_windows.slicer = parse_window("20ms");
    settings.rate = {120, 1};
    settings.lookahead = lookahead;
    return settings;
}

TEST(ModelLine, GivesTheSameFramesThreadedAsSequentialWithAnyNumberOfWorkers) {
    const Model model = test::random_model(small_config(), 1);
    const auto bytes = moving_scene(700);
    for (const int lookahead : {0, 1, 2}) {
        SCOPED_TRACE(lookahead);
        EngineOptions options;
        options.precision = Precision::f32;
        const PipelineSettings settings = settings_for(model, lookahead);
        ModelRun whole({bytes}, model, settings, options);
        whole.pipeline.run_sequential();
        ASSERT_GT(whole.sink.seen.size(), 80U);
        options.parallel_for = parallel_for_with(2);
        std::mt19937 rng{2};
        ModelRun split(ToySource::packets_of(bytes, 900, &rng), model, settings, options);
        split.pipeline.run();
        EXPECT_EQ(split.sink.seen, whole.sink.seen);
    }
}

/// The same with images among the events that correct the frames.
struct FusedRun : DataObserver {
    FusedRun(std::vector<std::vector<std::byte>> packets, const Model& model,
             PipelineSettings settings)
        : source(std::move(packets), false, kHeight, kWidth),
          encoder(model, kWidth, kHeight),
          renderer(model, kWidth, kHeight),
          render(renderer, ModelRun::request(settings.lookahead), kWidth, kHeight, images),
          pipeline({source, encoder, render, {&sink}, nullptr, this}, with_counts(settings)) {}

    static PipelineSettings with_counts(PipelineSettings settings) {
        settings.events_per_pixel = true;
        return settings;
    }
    void see(const Batch& batch) override {
        std::vector<ReferenceImage> white = batch.images;  // those of the toy camera are empty
        for (ReferenceImage& image : white) {
            image.pixels = Array2<std::uint16_t>(kHeight, kWidth);
            for (std::uint16_t& pixel : image.pixels.values()) pixel = 50'000;
        }
        images.put(white);
    }

    ToySource source;
    Encoder encoder;
    Renderer renderer;
    ImagesOnTheWay images;
    ModelRenderStage render;
    ToySink sink;
    Pipeline pipeline;
};

/// Of the first 20 ms, in which the stream gave so many images.
LatentMap first_latent(const Encoder& encoder, std::uint64_t images) {
    LatentMap latent = encoder.make_output();
    latent.window = {from_us(0), from_us(20'000)};
    latent.events_per_pixel = Array2<float>(kHeight, kWidth);
    latent.images = images;
    return latent;
}

TEST(ModelRenderStage, CountsTheImagesThatCorrectNothing) {
    const Model model = test::random_model(small_config(), 1);
    Encoder encoder(model, kWidth, kHeight);
    Renderer renderer(model, kWidth, kHeight);
    ImagesOnTheWay images;
    images.keep_at_most(2);
    ModelRenderStage stage(renderer, ModelRun::request(0), kWidth, kHeight, images);
    std::vector<ReferenceImage> three(3);
    for (ReferenceImage& image : three) image.pixels = Array2<std::uint16_t>(kHeight, kWidth);
    images.put(three);
    EXPECT_EQ(stage.dropped_images(), 1U) << "more than may be on their way";
    LatentMap latent = first_latent(encoder, 2);
    stage.take(latent);
    EXPECT_EQ(stage.used_images(), 1U);
    three[2].t = from_us(30'000);
    images.put({three[2]});
    latent.images = 4;
    latent.window = {from_us(20'000), from_us(25'000)};
    stage.take(latent);
    EXPECT_EQ(stage.used_images(), 2U);
    stage.reset();
    EXPECT_EQ(stage.dropped_images(), 2U) << "it was still waiting for its time";
}

TEST(ModelRenderStage, GoesOnInTheSizeItHasWhereThereIsNoMemoryForAnother) {
    if (!test::can_count_allocations()) GTEST_SKIP() << "sanitizers bring their own malloc";
    const Model model = test::random_model(small_config(), 1);
    Encoder encoder(model, kWidth, kHeight);
    Renderer renderer(model, kWidth, kHeight);
    ImagesOnTheWay images;
    ModelRenderStage stage(renderer, ModelRun::request(0), kWidth, kHeight, images);
    ReferenceImage white;
    white.pixels = Array2<std::uint16_t>(kHeight, kWidth);
    std::ranges::fill(white.pixels.values(), std::uint16_t{50'000});
    images.put({white});
    LatentMap latent = first_latent(encoder, 1);
    stage.take(latent);
    ASSERT_EQ(stage.used_images(), 1U);
    const auto shown = [&](Frame& frame) {
        stage.render(from_us(20'000), latent.window, frame);
        return frame.intensity;
    };
    Frame frame = stage.make_output();
    const Array2<float> before = shown(frame);
    {
        // Enough for a small frame, and not for what is shown at the sensor's size beside it.
        const test::MemoryShortage shortage{kWidth * kHeight * sizeof(float)};
        EXPECT_THROW(stage.change_size(kWidth / 3, kHeight / 3, frame), std::bad_alloc);
    }
    EXPECT_EQ(frame.intensity, before);
    EXPECT_EQ(shown(frame), before);
    EXPECT_TRUE(stage.change_size(kWidth / 3, kHeight / 3, frame));
    EXPECT_EQ(shown(frame).width(), kWidth / 3);
}

TEST(ModelLine, ImagesOfTheCameraCorrectTheSameFramesThreadedAsSequential) {
    const Model model = test::random_model(small_config(), 1);
    std::vector<std::byte> bytes = moving_scene(300);
    const auto before = std::ptrdiff_t(bytes.size());
    append_record(bytes, ToyKind::image, 299'990);
    const auto later = moving_scene(800);
    bytes.insert(bytes.end(), later.begin() + before, later.end());
    for (const int lookahead : {0, 2}) {
        SCOPED_TRACE(lookahead);
        const PipelineSettings settings = settings_for(model, lookahead);
        FusedRun whole({bytes}, model, settings);
        whole.pipeline.run_sequential();
        EXPECT_EQ(whole.render.used_images(), 1U);
        EXPECT_EQ(whole.render.dropped_images(), 0U);
        std::mt19937 rng{2};
        FusedRun split(ToySource::packets_of(bytes, 900, &rng), model, settings);
        split.pipeline.run();
        EXPECT_TRUE(split.sink.seen == whole.sink.seen);
        ModelRun without({bytes}, model, settings, {});
        without.pipeline.run_sequential();
        EXPECT_FALSE(without.sink.seen == whole.sink.seen);
    }
}

TEST(ModelLine, AnImageInTheFirstWindowOfANewClockCorrects) {
    const Model model = test::random_model(small_config(), 1);
    std::vector<std::byte> bytes;
    for (const int second : {40, 0}) {  // the clock begins anew
        for (int ms = 1; ms < 50; ++ms) {
            append_record(bytes, ToyKind::event, 1'000'000 * second + 1000 * ms, ms, ms / 2, true);
            if (ms == 10) append_record(bytes, ToyKind::image, 1'000'000 * second + 9000);
        }
    }
    for (const int lookahead : {0, 2}) {
        FusedRun run({bytes}, model, settings_for(model, lookahead));
        run.pipeline.run_sequential();
        EXPECT_EQ(run.render.used_images(), 2U);
        EXPECT_EQ(run.render.dropped_images(), 0U);
    }
}

/// Neither the state nor codes nor kept frames of the old clock's stream are left.
TEST(ModelLine, FramesOfANewClockAreThoseOfAStreamOfItsOwn) {
    const Model model = test::random_model(small_config(), 1);
    const auto own = moving_scene(300);
    std::vector<std::byte> both;
    for (int ms = 1; ms < 200; ++ms)
        append_record(both, ToyKind::event, 40'000'000 + 1000 * ms, ms % kWidth, ms % kHeight);
    both.insert(both.end(), own.begin(), own.end());
    for (const int lookahead : {0, 2}) {
        SCOPED_TRACE(lookahead);
        ModelRun alone({own}, model, settings_for(model, lookahead), {}),
            second({both}, model, settings_for(model, lookahead), {});
        alone.pipeline.run_sequential();
        second.pipeline.run_sequential();
        const auto& expected = alone.sink.seen;
        ASSERT_GT(second.sink.seen.size(), expected.size());
        const auto first = second.sink.seen.size() - expected.size();
        for (std::size_t i = 0; i < expected.size(); ++i) {
            const ToySink::Seen& found = second.sink.seen[first + i];
            ASSERT_EQ(found.t_us, expected[i].t_us);
            EXPECT_EQ(found.intensity, expected[i].intensity) << "at " << found.t_us << " us";
            EXPECT_EQ(found.sigma, expected[i].sigma) << "at " << found.t_us << " us";
        }
    }
}

TEST(ModelLine, EveryImageOfARecordingCorrectsAlsoWhereThereAreMoreThanWindowsHold) {
    const Model model = test::random_model(small_config(), 1);
    constexpr int kImages = 900;
    std::vector<std::byte> bytes;
    append_record(bytes, ToyKind::event, 1, 2, 2, true);
    for (int i = 1; i <= kImages; ++i) {  // five a millisecond: a hundred in a window
        append_record(bytes, ToyKind::image, 200 * i);
        append_record(bytes, ToyKind::event, 200 * i + 1, i % kWidth, i % kHeight, true);
    }
    const PipelineSettings settings = settings_for(model, 2);
    FusedRun whole({bytes}, model, settings);
    whole.pipeline.run_sequential();
    EXPECT_EQ(whole.images.dropped(), 0U);
    EXPECT_EQ(whole.render.fused()->used(), std::uint64_t(kImages));
    EXPECT_EQ(whole.render.dropped_images(), 0U);
    FusedRun split(ToySource::packets_of(bytes, 900), model, settings);
    split.pipeline.run();
    EXPECT_EQ(split.render.fused()->used(), std::uint64_t(kImages));
    EXPECT_TRUE(split.sink.seen == whole.sink.seen);
}

TEST(ImagesOnTheWay, AreAllKeptAndOfALiveSourceCountedWhereTheyAreNot) {
    ImagesOnTheWay all, live;
    live.keep_at_most(2);
    for (int i = 0; i < 200; ++i) {
        ReferenceImage image;
        image.t = from_us(i);
        all.put({image});
        live.put({image});
    }
    EXPECT_EQ(all.dropped(), 0U);
    EXPECT_EQ(all.take(1)->t, from_us(0));
    EXPECT_FALSE(all.take(1).has_value());
    EXPECT_EQ(live.dropped(), 198U);
    EXPECT_FALSE(live.take(198).has_value());
    EXPECT_EQ(live.take(199)->t, from_us(198));
}

TEST(ModelLine, AllocatesNothingPerEventWindowOnceWarm) {
    if (!can_count_allocations()) GTEST_SKIP() << "sanitizers bring their own malloc";
    const Model model = test::random_model(small_config(), 1);
    const auto bytes = moving_scene(6000);
    for (const bool threaded : {true, false}) {
        EngineOptions options;
        options.precision = Precision::f32;
        PipelineSettings settings = settings_for(model, 2);
        settings.buffers.packets = 4;  // warm is when every buffer has been used
        ModelRun run(ToySource::packets_of(bytes, 1000), model, settings, options);
        run.sink.keeps = false;
        std::int64_t allocations = -1;
        run.sink.before_write = [&](std::uint64_t frame) {
            if (frame == 300) start_counting_allocations();
            if (frame == 600) allocations = stop_counting_allocations();
        };
        threaded ? run.pipeline.run() : run.pipeline.run_sequential();
        EXPECT_EQ(allocations, 0) << (threaded ? "threaded" : "sequential");
    }
}

}  // namespace
}  // namespace eventide
