// The V4L2 source against an event sensor in software: mapped memory, formats, sizes, refusals.
#include "drivers/devices.h"
#include "tests/drivers/v4l2_sensor.h"
#include "tests/support/preload.h"
#include "tests/support/v4l2/v4l2_testbed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <linux/videodev2.h>

#include <cerrno>
#include <utility>
#include <vector>

namespace eventide {
namespace {

using testing::HasSubstr;
using namespace testing_support::v4l2;
using testing_support::V4l2NodeSettings;
using testing_support::V4l2Testbed;

TEST(V4l2Camera, ASequenceThatStandsStillIsNoLossAndNoGap) {
    V4l2Testbed bed{sensor()};
    auto camera = open();
    constexpr std::uint32_t kStandsStill = UINT32_MAX;  // added to a number that then goes on by 1
    RawPacket packet;
    for (unsigned k = 0; k < 8; ++k) {
        bed.give({bytes_of({time_high(k)}), k == 0 ? 0 : kStandsStill});
        while (camera.read(packet) != ReadStatus::data) continue;
        EXPECT_FALSE(packet.gap_before) << k;
    }
    EXPECT_EQ(camera.counters()[CameraCount::lost_transfers], 0U);
}

class V4l2Planes : public testing::TestWithParam<bool> {};

TEST_P(V4l2Planes, EventsGoOnAcrossBuffers) {
    V4l2NodeSettings settings = sensor();
    settings.multi_planar = GetParam();
    settings.data_offset = 64;
    V4l2Testbed bed{settings};
    auto camera = open();
    EXPECT_EQ(camera.info().format, "evt3");
    EXPECT_EQ(camera.info().width, 320);
    // The row and the time are told in the first buffer, the column in the second; more buffers
    // than there are memory.
    bed.give({bytes_of({time_high(1), time_low(5), row(7)})});
    for (unsigned x = 0; x < 20; ++x) bed.give({bytes_of({column(x)})});
    const Batch data = read_all(camera, bed);
    ASSERT_EQ(data.events.size(), 20U);
    EXPECT_EQ(data.events[3], (Event{from_us(4096 + 5), 3, 7, Polarity::on}));
}

TEST_P(V4l2Planes, ABufferThatIsSaidToHoldMoreThanItHasRoomForIsTakenToItsEnd) {
    V4l2NodeSettings settings = sensor();
    settings.multi_planar = GetParam();
    settings.buffer_bytes = 4096;
    V4l2Testbed bed{settings};
    auto camera = open();
    for (const std::uint32_t said : {4098U, 1U << 20, UINT32_MAX}) {
        bed.give({std::vector<std::byte>(4096), 0, false, said});
        RawPacket packet;
        while (camera.read(packet) != ReadStatus::data) continue;
        EXPECT_EQ(packet.bytes.size(), 4096U) << said;
    }
}

TEST_P(V4l2Planes, DataThatAreSaidToBeginBehindTheirEndAreNone) {
    V4l2NodeSettings settings = sensor();
    settings.multi_planar = GetParam();
    settings.data_offset = 64;
    V4l2Testbed bed{settings};
    auto camera = open();
    bed.give({bytes_of({time_high(1)}), 0, false, 0});
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    EXPECT_TRUE(packet.bytes.empty());
}

INSTANTIATE_TEST_SUITE_P(SingleAndMultiPlanar, V4l2Planes, testing::Bool());

class V4l2Formats : public testing::TestWithParam<bool> {
protected:
    /// A node that was left in this format.
    V4l2NodeSettings left_in(std::uint32_t fourcc, std::vector<std::uint32_t> offers) const {
        V4l2NodeSettings settings = sensor(fourcc);
        settings.multi_planar = GetParam();
        settings.offers = std::move(offers);
        return settings;
    }
};

TEST_P(V4l2Formats, ANodeThatWasLeftInAnotherIsSetToOneThatHoldsEvents) {
    V4l2Testbed bed{left_in(V4L2_PIX_FMT_YUYV, {V4L2_PIX_FMT_YUYV, kEvt21, kEvt3})};
    const auto listed = list_v4l2_cameras();
    ASSERT_EQ(listed.size(), 1U);
    EXPECT_EQ(listed[0].name, "eventide testbed (PSE2)");
    EXPECT_EQ(bed.fourcc(), V4L2_PIX_FMT_YUYV) << "a list changes nothing";
    const auto camera = open();
    EXPECT_EQ(bed.fourcc(), kEvt21);
    EXPECT_EQ(camera.info().format, "evt21");
    EXPECT_EQ(camera.info().width, 320);
    EXPECT_EQ(camera.info().height, 320);
}

TEST_P(V4l2Formats, OfSeveralWithEventsTheOneThatIsAskedForIsSet) {
    V4l2Settings stated;
    stated.encoding = EvtEncoding::evt3;
    {
        V4l2Testbed bed{left_in(kEvt21, {V4L2_PIX_FMT_YUYV, kEvt21, kEvt3})};
        EXPECT_EQ(open(stated).info().format, "evt3");
        EXPECT_EQ(bed.fourcc(), kEvt3);
    }
    V4l2Testbed bed{left_in(kEvt21, {V4L2_PIX_FMT_YUYV, kEvt21})};
    EXPECT_THAT(failure_of([&] { open(stated); }),
                HasSubstr("gives format 'PSE2', expected PSE3, as encoding in the camera's "
                          "settings says"));
}

TEST_P(V4l2Formats, OneThatHoldsEventsOrIsSaidToStays) {
    for (const std::uint32_t fourcc : {kEvt3, std::uint32_t{V4L2_PIX_FMT_GREY}}) {
        V4l2Testbed bed{left_in(fourcc, {kEvt21, kEvt3})};
        V4l2Settings stated;
        if (fourcc != kEvt3) stated.encoding = EvtEncoding::evt3;
        EXPECT_EQ(open(stated).info().format, "evt3");
        EXPECT_EQ(bed.fourcc(), fourcc);
    }
}

TEST_P(V4l2Formats, WhereThereIsNoneWithEventsTheNodeStaysAsItIs) {
    V4l2Testbed bed{left_in(V4L2_PIX_FMT_GREY, {V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_GREY})};
    EXPECT_TRUE(list_v4l2_cameras().empty());
    EXPECT_THAT(failure_of([] { open(); }), HasSubstr("gives format 'GREY', expected PSEE"));
    EXPECT_EQ(bed.fourcc(), V4L2_PIX_FMT_GREY);
}

TEST_P(V4l2Formats, ANodeThatCannotBeSetSaysWhy) {
    V4l2Testbed bed{left_in(V4L2_PIX_FMT_GREY, {kEvt3})};
    bed.fail_next("S_FMT", EBUSY);
    EXPECT_THAT(failure_of([] { open(); }),
                HasSubstr("/dev/video0 cannot be set from format 'GREY' to 'PSE3': Device or "
                          "resource busy (in use by another program)"));
}

INSTANTIATE_TEST_SUITE_P(SingleAndMultiPlanar, V4l2Formats, testing::Bool());

TEST(V4l2Camera, ASizeThatIsStatedCountsAndOneThatNoSensorHasIsRefused) {
    V4l2NodeSettings settings = sensor();
    settings.width = 5000;
    settings.sensor_width = 1280;
    settings.sensor_height = 720;
    V4l2Testbed bed{settings};
    EXPECT_THAT(failure_of([] { open(); }),
                HasSubstr("says its sensor is 5000x320 px: state size"));
    bed.change_format(kEvt3, 320, 0);
    EXPECT_THAT(failure_of([] { open(); }), HasSubstr("says its sensor is 320x0 px: state size"));
    V4l2Settings wanted;
    wanted.subdevice = "/dev/v4l-subdev0";
    wanted.width = 640;
    wanted.height = 480;
    auto camera = open(wanted);
    EXPECT_EQ(camera.info().width, 640);
    EXPECT_EQ(camera.info().height, 480);
}

TEST(V4l2Camera, SaysWhyItCannotBeUsed) {
    EXPECT_THAT(failure_of([] { open(); }), HasSubstr("is the driver loaded"));
    const auto with = [](auto change) {
        V4l2NodeSettings settings = sensor();
        change(settings);
        V4l2Testbed bed{settings};
        return failure_of([] { open(); });
    };
    EXPECT_THAT(with([](auto& s) { s.output = true; }), HasSubstr("does not capture"));
    EXPECT_THAT(with([](auto& s) { s.streams = false; }),
                HasSubstr("cannot stream into mapped memory"));
    EXPECT_THAT(with([](auto& s) { s.most_buffers = 1; }),
                HasSubstr("gives fewer than two buffers"));
}

// VIDIOC_STREAMON's words for formats that differ along the way, and for links that are not there.
TEST(V4l2Camera, SaysWhatIsWrongBetweenTheSensorAndTheReceiver) {
    V4l2Testbed bed{sensor()};
    bed.fail_next("STREAMON", EPIPE);
    EXPECT_THAT(failure_of([] { open(); }),
                HasSubstr("does not start streaming: Broken pipe (formats differ between the "
                          "sensor and this node: set them alike with media-ctl)"));
    bed.fail_next("STREAMON", ENOLINK);
    EXPECT_THAT(failure_of([] { open(); }),
                HasSubstr("(no sensor is linked to this node: link one with media-ctl)"));
}

}  // namespace
}  // namespace eventide

int main(int argc, char** argv) {
    eventide::testing_support::enter_testbed(argv);
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
