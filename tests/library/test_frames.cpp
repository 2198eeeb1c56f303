// The library's frames are those of `eventide run`, bit for bit, however it is asked.
#include "src/model/model_file.h"
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

TEST_F(Frames, OfATimeThatIsAskedForAreThoseOfTheFrameClock) {
    const std::vector<Event> events = events_of(recording());
    Reconstructor clocked = reconstructor(repeatable("7ms", 2));
    Reconstructor asked = reconstructor(repeatable("7ms", 2));
    for (Reconstructor* one : {&clocked, &asked}) {
        one->push(events);
        one->finish();
    }
    Frame expected, frame;
    for (std::uint64_t index = 0; clocked.next(expected); ++index) {
        EXPECT_EQ(expected.index, index);
        // The first frame of all stands at the begin of the first window, just outside.
        const SensorTime t = std::max(expected.t, expected.window.begin + SensorDuration{1});
        ASSERT_TRUE(asked.ready(t)) << index;
        asked.render(t, frame);
        EXPECT_EQ(frame.t, t);
        EXPECT_EQ(frame.window, expected.window);
        EXPECT_EQ(frame.intensity, expected.intensity) << index;
        EXPECT_EQ(frame.sigma, expected.sigma) << index;
    }
    EXPECT_EQ(asked.counters().frames, clocked.counters().frames);
}

