// Recordings, cameras and writers for C.
#include "tests/library/c_interface.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string>
#include <vector>

namespace eventide::test {
namespace {

class CSources : public CInterface {};

TEST_F(CSources, ReadsTheFramesOfASourceOneByOne) {
    eventide_source* source = nullptr;
    ASSERT_EQ(eventide_recording_open(recording().c_str(), nullptr, 0, 0, &source), EVENTIDE_OK);
    const eventide_options options = repeatable_options();
    ASSERT_EQ(eventide_reconstructor_open_for(source, model().c_str(), &options, &reconstructor_),
              EVENTIDE_OK)
        << eventide_error_message();
    eventide_frame f;
    std::string frames;
    while (eventide_read_frame(source, reconstructor_, &f) == EVENTIDE_OK) {
        const auto bytes = std::size_t(f.width) * std::size_t(f.height) * sizeof(float);
        frames.append(reinterpret_cast<const char*>(f.intensity), bytes);
        frames.append(reinterpret_cast<const char*>(f.sigma), bytes);
    }
    EXPECT_EQ(eventide_read_frame(source, reconstructor_, &f), EVENTIDE_NONE) << "for good";
    EXPECT_TRUE(frames == frames_of_run(repeatable_arguments("7ms", 1)));
    EXPECT_EQ(eventide_read_frame(nullptr, reconstructor_, &f), EVENTIDE_USAGE);
    EXPECT_TRUE(said("expected a source, found NULL"));
    EXPECT_EQ(eventide_read_frame(source, nullptr, &f), EVENTIDE_USAGE);
    eventide_reconstructor* none = nullptr;
    EXPECT_EQ(eventide_reconstructor_open_for(nullptr, model().c_str(), &options, &none),
              EVENTIDE_USAGE);
    EXPECT_TRUE(said("expected a source, found NULL"));
    EXPECT_EQ(eventide_reconstructor_open_for(source, model().c_str(), &options, nullptr),
              EVENTIDE_USAGE);
    EXPECT_TRUE(said("expected a place for the reconstructor, found NULL"));
    eventide_source_close(source);
}

/// So that a program may close all it has at its end, whatever was opened.
TEST_F(CSources, WhatIsNotOpenedIsNull) {
    open();
    eventide_source* source = nullptr;
    ASSERT_EQ(eventide_recording_open(recording().c_str(), nullptr, 0, 0, &source), EVENTIDE_OK);
    const auto expect_null = [](const char* what, const auto& opens, auto* handle) {
        EXPECT_NE(opens(&handle), EVENTIDE_OK) << what;
        EXPECT_EQ(handle, nullptr) << what;
    };
    const eventide_recording_options none{};  // of no size
    const eventide_callbacks no_callbacks{};
    expect_null(
        "no path", [](auto* to) { return eventide_recording_open(nullptr, nullptr, 0, 0, to); },
        source);
    expect_null(
        "options",
        [&](auto* to) {
            return eventide_recording_open_with(recording().c_str(), &none, nullptr, to);
        },
        source);
    expect_null(
        "callbacks",
        [&](auto* to) {
            return eventide_camera_open_with("sim:demo", nullptr, 0, &no_callbacks, to);
        },
        source);
    expect_null(
        "no camera", [](auto* to) { return eventide_camera_open(nullptr, nullptr, 0, to); },
        source);
    expect_null(
        "no source",
        [](auto* to) { return eventide_reconstructor_open_for(nullptr, "small", nullptr, to); },
        reconstructor_);
    expect_null(
        "no model",
        [](auto* to) { return eventide_reconstructor_open(nullptr, 64, 48, nullptr, to); },
        reconstructor_);
    eventide_source_close(source);
}

TEST_F(CSources, CamerasPushWhatTheyRead) {
    open();
    eventide_source* source = nullptr;
    ASSERT_EQ(
        eventide_camera_open("sim:demo?seconds=0.2&size=64x48&speed=max", nullptr, 0, &source),
        EVENTIDE_OK);
    EXPECT_EQ(eventide_seek(source, 0), EVENTIDE_USAGE);
    int frames = 0;
    eventide_frame frame;
    while (eventide_read_into(source, reconstructor_) == EVENTIDE_OK)
        while (eventide_next(reconstructor_, &frame) == EVENTIDE_OK) ++frames;
    EXPECT_GT(frames, 15);
    eventide_source_close(source);
}

TEST_F(CSources, ACameraThatIsWaitedForCanBeGivenUp) {
    int asked = 0;
    const auto third_time = [](void* context) {
        return ++*static_cast<int*>(context) == 3 ? 1 : 0;
    };
    const eventide_callbacks callbacks{sizeof callbacks, &asked, third_time, nullptr};
    eventide_source* source = nullptr;
    const eventide_status status = eventide_camera_open_with("ros2:/eventide/nobody/publishes",
                                                             nullptr, 1, &callbacks, &source);
    EXPECT_EQ(source, nullptr);
    if (said("built without")) GTEST_SKIP() << eventide_error_message();
    EXPECT_EQ(status, EVENTIDE_FAILED);
    EXPECT_TRUE(said("ros2:/eventide/nobody/publishes: given up")) << eventide_error_message();
    EXPECT_EQ(asked, 3);
}

TEST_F(CSources, WarnsOfWhatHadToBeGuessed) {
    write_text(temp_ / "log.txt", "0.01 3 4 1\n0.02 5 6 0\n0.03 7 8 1\n");
    std::vector<std::string> warnings;
    const auto keep = [](void* context, const char* text) {
        static_cast<std::vector<std::string>*>(context)->emplace_back(text);
    };
    eventide_callbacks callbacks{sizeof callbacks, &warnings, nullptr, keep};
    const auto open_log = [&](int width, int height) {
        eventide_source* source = nullptr;
        const eventide_recording_options options{sizeof options, nullptr, width, height, nullptr};
        const eventide_status status = eventide_recording_open_with((temp_ / "log.txt").c_str(),
                                                                    &options, &callbacks, &source);
        eventide_source_close(source);
        return status;
    };
    ASSERT_EQ(open_log(0, 0), EVENTIDE_OK) << eventide_error_message();
    ASSERT_FALSE(warnings.empty());
    EXPECT_TRUE(warnings[0].starts_with(temp_ / "log.txt: the recording does not say the sensor's"))
        << warnings[0];
    callbacks.warn = nullptr;
    warnings.clear();
    EXPECT_EQ(open_log(0, 0), EVENTIDE_OK) << "nobody to tell";
    callbacks.struct_size = sizeof callbacks + 1;
    EXPECT_EQ(open_log(64, 48), EVENTIDE_USAGE);
    EXPECT_TRUE(said("callbacks: expected a struct_size of 8 to 32, a multiple of 8, found 33"))
        << eventide_error_message();
    EXPECT_EQ(warnings.size(), 0U);
}

TEST_F(CSources, APipeThatSaysNothingCanBeGivenUp) {
    const std::string pipe = temp_ / "pipe";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    const int writer = ::open(pipe.c_str(), O_RDWR | O_CLOEXEC);
    const auto at_once = [](void*) { return 1; };
    const eventide_callbacks callbacks{sizeof callbacks, nullptr, at_once, nullptr};
    eventide_source* source = nullptr;
    EXPECT_EQ(eventide_recording_open_with(pipe.c_str(), nullptr, &callbacks, &source),
              EVENTIDE_FAILED);
    EXPECT_TRUE(said("pipe: given up while it was waited for")) << eventide_error_message();
    EXPECT_EQ(source, nullptr);
    ::close(writer);
}

TEST_F(CSources, APipeThatNobodyReadsCanBeGivenUp) {
    const std::string pipe = temp_ / "pipe";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    int asked = 0;
    const auto third_time = [](void* context) {
        return ++*static_cast<int*>(context) == 3 ? 1 : 0;
    };
    eventide_callbacks callbacks{sizeof callbacks, &asked, third_time, nullptr};
    eventide_writer* writer = nullptr;
    EXPECT_EQ(eventide_writer_open_with(pipe.c_str(), "aedat4", 64, 48, 0, &callbacks, &writer),
              EVENTIDE_FAILED);
    EXPECT_TRUE(said("pipe: given up while it was waited for")) << eventide_error_message();
    EXPECT_EQ(writer, nullptr);
    EXPECT_EQ(asked, 3);
    callbacks.struct_size = sizeof callbacks + 1;
    EXPECT_EQ(eventide_writer_open_with(pipe.c_str(), "aedat4", 64, 48, 0, &callbacks, &writer),
              EVENTIDE_USAGE);
}

TEST_F(CSources, OfARecordingOfSeveralCamerasOneIsChosen) {
    eventide_source* source = nullptr;
    eventide_recording_options options{sizeof options, nullptr, 0, 0, "0"};
    ASSERT_EQ(eventide_recording_open_with(recording().c_str(), &options, nullptr, &source),
              EVENTIDE_OK)
        << eventide_error_message();
    eventide_source_close(source);
    options.stream = "7";
    EXPECT_EQ(eventide_recording_open_with(recording().c_str(), &options, nullptr, &source),
              EVENTIDE_USAGE);
    EXPECT_TRUE(said("expected an event stream 7, found 0 (")) << eventide_error_message();
    options.struct_size = sizeof options + 1;
    EXPECT_EQ(eventide_recording_open_with(recording().c_str(), &options, nullptr, &source),
              EVENTIDE_USAGE);
    EXPECT_TRUE(
        said("recording options: expected a struct_size of 8 to 32, a multiple of 8, found 33"))
        << eventide_error_message();
}

TEST_F(CSources, ACameraIsNoRecording) {
    eventide_source* source = nullptr;
    EXPECT_EQ(eventide_recording_open("davis:", nullptr, 0, 0, &source), EVENTIDE_USAGE);
    EXPECT_TRUE(said("'davis:': expected a recording, found the name of a camera"))
        << eventide_error_message();
    EXPECT_TRUE(said("eventide_camera_open()")) << eventide_error_message();
}

TEST_F(CSources, PutsFiltersBehindASource) {
    for (const bool is_camera : {false, true}) {
        eventide_source* source = nullptr;
        ASSERT_EQ(is_camera ? eventide_camera_open("sim:demo?seconds=0.1&size=64x48&speed=max",
                                                   nullptr, 0, &source)
                            : eventide_recording_open(recording().c_str(), nullptr, 0, 0, &source),
                  EVENTIDE_OK);
        EXPECT_EQ(eventide_source_add_filter(source, "transpose"), EVENTIDE_OK);
        EXPECT_EQ(eventide_source_width(source), 48);
        EXPECT_EQ(eventide_source_height(source), 64);
        EXPECT_EQ(eventide_source_add_filter(source, "blur"), EVENTIDE_USAGE);
        EXPECT_TRUE(said("found 'blur'")) << eventide_error_message();
        EXPECT_EQ(eventide_source_add_filter(source, nullptr), EVENTIDE_USAGE);
        eventide_source_close(source);
    }
    EXPECT_EQ(eventide_source_add_filter(nullptr, "flip:x"), EVENTIDE_USAGE);
}

TEST_F(CSources, WritesWhatItReadsAgain) {
    eventide_writer* writer = nullptr;
    const std::string file = temp_ / "three.aedat4";
    ASSERT_EQ(eventide_writer_open(file.c_str(), nullptr, 64, 48, 0, &writer), EVENTIDE_OK);
    const eventide_event events[]{{1000, 3, 4, 1}, {1001, 5, 6, 0}, {2000, 63, 47, 9}};
    EXPECT_EQ(eventide_write(writer, events, 3), EVENTIDE_OK) << eventide_error_message();
    EXPECT_EQ(eventide_writer_finish(writer), EVENTIDE_OK);
    eventide_writer_close(writer);
    const std::vector<Event> expected{{from_us(1000), 3, 4, Polarity::on},
                                      {from_us(1001), 5, 6, Polarity::off},
                                      {from_us(2000), 63, 47, Polarity::on}};
    EXPECT_EQ(events_of(file), expected);
    EXPECT_EQ(eventide_writer_open(file.c_str(), nullptr, 64, 48, 0, &writer), EVENTIDE_USAGE);
    ASSERT_EQ(eventide_writer_open(file.c_str(), nullptr, 64, 48, 1, &writer), EVENTIDE_OK);
    EXPECT_EQ(eventide_write(writer, events, 1), EVENTIDE_OK);
    EXPECT_EQ(eventide_writer_finish(writer), EVENTIDE_OK);
    eventide_writer_close(writer);
    EXPECT_EQ(events_of(file).size(), 1U) << "replaced";
}

}  // namespace
}  // namespace eventide::test
