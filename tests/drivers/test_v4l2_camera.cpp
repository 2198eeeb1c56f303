// The V4L2 source against an event sensor in software: mapped memory, EVT words across buffers,
// controls, refusals.
#include "drivers/devices.h"
#include "drivers/v4l2/v4l2_camera.h"
#include "replay/formats.h"
#include "src/core/error.h"
#include "tests/drivers/v4l2_sensor.h"
#include "tests/support/preload.h"
#include "tests/support/v4l2/v4l2_testbed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <linux/videodev2.h>

#include <filesystem>
#include <fstream>

namespace eventide {
namespace {

using testing::HasSubstr;
using namespace testing_support::v4l2;
using testing_support::V4l2NodeSettings;
using testing_support::V4l2Testbed;

constexpr std::uint32_t kEvt2 = v4l2_fourcc('P', 'S', 'E', 'E'),
                        kEvt21Swapped = v4l2_fourcc('P', 'S', 'E', '1'),
                        kEvt21 = v4l2_fourcc('P', 'S', 'E', '2');

/// Until everything given was taken.
Batch read_all(V4l2Camera& camera, const V4l2Testbed& bed) {
    const auto parser = camera.make_parser();
    Batch data;
    for (RawPacket packet;;) {
        const ReadStatus status = camera.read(packet);
        if (status == ReadStatus::data) parser->parse(packet.bytes, data);
        if (status == ReadStatus::end || (status == ReadStatus::timeout && bed.all_taken())) break;
    }
    parser->finish(data);  // a first time waits for the next
    return data;
}

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

/// EVT2.1 (docs/protocols.md D.4): words of 64 bits, in one of two orders of their halves.
std::vector<std::byte> evt21_bytes(std::initializer_list<std::uint64_t> words, bool swapped) {
    std::vector<std::byte> bytes;
    for (const std::uint64_t w : words)
        for (int i = 0; i < 8; ++i) bytes.push_back(std::byte(w >> (8 * (swapped ? i ^ 4 : i))));
    return bytes;
}
constexpr std::uint64_t evt21_time_high(std::uint64_t t) {
    return std::uint64_t{8} << 60 | t << 32;
}
constexpr std::uint64_t evt21_on(std::uint64_t time_low, std::uint64_t x, std::uint64_t y,
                                 std::uint64_t mask) {
    return std::uint64_t{1} << 60 | time_low << 54 | x << 43 | y << 32 | mask;
}
constexpr std::uint64_t kEvt21EndOfData = 0xE000001900000000;

TEST(V4l2Camera, Evt21ComesInEitherOrderOfItsHalves) {
    for (const std::uint32_t fourcc : {kEvt21, kEvt21Swapped}) {
        V4l2Testbed bed{sensor(fourcc)};
        auto camera = open();
        EXPECT_EQ(camera.info().format, "evt21");
        bed.give({evt21_bytes({evt21_time_high(3), evt21_on(5, 32, 7, 0b101)},
                              fourcc == kEvt21Swapped)});
        const Batch data = read_all(camera, bed);
        ASSERT_EQ(data.events.size(), 2U);
        EXPECT_EQ(data.events[0], (Event{from_us(3 * 64 + 5), 32, 7, Polarity::on}));
        EXPECT_EQ(data.events[1], (Event{from_us(3 * 64 + 5), 34, 7, Polarity::on}));
    }
}

TEST(V4l2Camera, NoMaskOfColumnsEndsTheData) {
    constexpr std::uint64_t kLikeTheMarker = 0xE0000019;
    for (const std::uint32_t fourcc : {kEvt21, kEvt21Swapped}) {
        V4l2Testbed bed{sensor(fourcc)};
        auto camera = open();
        bed.give({evt21_bytes({evt21_time_high(3), evt21_on(5, 32, 7, kLikeTheMarker),
                               evt21_on(6, 32, 7, 1), kEvt21EndOfData, evt21_on(7, 32, 7, 1)},
                              fourcc == kEvt21Swapped)});
        EXPECT_EQ(read_all(camera, bed).events.size(), 7U);
    }
}

TEST(V4l2Camera, TheMarkersOtherBitsMayBeAnything) {
    constexpr std::uint64_t kOthers = 0x1ABCDE0012345678;
    for (const std::uint32_t fourcc : {kEvt21, kEvt21Swapped}) {
        V4l2Testbed bed{sensor(fourcc)};
        auto camera = open();
        bed.give({evt21_bytes({evt21_time_high(3), evt21_on(5, 32, 7, 1), kEvt21EndOfData | kOthers,
                               evt21_on(7, 32, 7, 1)},
                              fourcc == kEvt21Swapped)});
        EXPECT_EQ(read_all(camera, bed).events.size(), 1U);
        EXPECT_EQ(camera.counters()[CameraCount::bytes], 16U) << "before the marker";
    }
}

TEST(V4l2Camera, TheSubdeviceKnowsTheSensorsSize) {
    V4l2NodeSettings settings = sensor(V4L2_PIX_FMT_GREY);  // of the Raspberry Pi's receiver
    settings.width = 4096;
    settings.height = 391;
    settings.sensor_width = 1280;
    settings.sensor_height = 720;
    V4l2Testbed bed{settings};
    V4l2Settings wanted;
    wanted.encoding = EvtEncoding::evt21;
    wanted.subdevice = "/dev/v4l-subdev0";
    auto camera = open(wanted);
    EXPECT_EQ(camera.info().width, 1280);
    EXPECT_EQ(camera.info().height, 720);
    bed.give({evt21_bytes(
        {evt21_time_high(0), evt21_on(1, 0, 719, 1), kEvt21EndOfData, evt21_on(2, 0, 1, 1)},
        false)});
    EXPECT_EQ(read_all(camera, bed).events.size(), 1U) << "behind the marker is no data";
}

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

/// The words of a Prophesee file without its header, in buffers of one size.
void give_file(V4l2Testbed& bed, const std::filesystem::path& file) {
    std::ifstream stream{file, std::ios::binary};
    while (stream.peek() == '%') {
        std::string line;
        std::getline(stream, line);
    }
    std::vector<char> piece(60'000);
    while (stream.read(piece.data(), std::streamsize(piece.size())) || stream.gcount() > 0) {
        const auto* begin = reinterpret_cast<const std::byte*>(piece.data());
        bed.give({{begin, begin + stream.gcount()}});
    }
}

TEST(V4l2Camera, GivesWhatTheFileHolds) {
    const std::filesystem::path folder =
        std::filesystem::path{EVENTIDE_SOURCE_DIR} / "../shared/data/formats";
    for (const auto& [name, fourcc, width, height] :
         {std::tuple{"evt2_640x480.raw", kEvt2, 640, 480},
          std::tuple{"evt3_1280x720_5000.raw", kEvt3, 1280, 720}}) {
        if (!std::filesystem::exists(folder / name))
            GTEST_SKIP() << "no recordings beside the project";
        V4l2NodeSettings settings = sensor(fourcc);
        settings.width = width;
        settings.height = height;
        V4l2Testbed bed{settings};
        give_file(bed, folder / name);
        auto camera = open();
        const Batch live = read_all(camera, bed);

        Batch file;
        const auto recording = open_recording((folder / name).string());
        const auto parser = recording->make_parser();
        for (RawPacket packet; recording->read(packet) == ReadStatus::data;)
            parser->parse(packet.bytes, file);
        EXPECT_EQ(live.events, file.events) << name;
        EXPECT_FALSE(live.events.empty());
    }
}

TEST(V4l2Camera, RaspberryPisFramesEndAtTheMarker) {
    V4l2Testbed bed{sensor(V4L2_PIX_FMT_GREY)};
    EXPECT_THAT(failure_of([] { open(); }), HasSubstr("gives format 'GREY', expected PSEE"));
    V4l2Settings settings;
    settings.encoding = EvtEncoding::evt3;
    auto camera = open(settings);
    bed.give({bytes_of(
        {time_high(0), time_low(1), row(1), column(1), kEndOfData, column(2), column(3)})});
    EXPECT_EQ(read_all(camera, bed).events.size(), 1U);
}

TEST(V4l2Camera, ControlsAreSetByNameAndChecked) {
    V4l2NodeSettings settings = sensor();
    settings.controls = {{"bias_fo", {-10, 10, 0}},
                         {"bias_refr", {-10, 10, 3, false, true}},
                         {"serial", {0, 100, 7, true}},
                         {"unused", {.maximum = 9, .disabled = true}}};
    V4l2Testbed bed{settings};
    const auto with = [](const std::string& name, int value) {
        V4l2Settings wanted;
        wanted.controls[name] = value;
        return failure_of([&] { open(wanted); });
    };
    EXPECT_EQ(with("bias_fo", 5), "nothing was thrown");
    EXPECT_EQ(bed.control("bias_fo").value, 5);
    EXPECT_THAT(with("bias_fo", 50), HasSubstr("expected -10 to 10, found 50"));
    EXPECT_THAT(with("bias_fo", -50), HasSubstr("expected -10 to 10, found -50"));
    EXPECT_THAT(with("bias_refr", 5), HasSubstr("set to 5, reads back as 3"));
    EXPECT_EQ(with("bias_refr", 3), "nothing was thrown");
    EXPECT_THAT(with("bias_hpf", 1), HasSubstr("no control 'bias_hpf'"));
    EXPECT_THAT(with("serial", 1), HasSubstr("cannot be written: expected its value, 7, found 1"));
    EXPECT_THAT(with("unused", 1), HasSubstr("cannot be written: expected it left out, found 1"));
}

/// v4l2-ctl lists "Vertical Flip" as vertical_flip.
TEST(V4l2Camera, ControlsMayBeNamedAsV4l2CtlListsThem) {
    V4l2NodeSettings settings = sensor();
    settings.controls = {{"Vertical Flip", {0, 1, 0}}, {"(Gain) analogue, x2", {0, 10, 0}}};
    V4l2Testbed bed{settings};
    V4l2Settings wanted;
    wanted.controls = {{"vertical_flip", 1}, {"gain_analogue_x2", 7}};
    open(wanted);
    EXPECT_EQ(bed.control("Vertical Flip").value, 1);
    EXPECT_EQ(bed.control("(Gain) analogue, x2").value, 7);
    wanted.controls = {{"Vertical Flip", 0}};
    open(wanted);
    EXPECT_EQ(bed.control("Vertical Flip").value, 0);
}

TEST(V4l2Camera, WithControlsItSaysAsWellWhyItCannotBeOpened) {
    V4l2Settings wanted;
    wanted.controls = {{"bias_fo", 1}};
    EXPECT_THAT(failure_of([&] { open(wanted); }), HasSubstr("is the driver loaded"));
}

TEST(V4l2Camera, ASubdeviceThatIsNotThereIsNamed) {
    V4l2Testbed bed{sensor()};
    V4l2Settings wanted;
    wanted.subdevice = "/dev/v4l-subdev7";
    EXPECT_THAT(failure_of([&] { open(wanted); }),
                HasSubstr("the camera /dev/v4l-subdev7 cannot be opened: No such file"));
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
