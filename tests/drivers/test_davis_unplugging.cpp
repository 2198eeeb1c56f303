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

std::shared_ptr<DavisModel> camera_before(int events) {
    const auto model = std::make_shared<DavisModel>(DavisModelSettings{});
    model->show(davis_scene(model->settings().sensor, {.events = events}));
    return model;
}

DavisOptions small_transfers(bool reconnect) {
    DavisOptions options = at_once();
    options.settings.transfers = {4, 8 << 10};
    options.reconnect = reconnect;
    return options;
}

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
    try {
        DavisCamera camera{small_transfers(false)};
        stream(camera, bed, model);
        camera.stop();
        RawPacket packet;
        camera.read(packet);
        return "";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::device);
        return error.what();
    }
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

TEST(DavisUnplugged, OnlyTheSameCameraIsTakenBack) {
    UsbTestbed bed;
    bed.plug_in(camera_before(2'000));
    DavisOptions options = at_once();
    options.reconnect = true;
    DavisCamera camera{options};
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    bed.unplug();
    while (camera.read(packet) != ReadStatus::timeout) continue;
    DavisModelSettings other;
    other.serial = "00000007";
    bed.plug_in(std::make_shared<DavisModel>(other));
    for (int i = 0; i < 5; ++i) EXPECT_EQ(camera.read(packet), ReadStatus::timeout);
    EXPECT_EQ(camera.counters()[CameraCount::reconnects], 0U);
    camera.stop();
    EXPECT_EQ(camera.read(packet), ReadStatus::end);
}

TEST(DavisUnplugged, WhyItIsNotBackIsToldOnce) {
    UsbTestbed bed;
    bed.plug_in(camera_before(2'000));
    DavisOptions options = small_transfers(true);
    std::vector<std::string> warnings;
    options.warn = [&](const std::string& text) { warnings.push_back(text); };
    DavisCamera camera{options};
    RawPacket packet;
    const auto look = [&] {
        for (int i = 0; i < 5; ++i) EXPECT_EQ(camera.read(packet), ReadStatus::timeout);
    };
    while (camera.read(packet) != ReadStatus::data) continue;
    bed.unplug();
    while (camera.read(packet) != ReadStatus::timeout) continue;
    look();
    EXPECT_THAT(warnings, ElementsAre(HasSubstr("no DAVIS with serial '00000042' found")));
    DavisModelSettings other;
    other.logic = 16;
    bed.plug_in(std::make_shared<DavisModel>(other));
    look();
    ASSERT_EQ(warnings.size(), 2U);
    EXPECT_THAT(warnings[1], HasSubstr("has FPGA logic version 16"));
    bed.unplug();
    look();
    EXPECT_EQ(warnings.size(), 2U) << "that was told";
    other = {};
    other.sensor = testing_support::davis240();
    bed.plug_in(std::make_shared<DavisModel>(other));
    look();
    ASSERT_EQ(warnings.size(), 3U);
    EXPECT_THAT(warnings[2],
                HasSubstr("is a DAVIS346B of 346x260 px, found a DAVIS240C of 240x180"));
    bed.unplug();
    bed.plug_in(camera_before(2'000));
    while (camera.read(packet) != ReadStatus::data) continue;
    bed.unplug();
    while (camera.read(packet) != ReadStatus::timeout) continue;
    look();
    ASSERT_EQ(warnings.size(), 4U);
    EXPECT_EQ(warnings[3], warnings[0]) << "it is gone once more";
}

TEST(DavisUnplugged, WithASerialNumberItIsTakenBackAtAnyPortHoweverItWasNamed) {
    for (const bool by_place : {false, true}) {
        UsbTestbed bed;
        bed.plug_in(camera_before(2'000), {.port = 2, .address = 5});
        DavisOptions options = small_transfers(true);
        if (by_place) std::tie(options.bus, options.address) = std::pair{1, 5};
        DavisCamera camera{options};
        RawPacket packet;
        while (camera.read(packet) != ReadStatus::data) continue;
        bed.unplug();
        while (camera.read(packet) != ReadStatus::timeout) continue;
        bed.plug_in(camera_before(2'000), {.port = 3, .address = 6});
        for (int look = 0; look < 5 && packet.bytes.empty(); ++look) camera.read(packet);
        EXPECT_TRUE(packet.gap_before) << by_place;
        EXPECT_EQ(camera.counters()[CameraCount::reconnects], 1U) << by_place;
    }
}

TEST(DavisUnplugged, WithoutASerialNumberItIsTakenBackAtItsPort) {
    UsbTestbed bed;
    DavisModelSettings settings;
    settings.serial = "";
    const auto plug_in = [&](testing_support::UsbPlace place) {
        const auto model = std::make_shared<DavisModel>(settings);
        model->show(davis_scene(settings.sensor, {.events = 2'000}));
        bed.plug_in(model, place);
    };
    plug_in({.port = 2, .address = 5});
    std::vector<std::string> warnings;
    DavisOptions options = small_transfers(true);
    options.warn = [&](const std::string& text) { warnings.push_back(text); };
    DavisCamera camera{options};
    EXPECT_EQ(camera.info().serial, "TMP00261") << "bus 1, address 5";
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    bed.unplug();
    while (camera.read(packet) != ReadStatus::timeout) continue;
    plug_in({.port = 3, .address = 6});
    for (int i = 0; i < 5; ++i) EXPECT_EQ(camera.read(packet), ReadStatus::timeout);
    EXPECT_EQ(camera.counters()[CameraCount::reconnects], 0U);
    bed.unplug();
    const DavisSensor sensor = std::exchange(settings.sensor, testing_support::davis240());
    plug_in({.port = 2, .address = 7});
    for (int i = 0; i < 5; ++i) EXPECT_EQ(camera.read(packet), ReadStatus::timeout);
    ASSERT_EQ(warnings.size(), 2U);
    EXPECT_THAT(warnings[1],
                HasSubstr("is a DAVIS346B of 346x260 px, found a DAVIS240C of 240x180"))
        << "another camera at its port";
    bed.unplug();
    settings.sensor = sensor;
    plug_in({.port = 2, .address = 8});
    while (camera.read(packet) != ReadStatus::data) continue;
    EXPECT_TRUE(packet.gap_before);
    EXPECT_EQ(camera.counters()[CameraCount::reconnects], 1U);
}

/// All of them DAVIS346B of 346x260 px.
TEST(DavisUnplugged, OneWithoutASerialNumberThatSpeaksOtherwiseIsNotTakenForIt) {
    using Change = std::pair<const char*, void (*)(DavisSensor&)>;
    for (const auto& [what, change] :
         {Change{"orientation",
                 [](DavisSensor& s) {
                     std::swap(s.dvs_columns, s.dvs_rows);
                     s.dvs_swapped = false;
                 }},
          {"orientation of images", [](DavisSensor& s) { s.aps_flip_x = true; }},
          {"colour filter", [](DavisSensor& s) { s.colour_filter = ColourFilter::rggb; }},
          {"IMU", [](DavisSensor& s) { s.imu_flip_z = true; }}}) {
        UsbTestbed bed;
        DavisModelSettings settings;
        settings.serial = "";
        const auto plug_in = [&] {
            const auto model = std::make_shared<DavisModel>(settings);
            model->show(davis_scene(settings.sensor, {.events = 2'000}));
            bed.plug_in(model);
            return model;
        };
        plug_in();
        std::vector<std::string> warnings;
        DavisOptions options = small_transfers(true);
        options.warn = [&](const std::string& text) { warnings.push_back(text); };
        DavisCamera camera{options};
        RawPacket packet;
        while (camera.read(packet) != ReadStatus::data) continue;
        bed.unplug();
        while (camera.read(packet) != ReadStatus::timeout) continue;
        const DavisSensor sensor = settings.sensor;
        change(settings.sensor);
        const auto other = plug_in();
        for (int i = 0; i < 5; ++i) EXPECT_EQ(camera.read(packet), ReadStatus::timeout) << what;
        ASSERT_EQ(warnings.size(), 1U) << what;
        EXPECT_THAT(warnings[0],
                    HasSubstr("is a DAVIS346B of 346x260 px, found one with another orientation, "
                              "colour filter or IMU in its place"));
        EXPECT_TRUE(other->writes().empty()) << "nothing of it was set";
        bed.unplug();
        settings.sensor = sensor;
        plug_in();
        while (camera.read(packet) != ReadStatus::data) continue;
        EXPECT_TRUE(packet.reopened) << what;
    }
}

}  // namespace
}  // namespace eventide::test
