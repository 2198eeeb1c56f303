// Topics that wait for their subscribers, and frames that are made only for them.
#include "tests/ros2/sink_test.h"

#include <gtest/gtest.h>

#include <optional>
#include <thread>
#include <utility>

namespace eventide::test {
namespace {

TEST_F(Ros2SinkTest, LazyIsWatchedWhileSomebodySubscribes) {
    const auto eager = open();
    EXPECT_TRUE(eager->is_watched());
    const auto lazy = open("_lazy?lazy=yes");
    EXPECT_FALSE(lazy->is_watched());
    lazy->write(frame(0));  // of no harm
    {
        TopicReader info{kCameraInfoType, name_ + "_lazy/camera_info"};
        ASSERT_TRUE(info.wait_for_writers(1));
        while (!lazy->is_watched()) std::this_thread::yield();
        lazy->write(frame(1));
        EXPECT_NE(info.next<Info>(), nullptr);
    }
    while (lazy->is_watched()) std::this_thread::yield();
}

TEST_F(Ros2SinkTest, LazyIsWatchedWhileSomebodySubscribesToAnyOfItsImages) {
    const auto lazy = open("?lazy=yes&compressed=png");
    for (const auto& [type, topic] : {std::pair{&kImageType, "/image_raw"},
                                      {&kImageType, "/uncertainty"},
                                      {&kCompressedImageType, "/image_raw/compressed"}}) {
        EXPECT_FALSE(lazy->is_watched()) << topic;
        {
            TopicReader reader{*type, name_ + topic};
            ASSERT_TRUE(reader.wait_for_writers(1)) << topic;
            while (!lazy->is_watched()) std::this_thread::yield();
        }
        while (lazy->is_watched()) std::this_thread::yield();
    }
}

TEST_F(Ros2SinkTest, LazyThatWaitsForSubscribersIsGivenItsFirstFrameToWaitWith) {
    EXPECT_TRUE(open("?lazy=yes&subscribers=1")->is_watched());
}

TEST_F(Ros2SinkTest, WhoReadsDiagnosticsMakesNoFrames) {
    TopicReader diagnostics{kDiagnosticArrayType, "/diagnostics"};
    const auto sink = open("?lazy=yes");
    ASSERT_TRUE(diagnostics.wait_for_writers(1));
    EXPECT_FALSE(sink->is_watched());
}

TEST_F(Ros2SinkTest, WaitsForItsSubscribers) {
    std::optional<TopicReader> image;
    Ros2SinkSettings settings;
    settings.name = parse_ros2_sink_name(name_ + "?subscribers=1");
    settings.give_up = [&] {  // asked while it waits
        if (!image) image.emplace(kImageType, name_ + "/image_raw");
        return false;
    };
    const auto sink = open_ros2_sink(std::move(settings));
    sink->write(frame(0));
    ASSERT_TRUE(image) << "it did not wait";
    const Image* shown = image->next<Image>();
    ASSERT_NE(shown, nullptr);
    EXPECT_EQ(stamp_us(shown->header), to_us(frame(0).t)) << "the very first";
}

TEST_F(Ros2SinkTest, GivesUpWaitingForSubscribersWhenItIsTold) {
    Ros2SinkSettings settings;
    settings.name = parse_ros2_sink_name(name_ + "?subscribers=1");
    settings.give_up = [] { return true; };
    open_ros2_sink(std::move(settings))->write(frame(0));
}

}  // namespace
}  // namespace eventide::test
