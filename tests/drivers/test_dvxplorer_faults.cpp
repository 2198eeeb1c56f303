// What a DVXplorer or its cable does wrong, and what the user is told.
#include "tests/drivers/dvxplorer_boards.h"
#include "tests/support/keep_in.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <memory>
#include <string>
#include <vector>

namespace eventide::test::dvxplorer {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing_support::DvxplorerModelSettings;

TEST(DvxplorerFaults, AMiniWhoseMessagesFailStillGivesItsEvents) {
    DvxplorerModelSettings settings;
    settings.mini = true;
    for (const int error : {EPROTO, EPIPE}) {
        PluggedIn side{settings};
        side.bed.fail_messages(error);
        DvxplorerCamera camera{at_once()};
        const Batch got = stream_scene(camera, side.bed, *side.model);
        EXPECT_EQ(got.events, side.seen.events) << error;
        EXPECT_TRUE(got.imu.empty());
    }
}

TEST(DvxplorerFaults, SaysWhatToDoWhenItCannotStart) {
    const auto with = [](auto change) {
        DvxplorerModelSettings settings;
        change(settings);
        const PluggedIn side{settings, 1};
        return error_of([] { DvxplorerCamera{at_once()}; }, ErrorKind::device);
    };
    EXPECT_THAT(with([](auto& s) { s.firmware = 7; }), HasSubstr("firmware 7, at least 8"));
    EXPECT_THAT(with([](auto& s) {
                    s.mini = true;
                    s.firmware = 10;
                }),
                HasSubstr("has firmware 10, iniVation's second generation"));
    EXPECT_THAT(with([](auto& s) { s.logic = 17; }), HasSubstr("logic version 17"));
    EXPECT_THAT(with([](auto& s) { s.patch = 1; }),
                HasSubstr("FPGA logic version 18 patch 1, expected 18 patch 2"));
    EXPECT_THAT(with([](auto& s) { s.board_type = 5; }), HasSubstr("second-generation"));
    EXPECT_THAT(with([](auto& s) { s.sensor.width = 0; }), HasSubstr("a side of 0 px"));
    EXPECT_THAT(with([](auto& s) { s.sensor.width = 1025; }), HasSubstr("a side of 1025 px"));
}

TEST(DvxplorerFaults, ASettingThatTheCameraDoesNotTakeIsNamed) {
    DvxplorerModelSettings settings;
    settings.deaf = davis::Register{davis::chip, 0x001E};
    const PluggedIn side{settings, 1};
    EXPECT_THAT(error_of([] { DvxplorerCamera{at_once()}; }, ErrorKind::device),
                HasSubstr("register CHIP.30 was set to 8 and says 0"));
    DvxplorerOptions trusting = at_once();
    trusting.settings.verify = false;
    EXPECT_EQ(DvxplorerCamera{trusting}.info().name, "DVXplorer");
}

TEST(DvxplorerFaults, ACameraThatCannotBeOpenedIsLeftWithoutPower) {
    DvxplorerModelSettings deaf, without_columns;
    deaf.deaf = davis::Register{davis::chip, 0x001E};
    without_columns.sensor.width = 0;
    for (const auto& settings : {deaf, without_columns}) {
        const PluggedIn side{settings, 1};
        EXPECT_THROW(DvxplorerCamera{at_once()}, Error);
        const auto& writes = side.model->writes();
        ASSERT_FALSE(writes.empty());
        EXPECT_EQ(writes.front(), (davis::Write{davis::kRunChip, 1}));
        EXPECT_EQ(writes.back(), (davis::Write{davis::kRunChip, 0}));
    }
}

TEST(DvxplorerFaults, CountsWhatTheCameraItselfDropped) {
    PluggedIn side;
    constexpr davis::Register kLow{davis::mux, 84};
    side.model->write({kLow, 1000});  // before it was started
    DvxplorerCamera camera{at_once()};
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    side.bed.look([&] { side.model->write({kLow, 1007}); });
    camera.stop();
    EXPECT_EQ(camera.read(packet), ReadStatus::end);
    EXPECT_EQ(camera.counters()[CameraCount::dropped_events], 7U);
}

/// Opens, starts, streams to the scene's end, stops; the words of the error, or nothing.
std::string session(PluggedIn& side) {
    return end_of_session<DvxplorerCamera>(
        at_once(), [&](DvxplorerCamera& camera) { stream_scene(camera, side.bed, *side.model); });
}

TEST(DvxplorerFaults, UnpluggedAtAnyMomentItEndsWithTheRightWords) {
    constexpr int kStride = 7;
    PluggedIn whole{{}, 20};
    ASSERT_EQ(session(whole), "");
    const int all = whole.bed.requests();
    int ended_well = 0;
    for (int request = 0; request <= all; request += kStride) {
        PluggedIn side{{}, 20};
        side.bed.unplug_after(request);
        const std::string words = session(side);
        if (words.empty())
            ++ended_well;  // while stopping: nobody needs to know
        else
            EXPECT_THAT(words, AnyOf(HasSubstr("unplugged"), HasSubstr("no DVXplorer found")))
                << "at request " << request << " of " << all;
    }
    EXPECT_GT(ended_well, 0) << "the sweep never reached the stop";
}

TEST(DvxplorerFaults, UnpluggedItComesBackBehindAGap) {
    for (const bool mini : {false, true}) {
        DvxplorerModelSettings settings;
        settings.mini = mini;
        PluggedIn side{settings};
        DvxplorerOptions options = at_once();
        options.reconnect = true;
        DvxplorerCamera camera{options};
        expect_return_behind_a_gap(camera, side.bed, side.model);
    }
}

TEST(DvxplorerFaults, ACameraThatComesBackAndStaysSilentIsLeftWithoutPower) {
    DvxplorerModelSettings settings;
    PluggedIn side{settings};
    DvxplorerOptions options = at_once();
    options.reconnect = true;
    std::vector<std::string> warnings;
    options.warn = keep_in(warnings);
    DvxplorerCamera camera{options};
    RawPacket packet;
    unplug_while_sending(camera, side.bed);
    settings.deaf = davis::kUsbRun;
    const auto silent = std::make_shared<testing_support::DvxplorerModel>(settings);
    side.bed.plug_in(silent);
    while (warnings.empty()) camera.read(packet);
    EXPECT_THAT(warnings.back(), HasSubstr("no data came within a second"));
    side.bed.look([&] { EXPECT_EQ(silent->writes().back(), (davis::Write{davis::kRunChip, 0})); });
}

TEST(DvxplorerFaults, OneWithoutASerialNumberOfAnotherOrientationIsNotTakenForIt) {
    DvxplorerModelSettings settings;
    settings.serial = "";
    PluggedIn side{settings};
    std::vector<std::string> warnings;
    DvxplorerOptions options = at_once();
    options.reconnect = true;
    options.warn = keep_in(warnings);
    DvxplorerCamera camera{options};
    RawPacket packet;
    unplug_while_sending(camera, side.bed);
    settings.sensor.swapped = true;
    side.bed.plug_in(std::make_shared<testing_support::DvxplorerModel>(settings));
    for (int i = 0; i < 5; ++i) EXPECT_EQ(camera.read(packet), ReadStatus::timeout);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_THAT(warnings[0], HasSubstr("is a DVXplorer of 640x480 px, found one with another "
                                       "orientation"));
    EXPECT_EQ(camera.counters()[CameraCount::reconnects], 0U);
}

TEST(DvxplorerFaults, UnpluggedWithoutReconnectIsAnErrorThatNamesTheWayOut) {
    PluggedIn side;
    DvxplorerCamera camera{at_once()};
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    side.bed.unplug();
    EXPECT_THAT(error_of(
                    [&] {
                        while (camera.read(packet) != ReadStatus::end) continue;
                    },
                    ErrorKind::device),
                HasSubstr("the DVXplorer 'DVX00001' was unplugged; --reconnect"));
}

}  // namespace
}  // namespace eventide::test::dvxplorer
