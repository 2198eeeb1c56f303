// A camera in software through the library.
#include "tests/library/library_test.h"

#include <filesystem>
#include <string>

namespace eventide::test {
namespace {

class Cameras : public LibraryTest {};

TEST_F(Cameras, GiveEventsAndAClockThatFramesFollow) {
    EventCamera camera{"sim:demo?seconds=0.3&size=64x48&speed=max"};
    EXPECT_EQ(camera.width(), 64);
    EXPECT_EQ(camera.height(), 48);
    EXPECT_EQ(camera.clock(), std::nullopt);
    Reconstructor reconstructor = this->reconstructor(repeatable("20ms", 0));
    Frame frame;
    SensorTime newest{};
    int frames = 0;
    for (Batch batch; camera.read(batch);) {
        if (camera.gap_before()) reconstructor.mark_gap();
        reconstructor.push(batch);
        if (const auto clock = camera.clock()) {
            reconstructor.advance(*clock);
            newest = *clock;
        }
        for (; reconstructor.next(frame); ++frames) EXPECT_LE(frame.t, newest);
    }
    EXPECT_GE(frames, 26);
    EXPECT_EQ(camera.damaged(), 0U);
    EXPECT_EQ(reconstructor.counters().late, 0U) << "the clock keeps its promise";
}

TEST_F(Cameras, EndWhenTheyAreToldTo) {
    EventCamera camera{"sim:demo?size=64x48&speed=1"};
    Batch batch;
    EXPECT_TRUE(camera.read(batch));
    camera.stop();
    while (camera.read(batch)) {
    }
}

TEST_F(Cameras, ThatCannotBeOpenedSayWhy) {
    EXPECT_NE(error_of([] { EventCamera{"kodak:"}; }).find("kodak"), std::string::npos);
    EXPECT_NE(error_of([] { EventCamera{"v4l2:/dev/none"}; }, ErrorKind::device).find("/dev/none"),
              std::string::npos);
    EXPECT_NE(error_of([] {
                  EventCamera{"sim:demo?size=64x48", {.file = "davis.json"}};
              }).find("'davis.json': expected a camera that has settings, found sim:demo"),
              std::string::npos);
}

TEST_F(Cameras, RecordingsAreNone) {
    EXPECT_NE(error_of([] { EventCamera{recording()}; })
                  .find("recording.aedat4': expected the name of a camera, found a file, which "
                        "EventReader opens"),
              std::string::npos);
}

TEST_F(Cameras, AreNoRecordings) {
    for (const std::string name : {"davis:", "v4l2:/dev/video0", "sim:demo"}) {
        const std::string words = error_of([&] { EventReader{name}; });
        EXPECT_NE(words.find("'" + name +
                             "': expected a recording, found the name of a camera, "
                             "which EventCamera opens"),
                  std::string::npos)
            << words;
    }
    std::filesystem::copy(recording(), temp_ / "sim:file");
    const std::filesystem::path before = std::filesystem::current_path();
    std::filesystem::current_path(temp_.path());
    EXPECT_EQ(EventReader{"sim:file"}.width(), 64) << "a file that is there is what is meant";
    std::filesystem::current_path(before);
}

}  // namespace
}  // namespace eventide::test
