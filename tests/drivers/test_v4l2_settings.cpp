// Settings of V4L2 sensors: our own files, and the biases of the vendor's.
#include "tests/drivers/v4l2_sensor.h"
#include "tests/support/v4l2/v4l2_testbed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace eventide {
namespace {

using testing::HasSubstr;
using testing_support::V4l2NodeSettings;
using testing_support::V4l2Testbed;
using namespace testing_support::v4l2;

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
    EXPECT_THAT(failure("2147483648 % bias_fo\n"), HasSubstr("sensor.bias:1: expected VALUE"));
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

TEST_F(BiasFile, WhatNoToolWritesIsRefusedInFewWords) {
    const auto refusal = [&](const std::string& text, const char* name) {
        const auto file = write(text, name);
        std::string words = failure_of([&] { load_v4l2_settings(file); });
        EXPECT_THAT(words, HasSubstr(name));
        EXPECT_LT(words.size(), file.string().size() + 300) << "a piece of what was found";
        return words;
    };
    const std::string deep = std::string(200'000, '[') + std::string(200'000, ']');
    EXPECT_THAT(refusal(R"({"ll_biases_state": {"bias": [)" + deep + "]}}", "deep.json"),
                HasSubstr("expected JSON of at most 16 levels, found more"));
    EXPECT_THAT(refusal(R"({"ll_biases_state": {"bias": [")" + std::string(10'000, 'x') + "\"]}}",
                        "long.json"),
                HasSubstr("expected {\"name\""));
    EXPECT_THAT(refusal("[1e999]", "number.json"), HasSubstr("expected JSON: "));
    EXPECT_THAT(refusal(std::string(10'000, '7'), "line.bias"), HasSubstr(":1: expected VALUE"));
    EXPECT_THAT(refusal("1 % " + std::string(10'000, 'x') + "\n2 % " + std::string(10'000, 'x'),
                        "name.bias"),
                HasSubstr(":1: expected a name of at most 100 characters"));
    for (const char* name : {"large.bias", "large.json"})
        EXPECT_THAT(refusal(std::string((1 << 20) + 1, ' '), name),
                    HasSubstr("expected at most 1 MiB of text, found more"));
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

TEST(V4l2Settings, ShippedFileReadsAndUnknownKeysAreRefused) {
    const auto shipped = load_v4l2_settings(std::filesystem::path{EVENTIDE_SOURCE_DIR} /
                                            "config/cameras/v4l2-imx636.toml");
    EXPECT_EQ(shipped.encoding, EvtEncoding::evt3);
    EXPECT_EQ(shipped.width, 1280);
    const auto file = std::filesystem::path{testing::TempDir()} / "v4l2.toml";
    std::ofstream{file} << "size = [1280, 720]\nencodng = \"evt3\"\n";
    EXPECT_THAT(failure_of([&] { load_v4l2_settings(file); }),
                HasSubstr("v4l2.toml:2: unknown key 'encodng'; did you mean encoding?"));
}

TEST(V4l2Settings, WhatIsOutOfRangeIsRefused) {
    const auto refusal = [](const std::string& line) {
        const auto file = std::filesystem::path{testing::TempDir()} / "v4l2.toml";
        std::ofstream{file} << line << "\n";
        return failure_of([&] { load_v4l2_settings(file); });
    };
    EXPECT_EQ(refusal("buffers = 2"), "nothing was thrown");
    EXPECT_THAT(refusal("buffers = 1"), HasSubstr("from 2 to 256"));
    EXPECT_THAT(refusal("buffers = 257"), HasSubstr("from 2 to 256"));
    EXPECT_THAT(refusal("size = [640]"), HasSubstr("expected [width, height]"));
    EXPECT_THAT(refusal("size = [640, 480, 3]"), HasSubstr("expected [width, height]"));
    EXPECT_THAT(refusal("size = [640, 0]"), HasSubstr("found 0"));
}

}  // namespace
}  // namespace eventide
