// A recording in a lamp's light: what it adds is left out alike by the program and the library,
// threaded or not, and where a run goes on from another's state.
#include "tests/library/library_test.h"
#include "tests/support/flickering_light.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace eventide::test {
namespace {

using testing::HasSubstr;

class LampFlicker : public LibraryTest {
protected:
    void SetUp() override {
        EventWriter writer{temp_ / "lamp.aedat4", {"", "", "", 64, 48}};
        writer.write(merged(lamp_events({.width = 64, .height = 48, .seconds = .9}),
                            bar_events(64, 48, .9, 700)));
        writer.finish();
    }
    /// What `run` says, and intensity and sigma of its frames.
    std::pair<std::string, std::string> run_of(std::vector<std::string> arguments,
                                               const std::string& window = "30ms") const {
        arguments.insert(arguments.begin(),
                         {"run", "lamp.aedat4", "--model", model(), "--out", "grayf32:frames",
                          "--uncertainty", "separate", "--sigma-white", "1", "--overwrite"});
        for (const std::string& word : repeatable_arguments(window, 1, false))
            arguments.push_back(word);
        const Result result = eventide(arguments);
        EXPECT_EQ(result.exit_code, 0) << result.error;
        return {result.error, read_text(temp_ / "frames")};
    }
    std::string frames_of_library(const std::string& lamp_flicker,
                                  const std::string& window) const {
        ReconstructorOptions options = repeatable(window, 1);
        options.lamp_flicker = lamp_flicker;
        Reconstructor reconstructor = this->reconstructor(options);
        EventReader reader{temp_ / "lamp.aedat4"};
        std::string frames;
        for (Frame frame; read_frame(reader, reconstructor, frame);) append_frame(frame, frames);
        return frames;
    }
};

TEST_F(LampFlicker, IsFoundAndSaid) {
    const auto [words, frames] = run_of({});
    EXPECT_THAT(words, testing::ContainsRegex("light flickered at (299|300|301) Hz: "));
    const auto [off_words, off_frames] = run_of({"--lamp-flicker", "off"});
    EXPECT_EQ(off_words.find("flickered"), std::string::npos);
    EXPECT_EQ(frames.size(), off_frames.size()) << "no frame is lost for events that wait";
    EXPECT_FALSE(frames == off_frames);
}

TEST_F(LampFlicker, IsLeftOutByTheLibraryAsByTheProgram) {
    for (const std::string window : {"30ms", "auto"})
        for (const std::string wait : {"off", "2500us", "16ms"})
            EXPECT_TRUE(frames_of_library(wait, window) ==
                        run_of({"--lamp-flicker", wait}, window).second)
                << window << ", " << wait;
    EXPECT_TRUE(frames_of_library("16ms", "30ms") == run_of({}).second) << "as of a recording";
}

TEST_F(LampFlicker, IsLeftOutAlikeByOneThreadAndByMany) {
    EXPECT_TRUE(run_of({"--sequential"}).second == run_of({}).second);
}

TEST_F(LampFlicker, IsLeftOutOfTheEventsThatAreWritten) {
    const auto [words, frames] = run_of({"--events-out", "left.aedat4"});
    EXPECT_TRUE(frames == run_of({}).second) << "written or not";
    EXPECT_EQ(words.find("warning"), std::string::npos) << words;
    EXPECT_THAT(words, HasSubstr("light flickered at "));
    const std::vector<Event> all = events_of(temp_ / "lamp.aedat4"),
                             left = events_of(temp_ / "left.aedat4");
    EXPECT_TRUE(std::ranges::includes(all, left, {}, &Event::t, &Event::t));
    EXPECT_LT(left.size(), all.size() / 4);
    EXPECT_GT(left.back().t, all.back().t - SensorDuration{20'000}) << "to the end";
}

TEST_F(LampFlicker, IsStillKnownWhereARunGoesOn) {
    const auto of_half = [&](const std::vector<std::string>& more) {
        // Where the whole run has a frame: its first one lies 1 us before the first event.
        const SensorTime begin = events_of(temp_ / "lamp.aedat4").front().t - SensorDuration{1};
        std::vector<std::string> arguments{"--from", "@" + std::to_string(to_us(begin) + 600'000)};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_of(arguments).second;
    };
    run_of({"--states-out", "states", "--states-at", "400ms"});
    const std::string whole = run_of({}).second;
    const std::string rest = of_half({"--state-in", "states/state_000000.safetensors"});
    ASSERT_GT(rest.size(), 25U * 64 * 48 * 8);
    EXPECT_TRUE(whole.ends_with(rest));
    const Result other = eventide({"run", "lamp.aedat4", "--model", model(), "--out", "null",
                                   "--window", "30ms", "--frames", "ignore", "--lamp-flicker",
                                   "5ms", "--state-in", "states/state_000000.safetensors"});
    EXPECT_THAT(other.error, HasSubstr("--lamp-flicker 5ms, found that of one with 16ms"));
}

}  // namespace
}  // namespace eventide::test
