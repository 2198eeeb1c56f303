// The order in which a DVXplorer is started and stopped: as libcaer and dv-processing do it.
#include "tests/drivers/dvxplorer_boards.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace eventide::test::dvxplorer {
namespace {

using testing_support::DvxplorerModelSettings;

/// What was written between the settings and the end.
std::vector<davis::Write> session_of(DvxplorerModelSettings settings) {
    PluggedIn side{settings, 1};
    std::size_t configured = 0;
    {
        DvxplorerCamera camera{at_once()};
        side.bed.look([&] { configured = side.model->writes().size(); });
        RawPacket packet;
        while (camera.read(packet) != ReadStatus::data) continue;
    }
    const auto& writes = side.model->writes();
    return {writes.begin() + std::ptrdiff_t(configured), writes.end()};
}

constexpr davis::Register chip(int address) {
    return {davis::chip, std::uint16_t(address)};
}

TEST(DvxplorerSession, StartsAndStopsAsTheRedBoardExpects) {
    using namespace davis;
    // libcaer's dvXplorerDataStart, with the chip's mode off before it (its DataStop).
    const std::vector<Write> idle{{chip(0x3000), 0},
                                  {kDvsRun, 0},
                                  {kImuRunAccel, 0},
                                  {kImuRunGyro, 0},
                                  {kImuRunTemperature, 0},
                                  {kExtRun, 0},
                                  {kRun, 0},
                                  {kTimestampRun, 0},
                                  {kUsbRun, 0}};
    std::vector<Write> expected = idle;
    for (const Write w : {Write{kUsbRun, 1},
                          {kTimestampRun, 1},
                          {kRun, 1},  // the way to the host; 50 ms
                          {kDvsRun, 1},
                          {kImuRunAccel, 1},
                          {kImuRunGyro, 1},
                          {kImuRunTemperature, 1},
                          {kExtRun, 1},  // what makes data
                          {chip(0x3238), 1},
                          {chip(0x3238), 0},  // the chip's own clock
                          {chip(0x3000), 2},  // stream mode
                          {kTimestampReset, 1},
                          {kTimestampReset, 0}})  // dv-processing's handshake
        expected.push_back(w);
    expected.insert(expected.end(), idle.begin(), idle.end());
    expected.push_back({kRunChip, 0});  // libcaer's dvXplorerClose: the chip back into reset
    EXPECT_EQ(session_of({}), expected);
}

/// A Mini does this itself.
TEST(DvxplorerSession, TheRedBoardsChipIsPoweredAndSetBeforeAnythingElse) {
    std::vector<davis::Write> expected{{davis::kRunChip, 1}};
    for (const davis::Write& write : chip_writes()) expected.push_back(write);
    PluggedIn red{{}, 1};
    const DvxplorerCamera camera{at_once()};
    const auto& writes = red.model->writes();
    ASSERT_GE(writes.size(), expected.size());
    EXPECT_TRUE(std::equal(expected.begin(), expected.end(), writes.begin()));
}

TEST(DvxplorerSession, StartsAndStopsAsAMiniExpects) {
    using namespace davis;
    // The same without multiplexer, external input and USB module, which it has not got.
    const std::vector<Write> idle{{chip(0x3000), 0},
                                  {kDvsRun, 0},
                                  {kImuRunAccel, 0},
                                  {kImuRunGyro, 0},
                                  {kImuRunTemperature, 0}};
    std::vector<Write> expected = idle;
    for (const Write w : {Write{kDvsRun, 1},
                          {kImuRunAccel, 1},
                          {kImuRunGyro, 1},
                          {kImuRunTemperature, 1},
                          {chip(0x3238), 1},
                          {chip(0x3238), 0},
                          {chip(0x3000), 2}})
        expected.push_back(w);
    expected.insert(expected.end(), idle.begin(), idle.end());
    EXPECT_EQ(session_of(boards()[3]), expected);
}

}  // namespace
}  // namespace eventide::test::dvxplorer
