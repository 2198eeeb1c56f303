// The V4L2 source against an event sensor in software: mapped memory, EVT words across buffers,
// loss, silence, return.
#include "drivers/devices.h"
#include "drivers/v4l2/v4l2_camera.h"
#include "replay/formats.h"
#include "src/core/error.h"
#include "tests/support/preload.h"
#include "tests/support/v4l2/v4l2_testbed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <linux/videodev2.h>

#include <filesystem>
#include <fstream>
#include <functional>

namespace eventide {
namespace {

using testing::HasSubstr;
using testing_support::V4l2NodeSettings;
using testing_support::V4l2Testbed;

constexpr std::uint32_t kEvt2 = v4l2_fourcc('P', 'S', 'E', 'E'),
                        kEvt21Swapped = v4l2_fourcc('P', 'S', 'E', '1'),
                        kEvt21 = v4l2_fourcc('P', 'S', 'E', '2'),
                        kEvt3 = v4l2_fourcc('P', 'S', 'E', '3');

std::vector<std::byte> bytes_of(std::initializer_list<unsigned> words) {
    std::vector<std::byte> bytes;
    for (const unsigned w : words) {
        bytes.push_back(std::byte(w & 0xFF));
        bytes.push_back(std::byte(w >> 8));
    }
    return bytes;
}
// EVT3 (docs/protocols.md D.4).
constexpr unsigned time_high(unsigned t) {
    return 0x8000 | t;
}
constexpr unsigned time_low(unsigned t) {
    return 0x6000 | t;
}
constexpr unsigned row(unsigned y) {
    return y;
}
constexpr unsigned column(unsigned x) {
    return 0x2800 | x;
}
constexpr unsigned kEndOfData = 0xE019;

V4l2NodeSettings sensor(std::uint32_t fourcc = kEvt3) {
    V4l2NodeSettings settings;
    settings.fourcc = fourcc;
    settings.width = 320;
    settings.height = 320;
    return settings;
}

V4l2Camera open(V4l2Settings settings = {}, bool reconnect = false) {
    return V4l2Camera{"/dev/video0", std::move(settings), reconnect};
}

std::string failure_of(const std::function<void()>& what) {
    try {
        what();
    } catch (const Error& error) {
        return error.what();
    }
    return "nothing was thrown";
}

/// Until everything given was taken.
Batch read_all(V4l2Camera& camera, const V4l2Testbed& bed) {
    const auto parser = camera.make_parser();
    Batch data;
    for (RawPacket packet;;) {
        const ReadStatus status = camera.read(packet);
        if (status == ReadStatus::data) parser->parse(packet.bytes, data);
        if (status == ReadStatus::end || (status == ReadStatus::timeout && bed.all_taken())) break;
    }
    return data;
}

TEST(V4l2Camera, ASequenceThatStandsStillOrFallsIsNoLoss) {
    V4l2Testbed bed{sensor()};
    auto camera = open();
    constexpr std::uint32_t kStandsStill = UINT32_MAX;  // added to a number that then goes on by 1
    for (unsigned x = 0; x < 8; ++x)
        bed.give(
            {bytes_of({time_high(1), time_low(x), row(7), column(x)}), x == 0 ? 0 : kStandsStill});
    bed.give({bytes_of({time_low(9)}), UINT32_MAX - 3});  // the driver began anew
    EXPECT_EQ(read_all(camera, bed).events.size(), 8U);
    EXPECT_EQ(camera.counters().device_dropped, 0U);
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
    EXPECT_EQ(camera.counters().device_dropped, 3U);
}

TEST(V4l2Camera, SilenceIsATimeoutAndStopEnds) {
    V4l2Testbed bed{sensor()};
    auto camera = open();
    RawPacket packet;
    EXPECT_EQ(camera.read(packet), ReadStatus::timeout);
    camera.stop();
    EXPECT_EQ(camera.read(packet), ReadStatus::end);
}

TEST(V4l2Camera, ASensorThatStopsIsAnErrorOrComesBack) {
    V4l2Testbed bed{sensor()};
    RawPacket packet;
    {
        auto camera = open();
        bed.fail_with(EIO);
        EXPECT_THAT(failure_of([&] { camera.read(packet); }), HasSubstr("--reconnect"));
        bed.fail_with(0);
    }
    auto camera = open({}, true);
    bed.fail_with(EIO);
    EXPECT_EQ(camera.read(packet), ReadStatus::timeout);
    bed.fail_with(0);
    bed.give({bytes_of({time_high(0)})});
    while (camera.read(packet) != ReadStatus::data) continue;
    EXPECT_TRUE(packet.gap_before);
    EXPECT_GE(camera.counters().reconnects, 1U);
}

TEST(V4l2Camera, ControlsAreSetByNameAndChecked) {
    V4l2NodeSettings settings = sensor();
    settings.controls = {{"bias_fo", {-10, 10, 0}}, {"serial", {0, 100, 7, true}}};
    V4l2Testbed bed{settings};
    const auto with = [](const std::string& name, int value) {
        V4l2Settings wanted;
        wanted.controls[name] = value;
        return failure_of([&] { open(wanted); });
    };
    EXPECT_EQ(with("bias_fo", 5), "nothing was thrown");
    EXPECT_EQ(bed.control("bias_fo").value, 5);
    EXPECT_THAT(with("bias_fo", 50), HasSubstr("expected -10 to 10, found 50"));
    EXPECT_THAT(with("bias_hpf", 1), HasSubstr("no control 'bias_hpf'"));
    EXPECT_THAT(with("serial", 1), HasSubstr("cannot be written"));
}

/// What Metavision writes of a sensor of the third generation.
constexpr const char* kBiases =
    "% header % of any length\n% system_ID 28\n"
    "300   % bias_diff           %   v\n221  % bias_diff_off\r\n\n0x180% bias_diff_on\n"
    "0x18 % bias_refr\n-5   % bias_fo\n";

class BiasFile : public testing::Test {
protected:
    std::filesystem::path write(const std::string& text, const char* name = "sensor.bias") {
        const auto file = std::filesystem::path{testing::TempDir()} / name;
        std::ofstream{file} << text;
        return file;
    }
    std::string failure(const std::string& text) {
        const auto file = write(text);
        return failure_of([&] { open(load_v4l2_settings(file)); });
    }
    static V4l2NodeSettings with_biases() {
        V4l2NodeSettings settings = sensor();
        settings.controls = {{"bias_diff", {300, 300, 300, true}},
                             {"bias_diff_off", {0, 299, 200}},
                             {"bias_fo", {-10, 10, 0}},
                             {"bias_refr", {0, 100, 0}}};
        return settings;
    }
};

TEST_F(BiasFile, SetsTheDriversControls) {
    V4l2Testbed bed{with_biases()};
    open(
        load_v4l2_settings(write("300 % bias_diff\n221  % bias_diff_off\n0x18 % bias_refr\n"
                                 "-5 % bias_fo % i\n")));
    EXPECT_EQ(bed.control("bias_diff_off").value, 221);
    EXPECT_EQ(bed.control("bias_refr").value, 0x18);
    EXPECT_EQ(bed.control("bias_fo").value, -5);
    // And what the sensor has now, written as Metavision does, is the same file again.
    std::string saved;
    for (const auto& [name, control] : with_biases().controls)
        saved += std::to_string(bed.control(name).value) + "  % " + name + "\n";
    const V4l2Settings again = load_v4l2_settings(write(saved));
    EXPECT_EQ(again.controls,
              load_v4l2_settings(write("300 % bias_diff\n221 % bias_diff_off\n24 % bias_refr\n"
                                       "-5 % bias_fo\n"))
                  .controls);
    open(again);
    EXPECT_EQ(bed.control("bias_fo").value, -5);
}

TEST_F(BiasFile, IsReadWithHeaderCommentsAndHexadecimals) {
    const auto controls = load_v4l2_settings(write(kBiases)).controls;
    EXPECT_EQ(controls, (std::map<std::string, std::int64_t>{{"bias_diff", 300},
                                                             {"bias_diff_off", 221},
                                                             {"bias_diff_on", 384},
                                                             {"bias_fo", -5},
                                                             {"bias_refr", 24}}));
}

TEST_F(BiasFile, WhatDoesNotFitIsNamedWithItsLine) {
    V4l2Testbed bed{with_biases()};
    EXPECT_THAT(failure("% header\n5 % bias_fo\n11 % bias_refr\n1 % bias_hpf\n"),
                HasSubstr("sensor.bias:4: /dev/video0 has no control 'bias_hpf'"));
    EXPECT_THAT(failure("5 % bias_fo\n300 % bias_diff_off\n"),
                HasSubstr("sensor.bias:2: control 'bias_diff_off' of /dev/video0: expected 0 to "
                          "299, found 300"));
    EXPECT_EQ(bed.control("bias_fo").value, 0) << "nothing is set before all is known to fit";
    EXPECT_THAT(failure("299 % bias_diff\n"),
                HasSubstr("sensor.bias:1: control 'bias_diff' of /dev/video0 cannot be written: "
                          "expected its value, 300, found 299"));
    EXPECT_THAT(failure("5 % bias_fo\n6 % bias_fo\n"),
                HasSubstr("sensor.bias:2: 'bias_fo' is 6 here, and 5 in "));
    EXPECT_THAT(failure("5 bias_fo\n"), HasSubstr("sensor.bias:1: expected VALUE % NAME"));
    EXPECT_THAT(failure("5 5 % bias_fo\n"), HasSubstr("sensor.bias:1: expected VALUE % NAME"));
    EXPECT_THAT(failure("5 % bias_fo bias_hpf\n"), HasSubstr("sensor.bias:1: expected VALUE"));
    EXPECT_THAT(failure("99999999999 % bias_fo\n"), HasSubstr("sensor.bias:1: expected VALUE"));
    EXPECT_THAT(failure("% header\n"), HasSubstr("found none"));
    EXPECT_THAT(failure_of([] { load_v4l2_settings("/none/x.bias"); }), HasSubstr("/none/x.bias"));
}

TEST_F(BiasFile, IsReadFromMetavisionsCameraSettings) {
    V4l2Testbed bed{with_biases()};
    const auto settings_of = [&](const std::string& text) {
        return load_v4l2_settings(write(text, "settings.json"));
    };
    open(settings_of(R"({"digital_crop_state": {"enabled": false},
        "ll_biases_state": {"bias": [{"name": "bias_diff_off", "value": 221},
                                     {"name": "bias_fo", "value": -5}, {"name": "bias_refr"}]}})"));
    EXPECT_EQ(bed.control("bias_diff_off").value, 221);
    EXPECT_EQ(bed.control("bias_fo").value, -5);
    EXPECT_EQ(bed.control("bias_refr").value, 0);
    const auto refusal = [&](const std::string& biases) {
        return failure_of(
            [&] { open(settings_of(R"({"ll_biases_state": {"bias": )" + biases + "}}")); });
    };
    EXPECT_THAT(refusal(R"([{"name": "bias_fo", "value": 5}, {"name": "bias_hpf", "value": 1}])"),
                HasSubstr("settings.json: ll_biases_state.bias[1]: /dev/video0 has no control "
                          "'bias_hpf'"));
    for (const char* wrong :
         {R"([{"name": "bias_fo", "value": 1.5}])", R"([{"name": "bias_fo", "value": "1"}])",
          R"([{"name": "bias_fo", "value": 3000000000}])", R"([{"value": 1}])", "[7]", "[null]"})
        EXPECT_THAT(refusal(wrong), HasSubstr("ll_biases_state.bias[0]: expected {\"name\""))
            << wrong;
    EXPECT_THAT(refusal("[]"), HasSubstr("expected camera settings of Metavision"));
    EXPECT_THAT(refusal("{"), HasSubstr("expected JSON: "));
    EXPECT_THAT(failure_of([&] { settings_of("[1]"); }), HasSubstr("ll_biases_state.bias"));
}

TEST_F(BiasFile, StandsBesideOtherSettings) {
    write("5 % bias_fo\n");
    const auto both = write(
        "encoding = \"evt3\"\nbiases = \"sensor.bias\"\n[controls]\n"
        "bias_refr = 7\n",
        "both.toml");
    const V4l2Settings settings = load_v4l2_settings(both);
    EXPECT_EQ(settings.encoding, EvtEncoding::evt3);
    EXPECT_EQ(settings.controls.at("bias_fo"), 5);
    EXPECT_EQ(settings.controls.at("bias_refr"), 7);
    const auto twice = write("biases = \"sensor.bias\"\n[controls]\nbias_fo = 7\n", "twice.toml");
    EXPECT_THAT(failure_of([&] { load_v4l2_settings(twice); }),
                testing::AllOf(HasSubstr("sensor.bias:1: 'bias_fo' is also in"),
                               HasSubstr("twice.toml:3")));
}

TEST(V4l2Camera, SaysWhyItCannotBeUsed) {
    EXPECT_THAT(failure_of([] { open(); }), HasSubstr("is the driver loaded"));
    V4l2NodeSettings output;
    output.output = true;
    V4l2Testbed bed{output};
    EXPECT_THAT(failure_of([] { open(); }), HasSubstr("does not capture"));
}

TEST(V4l2Settings, ShippedFileReadsAndUnknownKeysAreRefused) {
    const auto shipped = load_v4l2_settings(std::filesystem::path{EVENTIDE_SOURCE_DIR} /
                                            "config/cameras/v4l2-imx636.toml");
    EXPECT_EQ(shipped.encoding, EvtEncoding::evt3);
    EXPECT_EQ(shipped.width, 1280);
    const auto file = std::filesystem::path{testing::TempDir()} / "v4l2.toml";
    std::ofstream{file} << "size = [1280, 720]\nencodng = \"evt3\"\n";
    EXPECT_THAT(failure_of([&] { load_v4l2_settings(file); }),
                HasSubstr("v4l2.toml:2: unknown key 'encodng'"));
}

}  // namespace
}  // namespace eventide

int main(int argc, char** argv) {
    eventide::testing_support::enter_testbed(argv);
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
