// The interface for C: the same frames, and every misuse is a status with words.
#include "tests/library/c_interface.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace eventide::test {
namespace {

TEST_F(CInterface, GivesTheFramesOfTheOneInCpp) {
    open();
    eventide_source* source = nullptr;
    ASSERT_EQ(eventide_recording_open(recording().c_str(), nullptr, 0, 0, &source), EVENTIDE_OK);
    EXPECT_EQ(eventide_source_width(source), 64);
    EXPECT_EQ(eventide_source_height(source), 48);
    const eventide_event* events = nullptr;
    std::size_t count = 0;
    std::string frames;
    const auto take_frames = [&] {
        for (eventide_frame f; eventide_next(reconstructor_, &f) == EVENTIDE_OK;) {
            EXPECT_EQ(f.width, 64);
            const auto bytes = std::size_t(f.width) * std::size_t(f.height) * sizeof(float);
            frames.append(reinterpret_cast<const char*>(f.intensity), bytes);
            frames.append(reinterpret_cast<const char*>(f.sigma), bytes);
        }
    };
    while (eventide_read(source, &events, &count) == EVENTIDE_OK) {
        EXPECT_EQ(eventide_push(reconstructor_, events, count), EVENTIDE_OK);
        take_frames();
    }
    std::int64_t end = 0;
    EXPECT_EQ(eventide_source_clock(source, &end), EVENTIDE_OK);
    EXPECT_EQ(eventide_finish(reconstructor_, &end), EVENTIDE_OK);
    take_frames();
    eventide_source_close(source);
    EXPECT_TRUE(frames == frames_of_run(repeatable_arguments("7ms", 1, false)));
    eventide_counters counters;
    EXPECT_EQ(eventide_count(reconstructor_, &counters), EVENTIDE_OK);
    EXPECT_EQ(counters.frames * 64 * 48 * 8, frames.size());
    EXPECT_EQ(counters.off_sensor + counters.time_backwards + counters.bad_time, 0U);
}

TEST_F(CInterface, KeepsAStateInMemory) {
    open();
    const eventide_event events[]{{1000, 3, 4, 1}, {9000, 5, 6, 0}, {40'000, 63, 47, 255}};
    ASSERT_EQ(eventide_push(reconstructor_, events, 3), EVENTIDE_OK);
    std::int64_t t = 0;
    ASSERT_EQ(eventide_newest(reconstructor_, &t), EVENTIDE_OK);
    const void* bytes = nullptr;
    std::size_t size = 0;
    ASSERT_EQ(eventide_state(reconstructor_, &bytes, &size), EVENTIDE_OK);
    const std::string state(static_cast<const char*>(bytes), size);
    ASSERT_EQ(eventide_reset(reconstructor_), EVENTIDE_OK);
    ASSERT_EQ(eventide_restore(reconstructor_, state.data(), state.size()), EVENTIDE_OK);
    ASSERT_EQ(eventide_state(reconstructor_, &bytes, &size), EVENTIDE_OK);
    EXPECT_EQ(state, std::string(static_cast<const char*>(bytes), size));
    EXPECT_EQ(eventide_restore(reconstructor_, state.data(), 5), EVENTIDE_INPUT);
    EXPECT_EQ(eventide_restore(reconstructor_, nullptr, 5), EVENTIDE_USAGE);
    EXPECT_EQ(eventide_state(reconstructor_, nullptr, &size), EVENTIDE_USAGE);
}

TEST_F(CInterface, FramesTellOfLostData) {
    open();
    const eventide_event before{1000, 3, 4, 1}, after{90'000, 5, 6, 0};
    ASSERT_EQ(eventide_push(reconstructor_, &before, 1), EVENTIDE_OK);
    ASSERT_EQ(eventide_mark_gap(reconstructor_), EVENTIDE_OK);
    ASSERT_EQ(eventide_push(reconstructor_, &after, 1), EVENTIDE_OK);
    ASSERT_EQ(eventide_finish(reconstructor_, nullptr), EVENTIDE_OK);
    eventide_frame frame;
    int frames = 0, marked = 0;
    std::uint64_t events = 0;
    for (; eventide_next(reconstructor_, &frame) == EVENTIDE_OK; ++frames) {
        marked += frame.gap_before;
        events = std::max(events, frame.events);
    }
    EXPECT_GT(frames, 5);
    EXPECT_EQ(events, 1U) << "in an event window";
    EXPECT_GE(marked, 1);
    EXPECT_LT(marked, frames);
}

TEST_F(CInterface, ASilenceIsRenderedWhereThatIsAllowed) {
    for (const int allow : {0, 1}) {
        eventide_options options = repeatable_options();
        options.allow_silence = allow;
        ASSERT_EQ(open_with(options), EVENTIDE_OK);
        const eventide_event events[]{{0, 3, 4, 1}, {1'000'000'000'000, 5, 6, 0}};
        ASSERT_EQ(eventide_push(reconstructor_, events, 2), EVENTIDE_OK);
        ASSERT_EQ(eventide_finish(reconstructor_, nullptr), EVENTIDE_OK);
        eventide_frame frame;
        eventide_status status = EVENTIDE_OK;
        for (int n = 0; n < 100 && status == EVENTIDE_OK; ++n)
            status = eventide_next(reconstructor_, &frame);
        EXPECT_EQ(status, allow != 0 ? EVENTIDE_OK : EVENTIDE_INPUT);
        eventide_reconstructor_close(std::exchange(reconstructor_, nullptr));
    }
}

eventide_image whole_image(const std::vector<std::uint16_t>& pixels) {
    return {.t = 15'000,
            .exposure_begin = 12'000,
            .exposure_end = 18'000,
            .x = 0,
            .y = 0,
            .width = 64,
            .height = 48,
            .pixels = pixels.data()};
}

TEST_F(CInterface, FramesHaveNoSigmaAndNoImageCorrectsThemWhereThatIsNotWanted) {
    eventide_options options = repeatable_options();
    options.sigma = options.images = 0;
    ASSERT_EQ(open_with(options), EVENTIDE_OK);
    const eventide_event before{1000, 3, 4, 1}, after{60'000, 5, 6, 0};
    const std::vector<std::uint16_t> grey(64 * 48, 52'428);
    const eventide_image image = whole_image(grey);
    ASSERT_EQ(eventide_push(reconstructor_, &before, 1), EVENTIDE_OK);
    ASSERT_EQ(eventide_push_image(reconstructor_, &image), EVENTIDE_OK);
    ASSERT_EQ(eventide_push(reconstructor_, &after, 1), EVENTIDE_OK);
    eventide_frame frame;
    std::int64_t t = 0;
    ASSERT_EQ(eventide_newest(reconstructor_, &t), EVENTIDE_OK);
    ASSERT_EQ(eventide_render(reconstructor_, t, nullptr, &frame), EVENTIDE_OK);
    EXPECT_NE(frame.intensity, nullptr);
    EXPECT_EQ(frame.sigma, nullptr);
    eventide_counters counters;
    ASSERT_EQ(eventide_count(reconstructor_, &counters), EVENTIDE_OK);
    EXPECT_EQ(counters.used_images, 0U);
}

TEST_F(CInterface, ImagesCorrectFrames) {
    open();
    const eventide_event before{1000, 3, 4, 1}, after{60'000, 5, 6, 0};
    const std::vector<std::uint16_t> grey(64 * 48, 52'428);
    const eventide_image image = whole_image(grey);
    ASSERT_EQ(eventide_push(reconstructor_, &before, 1), EVENTIDE_OK);
    ASSERT_EQ(eventide_push_image(reconstructor_, &image), EVENTIDE_OK) << eventide_error_message();
    ASSERT_EQ(eventide_push(reconstructor_, &after, 1), EVENTIDE_OK);
    std::int64_t t = 0;
    eventide_frame frame;
    ASSERT_EQ(eventide_newest(reconstructor_, &t), EVENTIDE_OK);
    ASSERT_EQ(eventide_render(reconstructor_, t, nullptr, &frame), EVENTIDE_OK);
    for (int i = 0; i < 64 * 48; ++i) ASSERT_NEAR(frame.intensity[i], .8F, .02F) << i;
    eventide_counters counters;
    ASSERT_EQ(eventide_count(reconstructor_, &counters), EVENTIDE_OK);
    EXPECT_EQ(counters.used_images, 1U);
    EXPECT_EQ(counters.dropped_images, 0U);

    eventide_image wrong = image;
    wrong.height = 0;
    EXPECT_EQ(eventide_push_image(reconstructor_, &wrong), EVENTIDE_USAGE);
    EXPECT_TRUE(said("expected 1 to 4096 px each way, found 64x0")) << eventide_error_message();
    wrong = image;
    wrong.x = 5000;
    EXPECT_EQ(eventide_push_image(reconstructor_, &wrong), EVENTIDE_USAGE);
    wrong = image;
    wrong.pixels = nullptr;
    EXPECT_EQ(eventide_push_image(reconstructor_, &wrong), EVENTIDE_USAGE);
    EXPECT_EQ(eventide_push_image(reconstructor_, nullptr), EVENTIDE_USAGE);
}

TEST_F(CInterface, RendersAnyReadyTimeInAnySize) {
    open();
    std::int64_t t = 0;
    EXPECT_EQ(eventide_newest(reconstructor_, &t), EVENTIDE_NONE);
    const eventide_event events[]{{1000, 3, 4, 1}, {9000, 5, 6, 0}, {40'000, 63, 47, 255}};
    ASSERT_EQ(eventide_push(reconstructor_, events, 3), EVENTIDE_OK);
    ASSERT_EQ(eventide_newest(reconstructor_, &t), EVENTIDE_OK);
    EXPECT_EQ(eventide_ready(reconstructor_, t), EVENTIDE_OK);
    EXPECT_EQ(eventide_ready(reconstructor_, t + 1), EVENTIDE_NONE);
    eventide_frame frame;
    const eventide_frame_size size{128, 96, {10, 20, 30, 40}};
    ASSERT_EQ(eventide_render(reconstructor_, t, &size, &frame), EVENTIDE_OK);
    EXPECT_EQ(frame.width, 30);
    EXPECT_EQ(frame.height, 40);
    EXPECT_EQ(frame.t, t);
    EXPECT_EQ(eventide_render(reconstructor_, t + 100'000, nullptr, &frame), EVENTIDE_USAGE);
    EXPECT_TRUE(said("not pushed yet")) << eventide_error_message();
    EXPECT_EQ(eventide_save_state(reconstructor_, (temp_ / "state").c_str(), 0), EVENTIDE_OK);
    EXPECT_EQ(eventide_save_state(reconstructor_, (temp_ / "state").c_str(), 0), EVENTIDE_USAGE);
    EXPECT_EQ(eventide_restore_state(reconstructor_, (temp_ / "state").c_str()), EVENTIDE_OK);
    EXPECT_EQ(eventide_reset(reconstructor_), EVENTIDE_OK);
    EXPECT_EQ(eventide_newest(reconstructor_, &t), EVENTIDE_NONE);
}

TEST_F(CInterface, RefusesWhatMakesNoSenseInWords) {
    eventide_frame frame;
    EXPECT_EQ(eventide_next(nullptr, &frame), EVENTIDE_USAGE);
    EXPECT_TRUE(said("expected a reconstructor, found NULL")) << eventide_error_message();
    EXPECT_EQ(eventide_reconstructor_open("nobody", 64, 48, nullptr, &reconstructor_),
              EVENTIDE_INPUT);
    EXPECT_EQ(reconstructor_, nullptr);
    EXPECT_TRUE(said("'nobody'"));
    EXPECT_EQ(eventide_reconstructor_open(nullptr, 64, 48, nullptr, &reconstructor_),
              EVENTIDE_USAGE);
    EXPECT_EQ(eventide_reconstructor_open("default", 64, 48, nullptr, nullptr), EVENTIDE_USAGE);
    eventide_options options = repeatable_options();
    options.precision = "f64";
    EXPECT_EQ(open_with(options), EVENTIDE_USAGE);
    EXPECT_TRUE(said("precision: expected auto, f32 or bf16, found 'f64'"));
    options = repeatable_options();
    options.self_ensemble = 3;
    EXPECT_EQ(open_with(options), EVENTIDE_USAGE);
    EXPECT_TRUE(said("self-ensemble: expected 1, 2 or 4"));
    options = repeatable_options();
    options.struct_size = 9999;
    EXPECT_EQ(open_with(options), EVENTIDE_USAGE);
    EXPECT_TRUE(said("struct_size"));
    for (const std::size_t size :
         {std::size_t{0}, sizeof options.struct_size - 1, sizeof options.struct_size + 4}) {
        options.struct_size = size;
        EXPECT_EQ(open_with(options), EVENTIDE_USAGE) << size;
    }
    options = repeatable_options();
    options.window = nullptr;
    EXPECT_EQ(open_with(options), EVENTIDE_USAGE);
    open();
    EXPECT_EQ(eventide_push(reconstructor_, nullptr, 0), EVENTIDE_OK) << "nothing is pushed";
    EXPECT_EQ(eventide_push(reconstructor_, nullptr, 5), EVENTIDE_USAGE);
    EXPECT_EQ(eventide_next(reconstructor_, nullptr), EVENTIDE_USAGE);
    eventide_source* source = nullptr;
    EXPECT_EQ(eventide_recording_open((temp_ / "none").c_str(), nullptr, 0, 0, &source),
              EVENTIDE_INPUT);
    EXPECT_EQ(eventide_camera_open("kodak:", nullptr, 0, &source), EVENTIDE_USAGE);
    EXPECT_EQ(eventide_camera_open("sim:demo", "davis.toml", 0, &source), EVENTIDE_USAGE);
    EXPECT_TRUE(said("camera settings 'davis.toml'"));
    EXPECT_EQ(source, nullptr);
    eventide_source_close(nullptr);
    eventide_writer_close(nullptr);
}

TEST_F(CInterface, OfOlderHeadersHasTheDefaultsOfWhatTheyLack) {
    eventide_options options = repeatable_options();
    options.struct_size = offsetof(eventide_options, hot_pixels);
    options.hot_pixels = "beyond what the caller knows";
    EXPECT_EQ(open_with(options), EVENTIDE_OK) << eventide_error_message();
}

TEST_F(CInterface, KeepsTheErrorsOfCodeAroundIt) {
    EXPECT_EQ(eventide_set_error(EVENTIDE_DEVICE, "lens: expected one, found none"),
              EVENTIDE_DEVICE);
    EXPECT_STREQ(eventide_error_message(), "lens: expected one, found none");
    eventide_set_error(EVENTIDE_INPUT, eventide_error_message() + 6);
    EXPECT_STREQ(eventide_error_message(), "expected one, found none") << "a part of itself";
    eventide_set_error(EVENTIDE_FAILED, std::string(5000, 'x').c_str());
    EXPECT_EQ(eventide_error_message(), std::string(1023, 'x'));
    EXPECT_EQ(eventide_set_error(EVENTIDE_OK, nullptr), EVENTIDE_OK);
    EXPECT_STREQ(eventide_error_message(), "");
}

TEST_F(CInterface, RefusesANoiseFilterThatIsNone) {
    eventide_options options = repeatable_options();
    options.noise_filter = "a lot";
    EXPECT_EQ(open_with(options), EVENTIDE_USAGE);
    EXPECT_NE(std::string{eventide_error_message()}.find("a lot"), std::string::npos);
    options.noise_filter = "20ms";
    EXPECT_EQ(open_with(options), EVENTIDE_OK) << eventide_error_message();
}

TEST(CVersion, IsThatOfTheHeaders) {
    EXPECT_STREQ(eventide_version(), version());
}

}  // namespace
}  // namespace eventide::test
