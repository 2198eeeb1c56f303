// A DAVIS that is pulled out, at every moment there is, and put in again.
#include "tests/drivers/davis_streams.h"
#include "tests/drivers/usb_sessions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <tuple>
#include <utility>

namespace eventide::test {
namespace {

using testing::AnyOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::DavisModel;
using testing_support::DavisModelSettings;
using testing_support::UsbTestbed;

TEST(DavisUnplugged, IsAnErrorThatNamesTheWayOut) {
    PluggedIn camera_side;
    DavisCamera camera{at_once()};
    RawPacket packet;
    ASSERT_EQ(camera.read(packet), ReadStatus::data);
    camera_side.bed.unplug();
    EXPECT_THAT(failure_of([&] {
                    while (camera.read(packet) != ReadStatus::end) continue;
                }),
                HasSubstr("--reconnect"));
}

TEST(DavisUnplugged, ACameraThatIsStoppedBeforeItBeginsAgainHasNotComeBack) {
    UsbTestbed bed;
    bed.plug_in(camera_before(1000));
    DavisCamera camera{small_transfers(true)};
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    bed.unplug();
    while (camera.read(packet) != ReadStatus::timeout) continue;
    DavisModelSettings settings;
    settings.now = [&camera] {  // asked first where the driver starts time
        camera.stop();
        return SensorTime{};
    };
    bed.plug_in(std::make_shared<DavisModel>(settings));
    while (camera.read(packet) != ReadStatus::end) continue;
    EXPECT_EQ(camera.counters()[CameraCount::reconnects], 0U);
}

/// Opens, starts, streams to the scene's end, stops; the words of the error, or nothing.
std::string session(UsbTestbed& bed, const DavisModel& model) {
    return test::end_of_session<DavisCamera>(
        small_transfers(false), [&](DavisCamera& camera) { stream(camera, bed, model); });
}

/// Of the two hundred requests of a session, so many are not tried: each takes a session of its
/// own.
constexpr int kStride = 5;

TEST(DavisUnplugged, AtAnyMomentItEndsWithTheRightWordsAndLeaksNothing) {
    UsbTestbed bed;
    auto model = camera_before(3'000);
    bed.plug_in(model);
    ASSERT_EQ(session(bed, *model), "");
    const int all = bed.requests();
    bed.unplug();
    std::optional<Holdings> first;
    int ended_well = 0;
    for (int request = 0; request <= all; request += kStride) {
        model = camera_before(3'000);
        bed.plug_in(model);
        bed.unplug_after(request);
        const std::string words = session(bed, *model);
        bed.unplug();
        if (words.empty())
            ++ended_well;  // while stopping: nobody needs to know
        else
            EXPECT_THAT(words, AnyOf(HasSubstr("unplugged"), HasSubstr("no camera")))
                << "at request " << request << " of " << all;
        if (!first) first = holdings();
    }
    EXPECT_GT(ended_well, 1) << "the sweep never reached the stop";
    const Holdings last = holdings_down_to(*first);
    EXPECT_LE(last.files, first->files);
    EXPECT_EQ(last.threads, first->threads);
}

TEST(DavisUnplugged, AtAnyMomentAfterOpeningItComesBackWhenToldToWait) {
    constexpr int kStartAndSomeTransfers = 40;
    UsbTestbed bed;
    RawPacket packet;
    const auto read_until = [&](DavisCamera& camera, ReadStatus wanted) {
        while (camera.read(packet) != wanted) continue;
    };
    for (int request = 0; request < kStartAndSomeTransfers; request += kStride - 1) {
        bed.plug_in(camera_before(3'000));
        DavisCamera camera{small_transfers(true)};
        bed.unplug_after(request);
        read_until(camera, ReadStatus::timeout);
        bed.unplug();
        read_until(camera, ReadStatus::timeout);
        bed.plug_in(camera_before(3'000));
        read_until(camera, ReadStatus::data);
        EXPECT_TRUE(packet.gap_before) << "at request " << request;
        EXPECT_EQ(camera.counters()[CameraCount::reconnects], 1U);
        bed.unplug();
    }
}

TEST(DavisUnplugged, AHundredTimesItComesBackMarksTheGapAndLeaksNothing) {
    UsbTestbed bed;
    DavisOptions options = at_once();
    options.reconnect = true;
    std::optional<DavisCamera> camera;
    std::optional<Holdings> early;
    constexpr int kTimes = 100, kSettled = 10;
    for (int time = 0; time < kTimes; ++time) {
        bed.plug_in(camera_before(2'000));
        if (!camera) camera.emplace(options);
        RawPacket packet;
        while (camera->read(packet) != ReadStatus::data) continue;
        EXPECT_EQ(packet.gap_before, time > 0);
        bed.unplug();
        while (camera->read(packet) != ReadStatus::timeout) continue;
        if (time == kSettled) early = holdings();
    }
    const Holdings late = holdings_down_to(*early);
    EXPECT_EQ(camera->counters()[CameraCount::reconnects], unsigned(kTimes - 1));
    EXPECT_LE(late.files, early->files);
    EXPECT_EQ(late.threads, early->threads);
    // A leak of one transfer's buffer in each cycle would be 6 MB.
    EXPECT_LT(double(late.bytes) - double(early->bytes), 1e6);
}

TEST(DavisUnplugged, TheFirstLookAfterItIsBackOpensItAndNothingWaitsForASecond) {
    UsbTestbed bed;
    bed.plug_in(camera_before(2'000));
    DavisCamera camera{small_transfers(true)};
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    bed.unplug();
    while (camera.read(packet) != ReadStatus::timeout) continue;
    for (int look = 0; look < 5; ++look) ASSERT_EQ(camera.read(packet), ReadStatus::timeout);
    bed.plug_in(camera_before(2'000));
    ASSERT_EQ(camera.read(packet), ReadStatus::timeout);
    EXPECT_EQ(camera.counters()[CameraCount::reconnects], 1U);
    EXPECT_EQ(camera.read(packet), ReadStatus::data);
    // What a real camera needs between the steps of that look is the only waiting in it.
    const UsbWaits waits;
    EXPECT_LT(waits.idle + waits.biases_settle + waits.flow_settles, std::chrono::seconds{1});
}

}  // namespace
}  // namespace eventide::test