TEST_F(Frames, OfTheFrameClockAreRightAndAllThereWhereRenderWentAhead) {
    const std::vector<Event> events = events_of(recording());
    ReconstructorOptions options = repeatable("7ms", 0);
    options.fps = "500";
    // A network that looks back two windows, so that forgetting one too early shows.
    Model network = load_model(model());
    network.config.live_edge = LiveEdge::fade;
    const std::string fading = temp_ / "fading.safetensors";
    save_model(fading, network);
    Reconstructor alone{fading, 64, 48, options};
    alone.push(events);
    std::vector<Frame> expected;
    for (Frame frame; alone.next(frame);) expected.push_back(frame);
    for (int ahead_ms = 1; ahead_ms < 60; ahead_ms += 7) {
        Reconstructor mixed{fading, 64, 48, options};
        mixed.push(events);
        Frame frame;
        std::size_t given = 0;
        for (; given < 20; ++given) ASSERT_TRUE(mixed.next(frame));
        const SensorTime ahead = frame.t + SensorDuration{1000 * ahead_ms};
        if (mixed.ready(ahead))
            mixed.render(ahead, frame);
        else
            EXPECT_GT(ahead_ms, 8) << "a window at least";
        for (; mixed.next(frame); ++given) {
            const Frame& right = expected.at(frame.index);
            ASSERT_EQ(frame.t, right.t);
            ASSERT_EQ(frame.intensity, right.intensity) << frame.index << ", ahead " << ahead_ms;
            ASSERT_EQ(frame.sigma, right.sigma) << frame.index << ", ahead " << ahead_ms;
        }
        EXPECT_EQ(given, expected.size());
    }
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

TEST_F(Frames, AreAllGivenByNextWhateverElseIsAsked) {
    const std::vector<Event> events = events_of(recording());
    for (const int lookahead : {0, 1, 2}) {
        std::string frames[2];
        for (const bool asks : {false, true}) {
            Reconstructor reconstructor = this->reconstructor(repeatable("7ms", lookahead));
            Frame frame, other;
            for (std::size_t at = 0; at < events.size(); at += 5'000) {
                const auto part = std::span{events}.subspan(at);
                reconstructor.push(part.first(std::min<std::size_t>(part.size(), 5'000)));
                // At first there is nothing that may not be passed over.
                if (asks && at > 0) {
                    if (const auto newest = reconstructor.newest())
                        reconstructor.render(*newest, other);
                    reconstructor.ready(events.back().t);
                }
                while (reconstructor.next(frame)) append_frame(frame, frames[asks]);
            }
        }
        EXPECT_TRUE(frames[0] == frames[1]) << lookahead;
        EXPECT_FALSE(frames[0].empty());
    }
}

TEST_F(Frames, OfAnySizeFromOneMemory) {
    Reconstructor reconstructor = this->reconstructor(repeatable("20ms", 0));
    reconstructor.push(events_of(recording()));
    const auto newest = reconstructor.newest();
    ASSERT_TRUE(newest);
    Frame whole, part;
    reconstructor.render(*newest, {96, 72}, whole);
    reconstructor.render(*newest, {96, 72, {10, 20, 30, 40}}, part);
    ASSERT_EQ(part.intensity.height(), 40);
    ASSERT_EQ(part.intensity.width(), 30);
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 30; ++x) {
            EXPECT_EQ(part.intensity(y, x), whole.intensity(y + 20, x + 10));
            EXPECT_EQ(part.sigma(y, x), whole.sigma(y + 20, x + 10));
        }
}

TEST_F(Frames, GoOnInSilenceAsFarAsTheClockIsKnown) {
    Reconstructor reconstructor = this->reconstructor(repeatable("20ms", 0));
    const Event one{from_us(1'000'000), 5, 5, Polarity::on};
    reconstructor.push({&one, 1});
    EXPECT_EQ(reconstructor.readiness(from_us(1'000'000)), Readiness::later);
    reconstructor.advance(from_us(1'020'000));
    EXPECT_EQ(reconstructor.readiness(from_us(1'000'000)), Readiness::ready);
    EXPECT_EQ(reconstructor.readiness(from_us(1'025'000)), Readiness::later);
    EXPECT_EQ(reconstructor.readiness(from_us(900'000)), Readiness::gone);
    reconstructor.advance(from_us(1'500'000));
    EXPECT_EQ(reconstructor.newest(), from_us(1'479'999 + 20'000));
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

TEST_F(Frames, CarryTheMarkOfLostDataHoweverLateTheyAreAskedFor) {
    Reconstructor reconstructor = this->reconstructor(repeatable("20ms", 0));
    const auto events = events_of(recording());
    const auto half = events.size() / 2;
    reconstructor.push(std::span{events}.first(half));
    reconstructor.mark_gap();
    reconstructor.push(std::span{events}.subspan(half));
    reconstructor.finish();
    int marked = 0;
    for (Frame frame; reconstructor.next(frame);) {
        const bool has_lost =
            frame.window.begin < events[half].t && events[half].t <= frame.window.end;
        EXPECT_EQ(frame.gap_before, has_lost) << to_us(frame.t);
        marked += frame.gap_before ? 1 : 0;
    }
    EXPECT_GT(marked, 0);
}

TEST_F(Frames, CarryTheMarkOfLostData) {
    Reconstructor reconstructor = this->reconstructor(repeatable("20ms", 0));
    const auto events = events_of(recording());
    const auto half = events.size() / 2;
    reconstructor.push(std::span{events}.first(half));
    Frame frame;
    while (reconstructor.next(frame)) EXPECT_FALSE(frame.gap_before);
    reconstructor.mark_gap();
    reconstructor.push(std::span{events}.subspan(half));
    ASSERT_TRUE(reconstructor.next(frame));
    EXPECT_TRUE(frame.gap_before);
    reconstructor.render(frame.t, frame);
    EXPECT_TRUE(frame.gap_before);
}

TEST_F(Frames, TellOfLostDataThoughTheirWindowsAreMany) {
    ReconstructorOptions options = repeatable("2ms", 0);
    options.fps = "50";  // ten event windows for each frame
    Reconstructor reconstructor = this->reconstructor(options);
    const auto events = events_of(recording());
    const auto half = events.size() / 2;
    Frame frame;
    int marked = 0;
    const auto count = [&] {
        while (reconstructor.next(frame)) marked += frame.gap_before ? 1 : 0;
    };
    reconstructor.push(std::span{events}.first(half));
    count();
    EXPECT_EQ(marked, 0);
    reconstructor.mark_gap();
    reconstructor.push(std::span{events}.subspan(half));
    reconstructor.finish();
    count();
    EXPECT_EQ(marked, 1);
}

TEST_F(Frames, TellOfNoLossBeforeAReset) {
    ReconstructorOptions options = repeatable("2ms", 0);
    options.fps = "1";
    Reconstructor reconstructor = this->reconstructor(options);
    const auto events = events_of(recording());
    const auto half = events.size() / 2;
    Frame frame;
    reconstructor.push(std::span{events}.first(half));
    ASSERT_TRUE(reconstructor.next(frame));
    reconstructor.mark_gap();
    reconstructor.push(std::span{events}.subspan(half));
    ASSERT_FALSE(reconstructor.next(frame)) << "no frame has told of the gap";
    reconstructor.reset();
    reconstructor.push(events);
    ASSERT_TRUE(reconstructor.next(frame));
    EXPECT_FALSE(frame.gap_before);
}

}  // namespace
}  // namespace eventide::test
