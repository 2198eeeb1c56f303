// What options and arguments of the C interface change.
#include "tests/library/c_interface.h"

#include <string>
#include <vector>

namespace eventide::test {
namespace {

class COptions : public CInterface {
protected:
    /// Of a point that moves, with a gap after 50 ms; the stream ends at `end`.
    std::string frames_with(const eventide_options& options, std::int64_t end = 100'000) {
        eventide_reconstructor_close(reconstructor_);
        EXPECT_EQ(open_with(options), EVENTIDE_OK) << eventide_error_message();
        for (std::int64_t t = 1000; t <= 100'000; t += 50) {
            const eventide_event event{t, std::uint16_t(t / 2000), std::uint16_t(t / 50 % 48), 1};
            EXPECT_EQ(eventide_push(reconstructor_, &event, 1), EVENTIDE_OK);
            if (t == 50'000) {
                EXPECT_EQ(eventide_mark_gap(reconstructor_), EVENTIDE_OK);
            }
        }
        EXPECT_EQ(eventide_finish(reconstructor_, &end), EVENTIDE_OK);
        std::string frames;
        for (eventide_frame f; eventide_next(reconstructor_, &f) == EVENTIDE_OK;)
            frames.append(reinterpret_cast<const char*>(f.intensity), 64 * 48 * sizeof(float));
        return frames;
    }
};

TEST_F(COptions, ChangeTheFrames) {
    eventide_options options = repeatable_options();
    const std::string as_they_are = frames_with(options);
    options.reset_on_gap = 1;
    EXPECT_NE(frames_with(options), as_they_are);
    options = repeatable_options();
    options.self_ensemble = 2;
    EXPECT_NE(frames_with(options), as_they_are);
}

TEST_F(COptions, FramesGoOnToTheEndThatIsTold) {
    const eventide_options options = repeatable_options();
    EXPECT_EQ(frames_with(options, 200'000).size(),
              frames_with(options).size() + 10 * 64 * 48 * sizeof(float));
}

TEST_F(COptions, AnImageOfAPartOfTheSensorCorrectsThatPart) {
    open();
    const eventide_event before{1000, 3, 4, 1}, after{60'000, 5, 6, 0};
    const std::vector<std::uint16_t> grey(30 * 20, 52'428);
    eventide_image image{15'000, 12'000, 18'000, 8, 24, 30, 20, grey.data()};
    ASSERT_EQ(eventide_push(reconstructor_, &before, 1), EVENTIDE_OK);
    ASSERT_EQ(eventide_push_image(reconstructor_, &image), EVENTIDE_OK) << eventide_error_message();
    ASSERT_EQ(eventide_push(reconstructor_, &after, 1), EVENTIDE_OK);
    std::int64_t t = 0;
    eventide_frame frame;
    ASSERT_EQ(eventide_newest(reconstructor_, &t), EVENTIDE_OK);
    ASSERT_EQ(eventide_render(reconstructor_, t, nullptr, &frame), EVENTIDE_OK);
    for (int y = 24; y < 44; ++y)
        for (int x = 8; x < 38; ++x)
            ASSERT_NEAR(frame.intensity[y * 64 + x], .8F, .02F) << x << "," << y;
    image.exposure_begin = image.exposure_end + 1;
    EXPECT_EQ(eventide_push_image(reconstructor_, &image), EVENTIDE_USAGE);
    EXPECT_TRUE(said("exposure_end not before exposure_begin")) << eventide_error_message();
}

TEST_F(COptions, ARegionIsThatPartOfTheFrame) {
    frames_with(repeatable_options());
    std::int64_t t = 0;
    eventide_frame frame;
    ASSERT_EQ(eventide_newest(reconstructor_, &t), EVENTIDE_OK);
    ASSERT_EQ(eventide_render(reconstructor_, t, nullptr, &frame), EVENTIDE_OK);
    const std::vector<float> whole(frame.intensity, frame.intensity + 64 * 48);
    const eventide_frame_size part{0, 0, {3, 7, 10, 20}};
    ASSERT_EQ(eventide_render(reconstructor_, t, &part, &frame), EVENTIDE_OK);
    ASSERT_EQ(frame.width, 10);
    ASSERT_EQ(frame.height, 20);
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 10; ++x)
            ASSERT_EQ(frame.intensity[y * 10 + x], whole[std::size_t(64 * (y + 7) + x + 3)])
                << x << "," << y;
}

TEST_F(COptions, AnEventThatComesAfterItsTimeIsCountedAsLate) {
    eventide_options options = repeatable_options();
    options.noise_filter = options.lamp_flicker = "off";
    ASSERT_EQ(open_with(options), EVENTIDE_OK);
    const eventide_event first{0, 1, 2, 1}, late{50'000, 1, 2, 1};
    std::int64_t t = 0;
    EXPECT_EQ(eventide_push(reconstructor_, &first, 1), EVENTIDE_OK);
    EXPECT_EQ(eventide_advance(reconstructor_, 100'000), EVENTIDE_OK);
    EXPECT_EQ(eventide_newest(reconstructor_, &t), EVENTIDE_OK);
    EXPECT_EQ(eventide_push(reconstructor_, &late, 1), EVENTIDE_OK);
    eventide_counters counters;
    ASSERT_EQ(eventide_count(reconstructor_, &counters), EVENTIDE_OK);
    EXPECT_EQ(counters.late, 1U);
    EXPECT_EQ(counters.filtered, 0U);
}

TEST_F(COptions, AStateIsReplacedWhereThatIsWanted) {
    open();
    const std::string file = temp_ / "state.safetensors";
    EXPECT_EQ(eventide_save_state(reconstructor_, file.c_str(), 0), EVENTIDE_OK);
    EXPECT_EQ(eventide_save_state(reconstructor_, file.c_str(), 0), EVENTIDE_USAGE);
    EXPECT_EQ(eventide_save_state(reconstructor_, file.c_str(), 1), EVENTIDE_OK);
}

}  // namespace
}  // namespace eventide::test
