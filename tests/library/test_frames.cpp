// The library's frames are those of `eventide run`, bit for bit, however it is asked.
#include "tests/library/library_test.h"

#include <algorithm>
#include <tuple>

namespace eventide::test {
namespace {

class FramesOfTheLibrary : public LibraryTest,
                           public testing::WithParamInterface<std::tuple<std::string, int>> {};

TEST_P(FramesOfTheLibrary, AreThoseOfEventideRun) {
    const auto& [window, lookahead] = GetParam();
    EventReader reader{recording()};
    Reconstructor reconstructor{model(), reader.width(), reader.height(),
                                repeatable(window, lookahead)};
    std::string frames;
    for (Batch batch; reader.read(batch);) {
        reconstructor.push(batch);
        append_frames(reconstructor, frames);
    }
    reconstructor.finish(reader.clock());
    append_frames(reconstructor, frames);
    const std::string expected = frames_of_run(repeatable_arguments(window, lookahead));
    ASSERT_GT(expected.size(), 30U * 64 * 48 * 8);
    EXPECT_TRUE(frames == expected) << frames.size() << " bytes for " << expected.size();
}

INSTANTIATE_TEST_SUITE_P(Windows, FramesOfTheLibrary,
                         testing::Combine(testing::Values("model", "auto", "7ms", "900ev",
                                                          "0.2epp,15ms", "aps"),
                                          testing::Values(0, 1, 2)),
                         [](const auto& test) {
                             std::string name = std::get<0>(test.param) + "_lookahead" +
                                                std::to_string(std::get<1>(test.param));
                             std::ranges::replace_if(
                                 name, [](char c) { return c == '.' || c == ','; }, '_');
                             return name;
                         });

class Frames : public LibraryTest {
protected:
    /// All of the recording, frames asked for after every `per_take` batches.
    std::string frames_of(Reconstructor& reconstructor, std::size_t per_take) const {
        EventReader reader{recording()};
        std::string frames;
        std::size_t batches = 0;
        for (Batch batch; reader.read(batch);) {
            reconstructor.push(batch);
            if (++batches % per_take == 0) append_frames(reconstructor, frames);
        }
        reconstructor.finish(reader.clock());
        append_frames(reconstructor, frames);
        return frames;
    }
};

TEST_F(Frames, AreCorrectedByImagesUnlessTheyMayNotBe) {
    ReconstructorOptions options = repeatable("7ms", 1);
    Reconstructor with = reconstructor(options);
    const std::string corrected = frames_of(with, 1);
    EXPECT_GT(with.counters().used_images, 5U);
    options.images = false;
    Reconstructor without = reconstructor(options);
    const std::string alone = frames_of(without, 1);
    EXPECT_EQ(without.counters().used_images, 0U);
    EXPECT_TRUE(alone == frames_of_run(repeatable_arguments("7ms", 1, false)));
    EXPECT_FALSE(alone == corrected);
}

TEST_F(Frames, AreTheSameHoweverLateTheyAreAskedFor) {
    for (const char* window : {"7ms", "auto"}) {
        Reconstructor at_once = reconstructor(repeatable(window, 1));
        const std::string expected = frames_of(at_once, 1);
        for (const std::size_t per_take : {3, 1000}) {
            Reconstructor later = reconstructor(repeatable(window, 1));
            EXPECT_TRUE(frames_of(later, per_take) == expected) << window << ", " << per_take;
            EXPECT_EQ(later.counters().used_images, at_once.counters().used_images);
        }
    }
}

TEST_F(Frames, AfterAResetAreThoseOfAFreshReconstructor) {
    Reconstructor reconstructor = this->reconstructor(repeatable("7ms", 1));
    const std::string fresh = frames_of(reconstructor, 1);
    reconstructor.reset();
    EXPECT_TRUE(frames_of(reconstructor, 1) == fresh);
}

TEST_F(Frames, AfterAResetKnowNoImageOfBefore) {
    const auto events = events_of(recording());
    Reconstructor used = reconstructor(repeatable("7ms", 0));
    Reconstructor fresh = reconstructor(repeatable("7ms", 0));
    Batch image;
    image.images.emplace_back().t = events[events.size() / 2].t;  // which has not come yet
    image.images.back().pixels = Array2<std::uint16_t>(48, 64);
    used.push(std::span{events}.first(events.size() / 4));
    used.push(image);
    used.reset();
    std::string after, expected;
    for (auto [reconstructor, frames] : {std::pair{&used, &after}, {&fresh, &expected}}) {
        reconstructor->push(events);
        reconstructor->finish();
        append_frames(*reconstructor, *frames);
    }
    EXPECT_TRUE(after == expected);
    EXPECT_EQ(used.counters().used_images, 0U);
}

TEST_F(Frames, HaveNoSigmaWhereNoneIsWanted) {
    ReconstructorOptions options = repeatable("7ms", 0);
    Reconstructor with = reconstructor(options);
    options.sigma = false;
    Reconstructor without = reconstructor(options);
    const auto events = events_of(recording());
    for (Reconstructor* one : {&with, &without}) {
        one->push(events);
        one->finish();
    }
    Frame both, intensity;
    int frames = 0;
    for (; with.next(both) && without.next(intensity); ++frames) {
        EXPECT_EQ(both.intensity, intensity.intensity);
        EXPECT_FALSE(both.sigma.empty());
        EXPECT_TRUE(intensity.sigma.empty());
    }
    EXPECT_GT(frames, 5);
    EXPECT_FALSE(without.next(intensity));
    EXPECT_GT(without.counters().event_windows, 5U);
    EXPECT_EQ(without.counters().event_windows, with.counters().event_windows);
}

TEST_F(Frames, OfOtherSizesAreCorrectedToo) {
    EventReader reader{recording()};
    Reconstructor reconstructor = this->reconstructor(repeatable("7ms", 0));
    for (Batch batch; reader.read(batch);) reconstructor.push(batch);
    reconstructor.finish(reader.clock());
    const SensorTime t = *reconstructor.newest();
    ASSERT_GT(reconstructor.counters().used_images, 5U);
    Frame native, part;
    reconstructor.render(t, native);
    reconstructor.render(t, {.width = 0, .height = 0, .region = {10, 20, 30, 15}}, part);
    for (int y = 0; y < 15; ++y)
        for (int x = 0; x < 30; ++x) {
            ASSERT_EQ(part.intensity(y, x), native.intensity(20 + y, 10 + x));
            ASSERT_EQ(part.sigma(y, x), native.sigma(20 + y, 10 + x));
        }
}

TEST_F(Frames, OfImagesThatMakeNoSenseAreNone) {
    Reconstructor reconstructor = this->reconstructor(repeatable("7ms", 0));
    Batch batch;
    batch.images.emplace_back().channels = 2;
    EXPECT_NE(error_of([&] { reconstructor.push(batch); }).find("expected 1, 3 or 4 channels"),
              std::string::npos);
}

TEST_F(Frames, AreTheSameHoweverTheEventsAreSplit) {
    const std::vector<Event> events = events_of(recording());
    const auto frames_with = [&](std::size_t per_call) {
        Reconstructor reconstructor = this->reconstructor(repeatable("auto", 1));
        std::string frames;
        for (std::size_t i = 0; i < events.size(); i += per_call) {
            reconstructor.push(std::span{events}.subspan(i, std::min(per_call, events.size() - i)));
            append_frames(reconstructor, frames);
        }
        reconstructor.finish();
        append_frames(reconstructor, frames);
        return frames;
    };
    const std::string at_once = frames_with(events.size());
    EXPECT_GT(at_once.size(), 30U * 64 * 48 * 8);
    EXPECT_TRUE(frames_with(1001) == at_once);
    EXPECT_TRUE(frames_with(17) == at_once);
}

TEST_F(Frames, HaveTheSizeAndTheRegionThatWereAskedFor) {
    ReconstructorOptions options = repeatable("7ms", 0);
    options.size = {160, 120, {16, 8, 100, 90}};
    Reconstructor reconstructor = this->reconstructor(options);
    const std::string frames = frames_of(reconstructor, 1);
    auto arguments = repeatable_arguments("7ms", 0);
    arguments.insert(arguments.end(), {"--size", "160x120", "--roi", "16,8,100x90"});
    EXPECT_TRUE(frames == frames_of_run(arguments));
}

TEST_F(Frames, AreReadFromASourceOneByOne) {
    EventReader reader{recording()};
    Reconstructor reconstructor = this->reconstructor(repeatable("7ms", 1));
    Frame frame;
    std::string frames;
    while (read_frame(reader, reconstructor, frame)) append_frame(frame, frames);
    EXPECT_FALSE(read_frame(reader, reconstructor, frame)) << "for good";
    EXPECT_TRUE(frames == frames_of_run(repeatable_arguments("7ms", 1)));
}

TEST_F(Frames, MayBeMovedAwayAndAskedForAgain) {
    const auto frames_of = [this](bool are_moved) {
        Reconstructor reconstructor = this->reconstructor(repeatable("20ms", 0));
        reconstructor.push(events_of(recording()));
        reconstructor.finish();
        std::vector<Frame> frames;
        for (Frame frame; reconstructor.next(frame);)
            if (are_moved)
                frames.push_back(std::move(frame));
            else
                frames.push_back(frame);
        std::string all;
        for (const Frame& frame : frames) append_frame(frame, all);
        return all;
    };
    const std::string expected = frames_of(false);
    EXPECT_GT(expected.size(), 0U);
    EXPECT_TRUE(frames_of(true) == expected);
}

}  // namespace
}  // namespace eventide::test
