// Of a bag's topics with events and images, those that are read.
#include "replay/formats.h"
#include "src/core/error.h"
#include "tests/replay/recording_files.h"
#include "tests/replay/some_bags.h"

#include <gmock/gmock.h>

namespace eventide {
namespace {

using namespace test;
using testing::AllOf;
using testing::HasSubstr;

TEST(BagTopics, ImagesOfAnotherCameraAreLeftOutAndNamed) {
    const TestFolder folder;
    const auto events = some_events(5'000);
    const auto recording =
        open_recording(folder.write("a.bag", bag_of(events, "none", "dvs_msgs/EventArray", 200)));
    ASSERT_EQ(recording->remarks().size(), 1U);
    EXPECT_THAT(recording->remarks()[0], AllOf(HasSubstr("200x128"), HasSubstr("left out")));
    const Batch batch = read_everything(*recording);
    EXPECT_TRUE(batch.events == events);
    EXPECT_TRUE(batch.images.empty());
}

TEST(BagTopics, OfSeveralTopicsWithImagesTheFirstOfTheEventsSizeIsReadAndTheOthersNamed) {
    const TestFolder folder;
    const auto events = some_events(100);
    const auto at = [&](std::uint32_t number, int width) {
        return message(number, image(some_image(events[50].t, width, 128)));
    };
    const std::string type = "sensor_msgs/Image";
    const auto recording = open_recording(folder.write(
        "a.bag",
        bag(chunk("none", connection(kEvents, "dvs_msgs/EventArray", "/events") +
                              connection(10, type, "/wide") + connection(11, type, "/same") +
                              connection(12, type, "/also") + at(10, 200) + at(11, 128) +
                              at(12, 128) + message(kEvents, event_array(128, 128, events))))));
    EXPECT_EQ(read_everything(*recording).images.size(), 1U);
    EXPECT_THAT(recording->remarks(),
                testing::ElementsAre(AllOf(HasSubstr("/wide"), HasSubstr("200x128")),
                                     AllOf(HasSubstr("/also"), HasSubstr("those of /same"))));
}

/// A recorder may name a camera from which nothing came, or whose messages make no sense.
TEST(BagTopics, OfSeveralTopicsWithEventsTheFirstThatHasSomeIsRead) {
    const TestFolder folder;
    const auto events = some_events(100);
    const std::string type = "dvs_msgs/EventArray";
    const BagBytes other = message(10, event_array(0, 0, {}));
    for (const BagBytes& left : {BagBytes(), other}) {
        const auto recording = open_recording(folder.write(
            "a.bag", bag(chunk("none", connection(10, type, "/left") + left +
                                           connection(11, type, "/right") +
                                           message(11, event_array(128, 128, events))))));
        EXPECT_TRUE(read_everything(*recording).events == events);
        EXPECT_THAT(recording->remarks(),
                    testing::ElementsAre(AllOf(HasSubstr("/left has no events"),
                                               HasSubstr("those of /right are read"))));
    }
}

/// Of a stereo pair, with the images of both.
TEST(BagTopics, OfAPairTheEventsOfTheTopicThatIsWantedAreReadAndTheImagesBesideThem) {
    const TestFolder folder;
    const auto left = some_events(100), right = some_events(100, 5'000);
    const std::string events = "dvs_msgs/EventArray", images = "sensor_msgs/Image";
    const auto image_at = [&](std::uint32_t number, SensorTime t) {
        return message(number, image(some_image(t, 128, 128)));
    };
    const std::string path = folder.write(
        "a.bag", bag(chunk("none", connection(12, images, "/stereo/left/image_raw") +
                                       connection(13, images, "/stereo/right/image_raw") +
                                       connection(10, events, "/stereo/left/events") +
                                       connection(11, events, "/stereo/right/events") +
                                       message(10, event_array(128, 128, left)) +
                                       message(11, event_array(128, 128, right)) +
                                       image_at(12, left[5].t) + image_at(13, right[5].t))));
    const auto read = [&](const std::string& stream) {
        OpenOptions options;
        options.stream = stream;
        const auto recording = open_recording(path, options);
        return std::pair{read_everything(*recording), recording->remarks()};
    };
    for (const char* first : {"", "/stereo/left/events"}) {
        const auto [batch, remarks] = read(first);
        EXPECT_TRUE(batch.events == left);
        ASSERT_EQ(batch.images.size(), 1U);
        EXPECT_EQ(batch.images[0].t, left[5].t);
        EXPECT_THAT(remarks,
                    testing::UnorderedElementsAre(
                        "the images of /stereo/right/image_raw are left out, those of "
                        "/stereo/left/image_raw are read",
                        "the events of /stereo/right/events are left out, those of "
                        "/stereo/left/events are read; --input-stream /stereo/right/events (the "
                        "option stream of the library) reads those"));
    }
    const auto [batch, remarks] = read("/stereo/right/events");
    EXPECT_TRUE(batch.events == right);
    ASSERT_EQ(batch.images.size(), 1U);
    EXPECT_EQ(batch.images[0].t, right[5].t);
    for (const char* none : {"/stereo/left/image_raw", "/stereo/right", "events"}) {
        try {
            read(none);
            FAIL() << none;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            EXPECT_THAT(error.what(),
                        HasSubstr("expected events of the topic '" + std::string(none) +
                                  "' that can be read, found events of /stereo/left/events, "
                                  "/stereo/right/events"));
        }
    }
}

TEST(BagTopics, ImagesOfTheOtherCameraOfAPairAreNotTakenForTheFirstOnes) {
    const TestFolder folder;
    const auto events = some_events(100);
    const std::string type = "dvs_msgs/EventArray";
    const auto recording = open_recording(folder.write(
        "a.bag", bag(chunk("none", connection(10, type, "/left/events") +
                                       connection(11, type, "/right/events") +
                                       connection(12, "sensor_msgs/Image", "/right/image_raw") +
                                       message(10, event_array(128, 128, events)) +
                                       message(11, event_array(128, 128, events)) +
                                       message(12, image(some_image(events[0].t, 128, 128)))))));
    EXPECT_TRUE(read_everything(*recording).images.empty());
    EXPECT_THAT(recording->remarks(),
                testing::Contains(
                    "the images of /right/image_raw are left out: they are of another camera"));
}

TEST(BagTopics, WithoutEventsAreRefusedWithWhatItHas) {
    const TestFolder folder;
    const std::string path = folder.write(
        "a.bag", bag(chunk("none", connection(kOther, "sensor_msgs/Imu") + message(kOther, "x"))));
    try {
        open_recording(path);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_THAT(error.what(), AllOf(HasSubstr("a.bag"), HasSubstr("found sensor_msgs/Imu")));
    }
}

}  // namespace
}  // namespace eventide
