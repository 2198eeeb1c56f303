// Which camera is taken for the DAVIS that was pulled out, and what is told until it is back.
#include "tests/drivers/davis_streams.h"
#include "tests/drivers/usb_sessions.h"
#include "tests/support/keep_in.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace eventide::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::DavisModel;
using testing_support::DavisModelSettings;
using testing_support::UsbTestbed;

TEST(DavisReturn, OnlyTheSameCameraIsTakenBack) {
    UsbTestbed bed;
    bed.plug_in(camera_before(2'000));
    DavisOptions options = at_once();
    options.reconnect = true;
    DavisCamera camera{options};
    RawPacket packet;
    test::unplug_while_sending(camera, bed);
    DavisModelSettings other;
    other.serial = "00000007";
    bed.plug_in(std::make_shared<DavisModel>(other));
    for (int i = 0; i < 5; ++i) EXPECT_EQ(camera.read(packet), ReadStatus::timeout);
    EXPECT_EQ(camera.counters()[CameraCount::reconnects], 0U);
    camera.stop();
    EXPECT_EQ(camera.read(packet), ReadStatus::end);
}

TEST(DavisReturn, WhyItIsNotBackIsToldOnce) {
    UsbTestbed bed;
    bed.plug_in(camera_before(2'000));
    DavisOptions options = small_transfers(true);
    std::vector<std::string> warnings;
    options.warn = keep_in(warnings);
    DavisCamera camera{options};
    RawPacket packet;
    const auto look = [&] {
        for (int i = 0; i < 5; ++i) EXPECT_EQ(camera.read(packet), ReadStatus::timeout);
    };
    test::unplug_while_sending(camera, bed);
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
    test::unplug_while_sending(camera, bed);
    look();
    ASSERT_EQ(warnings.size(), 4U);
    EXPECT_EQ(warnings[3], warnings[0]) << "it is gone once more";
}

TEST(DavisReturn, WithASerialNumberItIsTakenBackAtAnyPortHoweverItWasNamed) {
    for (const bool by_place : {false, true}) {
        UsbTestbed bed;
        bed.plug_in(camera_before(2'000), {.port = 2, .address = 5});
        DavisOptions options = small_transfers(true);
        if (by_place) std::tie(options.bus, options.address) = std::pair{1, 5};
        DavisCamera camera{options};
        RawPacket packet;
        test::unplug_while_sending(camera, bed);
        bed.plug_in(camera_before(2'000), {.port = 3, .address = 6});
        for (int look = 0; look < 5 && packet.bytes.empty(); ++look) camera.read(packet);
        EXPECT_TRUE(packet.gap_before) << by_place;
        EXPECT_EQ(camera.counters()[CameraCount::reconnects], 1U) << by_place;
    }
}

TEST(DavisReturn, WithoutASerialNumberItIsTakenBackAtItsPort) {
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
    options.warn = keep_in(warnings);
    DavisCamera camera{options};
    EXPECT_EQ(camera.info().serial, "TMP00261") << "bus 1, address 5";
    RawPacket packet;
    test::unplug_while_sending(camera, bed);
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

TEST(DavisReturn, OneThatIsThereButStallsAgainAndAgainIsOpenedAgain) {
    UsbTestbed bed;
    const auto model = camera_before(20'000);
    bed.plug_in(model);
    std::vector<std::string> warnings;
    DavisOptions options = small_transfers(true);
    options.warn = keep_in(warnings);
    DavisCamera camera{options};
    RawPacket packet;
    ASSERT_EQ(camera.read(packet), ReadStatus::data);
    bed.halt_data(1000);
    while (warnings.empty()) camera.read(packet);
    EXPECT_TRUE(packet.bytes.empty());
    bed.look([&] { EXPECT_FALSE(model->is_streaming()) << "it was stopped"; });
    for (int look = 0; look < 3; ++look) EXPECT_EQ(camera.read(packet), ReadStatus::timeout);
    EXPECT_THAT(warnings, ElementsAre(HasSubstr("stalls again each time")));
    EXPECT_EQ(camera.counters()[CameraCount::reconnects], 0U);
    bed.halt_data(0);
    while (camera.read(packet) != ReadStatus::data) continue;
    EXPECT_TRUE(packet.gap_before);
    EXPECT_TRUE(packet.reopened);
    EXPECT_EQ(camera.counters()[CameraCount::reconnects], 1U);
}

/// All of them DAVIS346B of 346x260 px.
TEST(DavisReturn, OneWithoutASerialNumberThatSpeaksOtherwiseIsNotTakenForIt) {
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
        options.warn = keep_in(warnings);
        DavisCamera camera{options};
        RawPacket packet;
        test::unplug_while_sending(camera, bed);
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
