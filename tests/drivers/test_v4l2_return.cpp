// An event sensor in software behind V4L2 that loses buffers, is silent, stops and comes back.
#include "tests/drivers/v4l2_sensor.h"
#include "tests/support/holdings.h"
#include "tests/support/keep_in.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <fstream>
#include <string>
#include <vector>

namespace eventide {
namespace {

using testing::HasSubstr;
using namespace testing_support::v4l2;
using testing_support::V4l2NodeSettings;
using testing_support::V4l2Testbed;

TEST(V4l2Camera, LostBuffersMarkAGap) {
    V4l2Testbed bed{sensor()};
    auto camera = open();
    bed.give({bytes_of({time_high(0)})});
    bed.give({bytes_of({time_low(1)}), 3});
    bed.give({bytes_of({time_low(2)}), 0, true});
    bed.give({bytes_of({time_low(3)})});
    std::vector<bool> gaps;
    for (RawPacket packet; gaps.size() < 4;)
        if (camera.read(packet) == ReadStatus::data) gaps.push_back(packet.gap_before);
    EXPECT_EQ(gaps, (std::vector<bool>{false, true, false,
                                       true}));  // after the loss, after the damaged buffer
    EXPECT_EQ(camera.counters()[CameraCount::lost_transfers], 3U);
    EXPECT_EQ(camera.counters()[CameraCount::damaged_transfers], 1U);
    EXPECT_EQ(camera.counters()[CameraCount::transfers], 4U);
}

TEST(V4l2Camera, ADriverThatCountsAnewIsAGapButNoLoss) {
    V4l2Testbed bed{sensor()};
    auto camera = open({}, true);
    RawPacket packet;
    const auto next = [&](std::uint32_t skipped) {
        bed.give({bytes_of({time_high(0)}), skipped});
        while (camera.read(packet) != ReadStatus::data) continue;
        return packet.gap_before;
    };
    EXPECT_FALSE(next(7)) << "it need not begin with 0";
    EXPECT_TRUE(next(UINT32_MAX - 3)) << "3 less";
    EXPECT_FALSE(next(0));
    bed.fail_next("DQBUF", EIO);
    EXPECT_TRUE(next(7)) << "opened again";
    EXPECT_EQ(camera.counters()[CameraCount::reconnects], 1U);
    EXPECT_EQ(camera.counters()[CameraCount::lost_transfers], 0U);
}

TEST(V4l2Camera, SilenceIsATimeoutAndStopEnds) {
    V4l2Testbed bed{sensor()};
    auto camera = open();
    RawPacket packet;
    EXPECT_EQ(camera.read(packet), ReadStatus::timeout);
    camera.stop();
    EXPECT_EQ(camera.read(packet), ReadStatus::end);
}

TEST(V4l2Camera, OpenedAndClosedLeavesNothingBehind) {
    V4l2Testbed bed{sensor()};
    test::expect_nothing_left([&] {
        auto camera = open();
        bed.give({bytes_of({time_high(1), time_low(5), row(7), column(3)})});
        for (RawPacket packet; camera.read(packet) != ReadStatus::data;) continue;
        camera.stop();
    });
}

/// Of the sensor's buffers in this process's memory; the kernel may count several as one.
std::size_t mapped_buffers() {
    std::ifstream maps{"/proc/self/maps"};
    std::size_t count = 0;
    for (std::string line; std::getline(maps, line);)
        count += line.ends_with("/dev/video0") ? 1 : 0;
    return count;
}

TEST(V4l2Camera, ASensorThatDoesNotStartLeavesNoMemoryMapped) {
    V4l2Testbed bed{sensor()};
    for (const auto& [request, words] :
         {std::pair{"QBUF", "does not take a buffer"}, {"STREAMON", "does not start streaming"}}) {
        bed.fail_next(request, EIO);
        EXPECT_THAT(failure_of([] { open(); }), HasSubstr(words));
        EXPECT_EQ(mapped_buffers(), 0U) << request;
    }
    {
        auto camera = open({}, true);
        EXPECT_GT(mapped_buffers(), 0U);
        bed.fail_with(EIO);
        bed.fail_next("STREAMON", EIO, 5);
        RawPacket packet;
        for (int look = 0; look < 5; ++look) {
            EXPECT_EQ(camera.read(packet), ReadStatus::timeout);
            EXPECT_EQ(mapped_buffers(), 0U) << look;
        }
        bed.fail_with(0);
        bed.give({bytes_of({time_high(0)})});
        while (camera.read(packet) != ReadStatus::data) continue;
    }
    EXPECT_EQ(mapped_buffers(), 0U);
}

TEST(V4l2Camera, WhateverFailsWhileItIsOpenedAgainItComesBackAndLeavesNothingBehind) {
    V4l2Testbed bed{sensor()};
    auto camera = open({}, true);
    RawPacket packet;
    std::size_t open_files = 0;
    for (const char* request :
         {"QUERYCAP", "G_FMT", "REQBUFS", "QUERYBUF", "QBUF", "STREAMON", "DQBUF"}) {
        bed.fail_next("DQBUF", ENODEV);
        EXPECT_EQ(camera.read(packet), ReadStatus::timeout);  // and opens it
        bed.fail_next("DQBUF", ENODEV);
        bed.fail_next(request, ENODEV, 2);
        for (int look = 0; look < 3; ++look) EXPECT_EQ(camera.read(packet), ReadStatus::timeout);
        bed.give({bytes_of({time_high(0)})});
        while (camera.read(packet) != ReadStatus::data) continue;
        EXPECT_TRUE(packet.gap_before) << request;
        EXPECT_TRUE(packet.reopened) << request;
        const std::size_t files = test::holdings().files;
        if (open_files == 0) open_files = files;
        EXPECT_EQ(files, open_files) << request;
    }
}

TEST(V4l2Camera, ANodeThatVanishesIsWaitedFor) {
    V4l2Testbed bed{sensor()};
    std::vector<std::string> warnings;
    auto camera = open({}, true, test::keep_in(warnings));
    RawPacket packet;
    bed.hide_node(true);
    bed.fail_next("DQBUF", ENODEV);
    for (int look = 0; look < 3; ++look) EXPECT_EQ(camera.read(packet), ReadStatus::timeout);
    EXPECT_THAT(warnings, testing::ElementsAre(HasSubstr("cannot be opened: No such file")));
    bed.hide_node(false);
    bed.give({bytes_of({time_high(0)})});
    while (camera.read(packet) != ReadStatus::data) continue;
    EXPECT_TRUE(packet.reopened);
    EXPECT_EQ(camera.counters()[CameraCount::reconnects], 1U);
}

TEST(V4l2Camera, ASensorThatStopsIsAnErrorOrComesBack) {
    V4l2Testbed bed{sensor()};
    RawPacket packet;
    {
        auto camera = open();
        bed.fail_with(EIO);
        EXPECT_THAT(failure_of([&] { camera.read(packet); }),
                    HasSubstr("/dev/video0 stopped (Input/output error); --reconnect"));
        EXPECT_THAT(failure_of([&] { camera.read(packet); }), HasSubstr("stopped")) << "once more";
        bed.fail_with(0);
    }
    auto camera = open({}, true);
    bed.fail_with(EIO);
    EXPECT_EQ(camera.read(packet), ReadStatus::timeout);
    bed.fail_with(0);
    bed.give({bytes_of({time_high(0)})});
    while (camera.read(packet) != ReadStatus::data) continue;
    EXPECT_TRUE(packet.gap_before);
    EXPECT_TRUE(packet.reopened) << "its clock may count from elsewhere";
    EXPECT_GE(camera.counters()[CameraCount::reconnects], 1U);
    bed.give({bytes_of({time_high(1)}), 1});
    while (camera.read(packet) != ReadStatus::data) continue;
    EXPECT_TRUE(packet.gap_before);
    EXPECT_FALSE(packet.reopened);
}

TEST(V4l2Camera, ADriverThatGivesABufferThereIsNotIsLostLikeAnyOther) {
    V4l2Testbed bed{sensor()};
    auto camera = open();
    bed.give({.bytes = bytes_of({time_high(0)}), .says_index = 4});
    RawPacket packet;
    EXPECT_THAT(failure_of([&] { camera.read(packet); }),
                HasSubstr("stopped (it gave a buffer there is not); --reconnect"));
}

TEST(V4l2Camera, ASensorThatStopsBeforeItGivesDataHasNotComeBack) {
    V4l2Testbed bed{sensor()};
    std::vector<std::string> warnings;
    auto camera = open({}, true, test::keep_in(warnings));
    bed.fail_with(EIO);
    RawPacket packet;
    for (int look = 0; look < 8; ++look) EXPECT_EQ(camera.read(packet), ReadStatus::timeout);
    EXPECT_EQ(camera.counters()[CameraCount::reconnects], 0U);
    EXPECT_THAT(warnings, testing::ElementsAre(HasSubstr("stops before it gives data")));
    bed.fail_with(0);
    bed.give({bytes_of({time_high(0)})});
    while (camera.read(packet) != ReadStatus::data) continue;
    EXPECT_TRUE(packet.reopened);
    EXPECT_EQ(camera.counters()[CameraCount::reconnects], 1U);
}

TEST(V4l2Camera, ASensorThatTakesNoBufferBackIsLostLikeAnyOther) {
    V4l2Testbed bed{sensor()};
    for (const bool reconnect : {false, true}) {
        auto camera = open({}, reconnect);
        bed.give({bytes_of({time_high(0)})});
        RawPacket packet;
        while (camera.read(packet) != ReadStatus::data) continue;
        bed.fail_next("QBUF", ENODEV);
        if (!reconnect) {
            EXPECT_THAT(failure_of([&] { camera.read(packet); }),
                        HasSubstr("stopped (No such device); --reconnect"));
            continue;
        }
        EXPECT_EQ(camera.read(packet), ReadStatus::timeout);
        bed.give({bytes_of({time_high(0)})});
        while (camera.read(packet) != ReadStatus::data) continue;
        EXPECT_TRUE(packet.gap_before);
        EXPECT_EQ(camera.counters()[CameraCount::reconnects], 1U);
    }
}

TEST(V4l2Camera, WhatComesBackIsWaitedForUntilItIsAsItWas) {
    V4l2Testbed bed{sensor()};
    std::vector<std::string> warnings;
    auto camera = open({}, true, test::keep_in(warnings));
    const auto come_back = [&](std::uint32_t fourcc, int width, int height) {
        bed.change_format(fourcc, width, height);
        RawPacket packet;
        for (int look = 0; look < 3; ++look) EXPECT_EQ(camera.read(packet), ReadStatus::timeout);
    };
    bed.fail_next("DQBUF", EIO);
    come_back(kEvt21, 320, 320);
    come_back(kEvt3, 1280, 320);
    come_back(kEvt3, 320, 240);
    EXPECT_THAT(
        warnings,
        testing::ElementsAre(
            HasSubstr("'eventide testbed' with PSE2 of 320x320 px, expected 'eventide testbed' "
                      "with PSE3 of 320x320 px as before"),
            HasSubstr("PSE3 of 1280x320 px, expected 'eventide testbed' with PSE3 of 320x320"),
            HasSubstr("PSE3 of 320x240 px")));
    EXPECT_EQ(camera.counters()[CameraCount::reconnects], 0U);
    EXPECT_EQ(camera.info().width, 320);
    come_back(kEvt3, 320, 320);
    bed.give({bytes_of({time_high(0)})});
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    EXPECT_EQ(camera.counters()[CameraCount::reconnects], 1U);
}

TEST(V4l2Camera, OneThatComesBackInAnotherFormatIsSetToTheOneItHad) {
    V4l2NodeSettings settings = sensor();
    settings.offers = {kEvt21, kEvt3};
    V4l2Testbed bed{settings};
    auto camera = open({}, true);
    bed.change_format(kEvt21, 320, 320);
    bed.fail_next("DQBUF", EIO);
    bed.give({bytes_of({time_high(0)})});
    RawPacket packet;
    for (int look = 0; look < 3 && !packet.reopened; ++look) camera.read(packet);
    EXPECT_TRUE(packet.reopened);
    EXPECT_EQ(bed.fourcc(), kEvt3);
}

/// Where the user says that a format means events, the format alone does not tell a camera.
TEST(V4l2Camera, AnotherDeviceAtItsNodeIsNotTakenForIt) {
    V4l2Testbed bed{sensor(V4L2_PIX_FMT_GREY)};
    V4l2Settings stated;
    stated.encoding = EvtEncoding::evt3;
    std::vector<std::string> warnings;
    auto camera = open(stated, true, test::keep_in(warnings));
    bed.fail_next("DQBUF", ENODEV);
    const auto look = [&] {
        RawPacket packet;
        for (int i = 0; i < 3; ++i) EXPECT_EQ(camera.read(packet), ReadStatus::timeout);
    };
    bed.change_card("a webcam");
    look();
    bed.change_card("eventide testbed");
    bed.change_format(V4L2_PIX_FMT_YUYV, 320, 320);
    look();
    EXPECT_THAT(warnings, testing::ElementsAre(HasSubstr("'a webcam' with GREY of 320x320 px"),
                                               HasSubstr("with YUYV of 320x320 px, expected "
                                                         "'eventide testbed' with GREY")));
    EXPECT_EQ(camera.counters()[CameraCount::reconnects], 0U);
    bed.change_format(V4L2_PIX_FMT_GREY, 320, 320);
    bed.give({bytes_of({time_high(0)})});
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    EXPECT_TRUE(packet.reopened);
}

TEST(V4l2Camera, WhyItIsNotBackIsToldOnce) {
    V4l2NodeSettings settings = sensor();
    settings.controls = {{"bias_fo", {-10, 10, 0}}};
    V4l2Testbed bed{settings};
    V4l2Settings wanted;
    wanted.controls["bias_fo"] = 5;
    std::vector<std::string> warnings;
    auto camera = open(wanted, true, test::keep_in(warnings));
    const auto look = [&](int times) {
        RawPacket packet;
        for (int i = 0; i < times; ++i) EXPECT_EQ(camera.read(packet), ReadStatus::timeout);
    };
    bed.fail_next("DQBUF", EIO);
    bed.fail_next("STREAMON", EIO, 3);
    look(3);
    EXPECT_THAT(warnings, testing::ElementsAre(HasSubstr("does not start streaming")));
    bed.fail_next("STREAMON", EBUSY, 3);
    look(3);
    ASSERT_EQ(warnings.size(), 2U);
    EXPECT_THAT(warnings[1], HasSubstr("in use by another program"));
    bed.give({bytes_of({time_high(0)})});
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    EXPECT_EQ(camera.counters()[CameraCount::reconnects], 1U);
    bed.fail_next("DQBUF", EIO);
    bed.fail_next("STREAMON", EIO);
    look(1);
    EXPECT_EQ(warnings.size(), 3U) << "gone once more";
    bed.take_controls_away();
    look(2);
    ASSERT_EQ(warnings.size(), 4U);
    EXPECT_THAT(warnings[3], HasSubstr("no control 'bias_fo'"));
}

}  // namespace
}  // namespace eventide
