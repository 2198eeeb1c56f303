// What the network remembers of a scene can be kept in a file, also between library and program.
#include "tests/library/library_test.h"

namespace eventide::test {
namespace {

class SavedState : public LibraryTest {
protected:
    /// A recording as a whole through the library; its frames.
    std::string frames_with(Reconstructor& reconstructor) const {
        EventReader reader{recording()};
        for (Batch batch; reader.read(batch);) reconstructor.push(batch);
        reconstructor.finish(reader.clock());
        std::string frames;
        append_frames(reconstructor, frames);
        return frames;
    }
};

TEST_F(SavedState, IsThatOfTheProgramAndGoesOnThere) {
    auto arguments = repeatable_arguments("7ms", 1);
    arguments.insert(arguments.end(), {"--state-out", temp_ / "theirs"});
    frames_of_run(arguments);
    Reconstructor reconstructor = this->reconstructor(repeatable("7ms", 1));
    const std::string fresh = frames_with(reconstructor);
    reconstructor.save_state(temp_ / "ours");
    EXPECT_TRUE(read_text(temp_ / "ours") == read_text(temp_ / "theirs"));

    reconstructor.restore_state(temp_ / "theirs");
    const std::string again = frames_with(reconstructor);
    arguments = repeatable_arguments("7ms", 1);
    arguments.insert(arguments.end(), {"--state-in", temp_ / "ours"});
    EXPECT_TRUE(again == frames_of_run(arguments));
    EXPECT_FALSE(again == fresh) << "what was remembered shows";
}

TEST_F(SavedState, InMemoryIsThatOfTheFile) {
    Reconstructor reconstructor = this->reconstructor(repeatable("7ms", 1));
    const std::string fresh = frames_with(reconstructor);
    const std::vector<std::byte> state = reconstructor.state();
    reconstructor.save_state(temp_ / "file");
    EXPECT_EQ(std::string(reinterpret_cast<const char*>(state.data()), state.size()),
              read_text(temp_ / "file"));

    Reconstructor other = this->reconstructor(repeatable("7ms", 1));
    other.restore(state);
    const std::string again = frames_with(other);
    reconstructor.restore_state(temp_ / "file");
    EXPECT_TRUE(again == frames_with(reconstructor));
    EXPECT_FALSE(again == fresh) << "what was remembered shows";
}

TEST_F(SavedState, CutShortInMemoryIsRefusedAndNothingChanges) {
    Reconstructor reconstructor = this->reconstructor(repeatable("7ms", 1));
    frames_with(reconstructor);
    const std::vector<std::byte> state = reconstructor.state();
    for (const std::size_t size : {std::size_t{0}, std::size_t{100}, state.size() - 1})
        EXPECT_NE(
            error_of([&] { reconstructor.restore(std::span{state}.first(size)); }, ErrorKind::input)
                .find("state: "),
            std::string::npos);
    EXPECT_EQ(reconstructor.state(), state);
}

TEST_F(SavedState, OfAnotherSensorIsRefusedAndNothingChanges) {
    ReconstructorOptions options = repeatable("7ms", 0);
    Reconstructor other{model(), 32, 24, options};
    other.save_state(temp_ / "other");
    EXPECT_NE(error_of([&] { other.save_state(temp_ / "other"); }).find("other"),
              std::string::npos);
    other.save_state(temp_ / "other", true);
    Reconstructor reconstructor = this->reconstructor(options);
    const std::vector<Event> events = events_of(recording());
    reconstructor.push(events);
    const std::string words =
        error_of([&] { reconstructor.restore_state(temp_ / "other"); }, ErrorKind::input);
    EXPECT_NE(words.find("expected 48, found 24"), std::string::npos) << words;
    error_of([&] { reconstructor.restore_state(temp_ / "none"); }, ErrorKind::input);
    Reconstructor untouched = this->reconstructor(options);
    untouched.push(events);
    std::string frames, expected;
    append_frames(reconstructor, frames);
    append_frames(untouched, expected);
    EXPECT_TRUE(frames == expected);
}

}  // namespace
}  // namespace eventide::test
