// Whatever a DAVIS or its cable does wrong: what can be saved is saved, the rest is counted by
// reason, and what cannot go on says why.
#include "src/core/byte_order.h"
#include "tests/drivers/davis_streams.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace eventide::test {
namespace {

using testing::HasSubstr;
using testing_support::DavisModelSettings;

// docs/protocols.md A.9.
constexpr std::uint16_t kTime = 0x8000, kRow = 0x1000, kOffColumn = 0x2000, kImuByte = 0x5000;
constexpr std::uint16_t kImuStart = 5, kColumnEnd = 13;

using Words = std::vector<std::uint16_t>;

/// A fault in the words of every stretch of the stream.
DavisModelSettings spoiled_by(std::function<void(Words&)> spoil) {
    DavisModelSettings settings;
    settings.spoil = [spoil = std::move(spoil)](std::vector<std::byte>& bytes) {
        Words words(bytes.size() / 2);
        for (std::size_t i = 0; i < words.size(); ++i)
            words[i] = load_little<std::uint16_t>(&bytes[2 * i]);
        spoil(words);
        bytes.clear();
        for (const std::uint16_t w : words) {
            bytes.push_back(std::byte(w & 0xFF));
            bytes.push_back(std::byte(w >> 8));
        }
    };
    return settings;
}

/// Nothing wraps within the scene, so that after a loss the next time word tells the whole time.
constexpr SceneSettings kShortScene{.events = 20'000, .longest_pause_us = 3};

Streamed run(PluggedIn& camera_side, std::size_t transfer_bytes = 8 << 10) {
    DavisOptions options = at_once();
    options.settings.transfers.bytes = transfer_bytes;
    DavisCamera camera{options};
    return stream(camera, camera_side.bed, *camera_side.model);
}

/// `some` is `all` with parts left out.
bool is_part_of(const std::vector<Event>& some, const std::vector<Event>& all) {
    auto at = all.begin();
    for (const Event& event : some) {
        at = std::find(at, all.end(), event);
        if (at == all.end()) return false;
        ++at;
    }
    return true;
}

// ---- words -------------------------------------------------------------------------------------

TEST(DavisFaults, PlacesOutsideTheSensorAreCountedAndLeftOut) {
    std::uint64_t made = 0;
    PluggedIn camera_side{spoiled_by([&](Words& words) {
        const auto row = std::find_if(words.rbegin(), words.rend(),
                                      [](std::uint16_t w) { return (w & 0xF000) == kRow; });
        if (row == words.rend()) return;
        // A column too far right, a row too far down, and back to the row before.
        for (const std::uint16_t w : {std::uint16_t(kOffColumn | 260), std::uint16_t(kRow | 346),
                                      std::uint16_t(kOffColumn | 0), *row})
            words.push_back(w);
        made += 2;
    })};
    const Streamed got = run(camera_side);
    EXPECT_GT(made, 2U);
    EXPECT_EQ(got.damaged[DamageReason::out_of_range], made);
    EXPECT_EQ(got.damaged.total(), made);
    EXPECT_EQ(got.data.events, camera_side.seen.events);
}

TEST(DavisFaults, ATimeSaidTwiceIsNoDamageAndATimeBeforeIsCounted) {
    std::uint64_t steps_back = 0;
    PluggedIn camera_side{spoiled_by([&](Words& words) {
        Words doubled;
        for (const std::uint16_t w : words) {
            doubled.push_back(w);
            if ((w & kTime) != 0) doubled.push_back(w);
        }
        const auto time = std::find_if(words.rbegin(), words.rend(),
                                       [](std::uint16_t w) { return (w & kTime) != 0; });
        if (time != words.rend() && *time > kTime) {
            doubled.push_back(std::uint16_t(*time - 1));
            ++steps_back;
        }
        words = doubled;
    })};
    const Streamed got = run(camera_side);
    EXPECT_GT(steps_back, 1U);
    EXPECT_EQ(got.damaged[DamageReason::time_backwards], steps_back);
    EXPECT_EQ(got.damaged.total(), steps_back);
    EXPECT_EQ(got.data.events, camera_side.seen.events);
}

TEST(DavisFaults, AFrameWithoutAColumnsEndIsLeftOutAndCounted) {
    PluggedIn camera_side{spoiled_by([done = false](Words& words) mutable {
        const auto end = std::find(words.begin(), words.end(), kColumnEnd);
        if (done || end == words.end()) return;
        words.erase(end);
        done = true;
    })};
    const Streamed got = run(camera_side);
    ASSERT_EQ(got.data.images.size(), 2U);
    EXPECT_EQ(got.data.images[0], camera_side.seen.images[1]);
    EXPECT_EQ(got.damaged[DamageReason::bad_record], 1U);
    EXPECT_EQ(got.damaged.total(), 1U);
    EXPECT_EQ(got.data.events, camera_side.seen.events);
}

TEST(DavisFaults, ACutImuSampleIsLeftOutAndCounted) {
    PluggedIn camera_side{spoiled_by([done = false](Words& words) mutable {
        const auto start = std::find(words.begin(), words.end(), kImuStart);
        if (done || start == words.end()) return;
        ASSERT_EQ(start[5] & 0xFF00, kImuByte);
        words.erase(start + 5);
        done = true;
    })};
    const Streamed got = run(camera_side);
    EXPECT_EQ(got.data.imu.size(), 2U);
    EXPECT_EQ(got.damaged[DamageReason::bad_record], 1U);
    EXPECT_EQ(got.damaged.total(), 1U);
    EXPECT_EQ(got.data.events, camera_side.seen.events);
}

// ---- transfers ---------------------------------------------------------------------------------

TEST(DavisFaults, ShortPacketsLoseNothing) {
    for (const std::size_t bytes : {22, 510, 4098}) {
        PluggedIn camera_side{{}, {.events = 2'000}};
        for (auto& image : camera_side.seen.images) image.pixels = {4, 4};
        camera_side.model->show(camera_side.seen);
        camera_side.bed.limit_transfer(bytes);
        const Streamed got = run(camera_side);
        EXPECT_EQ(got.data.events, camera_side.seen.events) << bytes;
        EXPECT_EQ(got.data.images.size(), 3U);
        EXPECT_EQ(got.damaged.total(), 0U);
    }
}

TEST(DavisFaults, HalfAWordAtATransfersEndIsAGapAndNothingBehindItIsGarbled) {
    PluggedIn camera_side{{}, kShortScene};
    camera_side.bed.lose_last_byte_of_every(3);
    DavisOptions options = at_once();
    options.settings.transfers.bytes = 8 << 10;
    DavisCamera camera{options};
    const Streamed got = stream(camera, camera_side.bed, *camera_side.model);
    EXPECT_GT(camera.counters()[CameraCount::cut_transfers], 5U);
    EXPECT_GE(got.gaps.size() + 1, camera.counters()[CameraCount::cut_transfers])
        << "none follows the last";
    EXPECT_TRUE(is_part_of(got.data.events, camera_side.seen.events));
    EXPECT_GT(got.data.events.size(), camera_side.seen.events.size() * 9 / 10);
    EXPECT_EQ(got.damaged.total(), 0U);
}

TEST(DavisFaults, AHaltedEndpointIsClearedAndTheStreamGoesOnBehindAGap) {
    PluggedIn camera_side{{}, kShortScene};
    DavisOptions options = at_once();
    options.settings.transfers = {4, 8 << 10};
    DavisCamera camera{options};
    RawPacket packet;
    ASSERT_EQ(camera.read(packet), ReadStatus::data);
    camera_side.bed.halt_data(3);
    const Streamed got = stream(camera, camera_side.bed, *camera_side.model);
    EXPECT_EQ(camera.counters()[CameraCount::stalls], 3U);
    EXPECT_GE(got.gaps.size(), 1U);
    EXPECT_TRUE(is_part_of(got.data.events, camera_side.seen.events));
    EXPECT_GT(got.data.events.size(), camera_side.seen.events.size() / 4);
    EXPECT_EQ(got.damaged.total(), 0U);
}

TEST(DavisFaults, HaltsThatLieApartNeverAddUp) {
    PluggedIn camera_side{{}, {.events = 200'000}};
    DavisOptions options = at_once();
    options.settings.transfers = {4, 8 << 10};
    DavisCamera camera{options};
    RawPacket packet;
    for (unsigned halts = 1; halts <= 12; ++halts) {
        camera_side.bed.halt_data(1);
        while (camera.counters()[CameraCount::stalls] < halts) camera.read(packet);
        EXPECT_FALSE(packet.bytes.empty()) << "the stream goes on";
    }
}

TEST(DavisFaults, AHaltDuringTheStartDoesNotKeepItFromStarting) {
    PluggedIn camera_side;
    camera_side.bed.halt_data(1);
    EXPECT_EQ(run(camera_side).data.events, camera_side.seen.events);
}

TEST(DavisFaults, AnEndpointThatHaltsAgainAndAgainIsAnError) {
    PluggedIn camera_side;
    DavisCamera camera{at_once()};
    RawPacket packet;
    ASSERT_EQ(camera.read(packet), ReadStatus::data);
    camera_side.bed.halt_data(1000);
    EXPECT_THAT(failure_of([&] {
                    while (camera.read(packet) != ReadStatus::end) continue;
                }),
                HasSubstr("stalls again each time"));
}

TEST(DavisFaults, MoreTransfersThanTheKernelHasMemoryForAreRefusedWithTheWayOut) {
    PluggedIn camera_side;
    camera_side.bed.limit_memory(100 << 10);
    DavisCamera camera{at_once()};
    RawPacket packet;
    EXPECT_THAT(failure_of([&] { camera.read(packet); }), HasSubstr("usbfs_memory_mb"));
}

TEST(DavisFaults, SaysWhenNoDataCome) {
    PluggedIn camera_side;
    DavisCamera camera{at_once()};
    camera_side.bed.limit_transfer(1);  // half a word at a time: the marker never shows
    RawPacket packet;
    EXPECT_THAT(failure_of([&] { camera.read(packet); }), HasSubstr("no data came"));
}

// ---- control requests --------------------------------------------------------------------------

TEST(DavisFaults, SlowAnswersToControlRequestsChangeNothing) {
    PluggedIn camera_side;
    camera_side.bed.delay_control(20);
    EXPECT_EQ(run(camera_side).data.events, camera_side.seen.events);
}

TEST(DavisFaults, AControlRequestThatIsNeverAnsweredIsAnErrorAfterASecond) {
    PluggedIn camera_side;
    DavisCamera camera{at_once()};
    camera_side.bed.delay_control(testing_support::UsbTestbed::kNever);
    RawPacket packet;
    EXPECT_THAT(failure_of([&] { camera.read(packet); }),
                HasSubstr("register 0.83: the camera did not answer in time"));
    camera_side.bed.delay_control(0);
}

TEST(DavisFaults, ARefusedControlRequestNamesItsRegister) {
    PluggedIn camera_side;
    DavisCamera camera{at_once()};
    camera_side.bed.stall_control(1);
    RawPacket packet;
    EXPECT_THAT(failure_of([&] { camera.read(packet); }),
                HasSubstr("register 0.83: the camera refused the request"));
}

// ---- too much ----------------------------------------------------------------------------------

TEST(DavisFaults, WhatTheCameraItselfDropsInABurstIsCountedByItAndTheRestIsWhole) {
    DavisModelSettings settings;
    settings.fifo_bytes = 16 << 10;
    // 2 ms go by between two looks, and the events come at about 10 million a second.
    settings.now = [t = std::int64_t{0}]() mutable { return from_us(t += 2000); };
    PluggedIn camera_side{settings, {.events = 200'000, .longest_pause_us = 3}};
    for (std::size_t i = 0; i < camera_side.seen.events.size(); ++i)
        camera_side.seen.events[i].t = from_us(std::int64_t(i / 10));
    camera_side.seen.images.clear();
    camera_side.seen.imu.clear();
    camera_side.model->show(camera_side.seen);

    DavisCamera camera{at_once()};
    const auto parser = camera.make_parser();
    Batch got;
    const SensorTime last = camera_side.seen.events.back().t;
    RawPacket packet;
    while (!parser->clock() || *parser->clock() <= last + SensorDuration{40'000})
        if (camera.read(packet) == ReadStatus::data) parser->parse(packet.bytes, got);
    camera.stop();
    ASSERT_EQ(camera.read(packet), ReadStatus::end);

    const std::size_t missing = camera_side.seen.events.size() - got.events.size();
    EXPECT_GT(missing, 100'000U);
    EXPECT_EQ(camera.counters()[CameraCount::dropped_events], missing);
    EXPECT_TRUE(is_part_of(got.events, camera_side.seen.events));
    EXPECT_EQ(parser->damaged().total(), 0U);
}

TEST(DavisFaults, ACounterOfDropsThatBeganAnewIsNotTakenForALotOfThem) {
    PluggedIn camera_side;
    constexpr davis::Register kDroppedLow{davis::mux, 84};
    camera_side.model->write({kDroppedLow, 1000});  // before it was started
    DavisCamera camera{at_once()};
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    camera_side.bed.look([&] { camera_side.model->write({kDroppedLow, 3}); });
    camera.stop();
    EXPECT_EQ(camera.read(packet), ReadStatus::end);
    EXPECT_EQ(camera.counters()[CameraCount::dropped_events], 3U);
}

TEST(DavisFaults, DropsAreReadWhereTheMultiplexerCountsThem) {
    for (const bool counts : {true, false}) {
        DavisModelSettings settings;
        settings.mux_statistics = counts;
        settings.dvs_statistics = !counts;
        PluggedIn camera_side{settings};
        constexpr davis::Register kDroppedLow{davis::mux, 84};
        camera_side.model->write({kDroppedLow, 1000});  // before it was started
        DavisCamera camera{at_once()};
        RawPacket packet;
        while (camera.read(packet) != ReadStatus::data) continue;
        camera_side.bed.look([&] { camera_side.model->write({kDroppedLow, 1007}); });
        camera.stop();
        EXPECT_EQ(camera.read(packet), ReadStatus::end);
        EXPECT_EQ(camera.counters()[CameraCount::dropped_events], counts ? 7U : 0U);
    }
}

TEST(DavisFaults, DropsAreCountedWhileItRuns) {
    PluggedIn camera_side;
    constexpr davis::Register kDroppedLow{davis::mux, 84};
    DavisCamera camera{at_once()};
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    camera_side.bed.look([&] { camera_side.model->write({kDroppedLow, 7}); });
    while (camera.counters()[CameraCount::dropped_events] == 0) camera.read(packet);
    EXPECT_EQ(camera.counters()[CameraCount::dropped_events], 7U);
    camera.stop();
    EXPECT_EQ(camera.read(packet), ReadStatus::end);
    EXPECT_EQ(camera.counters()[CameraCount::dropped_events], 7U);
}

TEST(DavisFaults, ACameraThatRefusesToTellItsDropsGoesOnAndIsNotAskedAgain) {
    PluggedIn camera_side;
    std::vector<std::string> warnings;
    DavisOptions options = at_once();
    options.settings.auto_exposure = false;
    options.warn = [&](const std::string& text) { warnings.push_back(text); };
    DavisCamera camera{options};
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    camera_side.bed.stall_control(1);
    while (warnings.empty()) camera.read(packet);
    EXPECT_THAT(warnings.front(), HasSubstr("no longer tells how many events it drops: USB: "
                                            "reading register 0.83: the camera refused"));
    const int requests = camera_side.bed.requests();
    camera.stop();
    EXPECT_EQ(camera.read(packet), ReadStatus::end);
    EXPECT_GT(camera_side.bed.requests(), requests) << "it is still made idle";
}

TEST(DavisFaults, ACameraThatRefusesToTellItsLastDropsIsMadeIdleAllTheSame) {
    PluggedIn camera_side;
    std::vector<std::string> warnings;
    DavisOptions options = at_once();
    options.warn = [&](const std::string& text) { warnings.push_back(text); };
    DavisCamera camera{options};
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    camera_side.bed.stall_control(1);
    camera.stop();
    EXPECT_EQ(camera.read(packet), ReadStatus::end);
    EXPECT_EQ(camera_side.model->read(davis::kRun), 0U);
    EXPECT_EQ(camera_side.model->read(davis::kRunChip), 0U);
    EXPECT_EQ(warnings.size(), 1U) << "some of its drops may be missing";
}

}  // namespace
}  // namespace eventide::test
