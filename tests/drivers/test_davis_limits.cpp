// What a DAVIS itself can leave out, as settings and as registers.
#include "drivers/usb/davis_settings.h"
#include "tests/drivers/usb_sessions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

namespace eventide::test {
namespace {

using namespace davis;
using testing::HasSubstr;

std::map<Register, std::uint32_t> registers_of(const DavisSettings& settings,
                                               const DavisFeatures& features = {}) {
    std::map<Register, std::uint32_t> registers;
    for (const Write& write : configuration(settings, DavisSensor{}, features))
        registers[write.at] = write.value;
    return registers;
}

TEST(DavisLimits, AreReadFromTheFileAndWrittenToTheFilters) {
    const DavisSettings settings = load_davis_settings(written(R"(
refractory_us = 1000
activity_time_us = 500
roi = [10, 20, 100, 50]
frame_roi = [0, 0, 64, 32]
polarity = "off"
hot_pixels = [[3, 4], [345, 259]]
skip_every = 3
)"));
    const auto registers = registers_of(settings);
    EXPECT_EQ(registers.at(kDvsRefractory), 1U);
    EXPECT_EQ(registers.at(kDvsRefractoryTime), 4U);  // x 250 us
    EXPECT_EQ(registers.at(kDvsActivityTime), 2U);
    EXPECT_EQ(registers.at(kDvsRoiStartColumn), 10U);
    EXPECT_EQ(registers.at(kDvsRoiEndColumn), 109U);
    EXPECT_EQ(registers.at(kDvsRoiEndRow), 69U);
    EXPECT_EQ(registers.at(kApsEndColumn), 63U);
    EXPECT_EQ(registers.at(kApsEndRow), 31U);
    EXPECT_EQ(registers.at(kDvsPolaritySuppress), 1U);
    EXPECT_EQ(registers.at(kDvsPolarityWhich), 1U);  // ON is left out
    EXPECT_EQ(registers.at(kDvsSkip), 1U);
    EXPECT_EQ(registers.at(kDvsSkipEvery), 3U);
    EXPECT_EQ(registers.at({dvs, 11}), 4U);  // row, column of the first
    EXPECT_EQ(registers.at({dvs, 12}), 3U);
    EXPECT_EQ(registers.at({dvs, 14}), 345U);
    EXPECT_EQ(registers.at({dvs, 15}), 260U) << "the third is off";
}

TEST(DavisLimits, AreOffByDefaultButForTheActivityFilter) {
    const auto registers = registers_of({});
    for (const Register at : {kDvsRefractory, kDvsSkip, kDvsPolaritySuppress, kDvsPolarityFlatten})
        EXPECT_EQ(registers.at(at), 0U);
    EXPECT_EQ(registers.at(kDvsActivityFilter), 1U);
    EXPECT_EQ(registers.at(kExtPulseLength), 900U) << "10 us of a logic at 90 MHz";
}

TEST(DavisLimits, ThatTheLogicOrTheSensorDoesNotHaveAreRefused) {
    const auto refusal = [](auto change, const DavisFeatures& features = {}) {
        DavisSettings settings;
        change(settings);
        return error_of([&] { registers_of(settings, features); }, ErrorKind::usage);
    };
    EXPECT_THAT(refusal([](auto& s) {
                    s.roi = SensorRegion{300, 0, 47, 10};
                }),
                HasSubstr("roi reaches to 347,10, this sensor has 346x260"));
    EXPECT_THAT(refusal([](auto& s) { s.hot_pixels = {{0, 260}}; }), HasSubstr("hot_pixels"));
    DavisFeatures plain;
    plain.skip = plain.activity_filter = false;
    EXPECT_THAT(refusal([](auto& s) { s.skip_every = 2; }, plain),
                HasSubstr("skip_every: this camera's logic was built without it"));
    EXPECT_THAT(refusal([](auto& s) { s.refractory_us = 500; }, plain), HasSubstr("refractory_us"));
}

}  // namespace
}  // namespace eventide::test
