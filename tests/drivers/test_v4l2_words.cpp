// The words of an event sensor in software behind V4L2, up to where its receiver says that they
// end.
#include "replay/formats.h"
#include "tests/drivers/v4l2_sensor.h"
#include "tests/support/v4l2/v4l2_testbed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace eventide {
namespace {

using testing::HasSubstr;
using namespace testing_support::v4l2;
using testing_support::V4l2NodeSettings;
using testing_support::V4l2Testbed;

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

TEST(V4l2Words, Evt21ComesInEitherOrderOfItsHalves) {
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

TEST(V4l2Words, NoMaskOfColumnsEndsTheData) {
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

TEST(V4l2Words, TheMarkersOtherBitsMayBeAnything) {
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

TEST(V4l2Words, TheSubdeviceKnowsTheSensorsSize) {
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

TEST(V4l2Words, GivesWhatTheFileHolds) {
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

TEST(V4l2Words, RaspberryPisFramesEndAtTheMarker) {
    V4l2Testbed bed{sensor(V4L2_PIX_FMT_GREY)};
    EXPECT_THAT(failure_of([] { open(); }), HasSubstr("gives format 'GREY', expected PSEE"));
    V4l2Settings settings;
    settings.encoding = EvtEncoding::evt3;
    auto camera = open(settings);
    bed.give({bytes_of(
        {time_high(0), time_low(1), row(1), column(1), kEndOfData, column(2), column(3)})});
    EXPECT_EQ(read_all(camera, bed).events.size(), 1U);
}

}  // namespace
}  // namespace eventide
