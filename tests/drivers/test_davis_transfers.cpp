// Transfers of a DAVIS that are cut, overflow, stall or find no memory.
#include "tests/drivers/davis_streams.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace eventide::test {
namespace {

using testing::HasSubstr;

TEST(DavisTransfers, ShortPacketsLoseNothing) {
    for (const std::size_t bytes : {22, 510, 4098}) {
        PluggedIn camera_side{{}, {.events = 2'000}};
        for (auto& image : camera_side.seen.images) image.pixels = {4, 4};
        camera_side.model->show(camera_side.seen);
        camera_side.bed.limit_transfer(bytes);
        const Streamed got = streamed_by(camera_side);
        EXPECT_EQ(got.data.events, camera_side.seen.events) << bytes;
        EXPECT_EQ(got.data.images.size(), 3U);
        EXPECT_EQ(got.damaged.total(), 0U);
    }
}

TEST(DavisTransfers, HalfAWordAtATransfersEndIsAGapAndNothingBehindItIsGarbled) {
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

TEST(DavisTransfers, WhatATransferHadNoRoomForIsAGapBehindItsBytes) {
    PluggedIn camera_side{{}, kShortScene};
    DavisCamera camera{small_transfers(false)};
    RawPacket packet;
    ASSERT_EQ(camera.read(packet), ReadStatus::data);
    camera_side.bed.overflow_data(2);
    const Streamed got = stream(camera, camera_side.bed, *camera_side.model);
    EXPECT_EQ(got.gaps.size(), 2U);
    EXPECT_GT(got.gaps.at(0), 0U) << "what found room came";
    EXPECT_TRUE(is_part_of(got.data.events, camera_side.seen.events));
    EXPECT_EQ(got.damaged.total(), 0U);
}

TEST(DavisTransfers, AHaltedEndpointIsClearedAndTheStreamGoesOnBehindAGap) {
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

TEST(DavisTransfers, HaltsThatLieApartNeverAddUp) {
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

TEST(DavisTransfers, WhatNobodyFetchedBeforeIsNotTakenForTheBegin) {
    PluggedIn camera_side{{}, kShortScene};
    std::vector<std::byte> unread;
    testing_support::DavisWriter::timestamp_reset(unread);
    testing_support::DavisWriter{DavisSensor{}}.write(davis_scene({}, {.events = 50, .seed = 2}),
                                                      unread);
    camera_side.bed.leave_unread(unread);
    EXPECT_EQ(streamed_by(camera_side).data.events, camera_side.seen.events);
}

TEST(DavisTransfers, AHaltDuringTheStartDoesNotKeepItFromStarting) {
    PluggedIn camera_side;
    camera_side.bed.halt_data(1);
    EXPECT_EQ(streamed_by(camera_side).data.events, camera_side.seen.events);
}

TEST(DavisTransfers, AnEndpointThatHaltsAgainAndAgainIsAnError) {
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

TEST(DavisTransfers, AnEndpointThatWasLeftHaltedIsClearedBeforeTheStart) {
    PluggedIn camera_side;
    RawPacket packet;
    {
        DavisCamera camera{at_once()};
        ASSERT_EQ(camera.read(packet), ReadStatus::data);
        camera_side.bed.halt_data(1000);
        EXPECT_FALSE(failure_of([&] {
                         while (camera.read(packet) != ReadStatus::end) continue;
                     }).empty());
    }
    camera_side.bed.halt_data(0);
    DavisCamera camera{at_once()};
    EXPECT_EQ(camera.read(packet), ReadStatus::data);
    EXPECT_EQ(camera.counters()[CameraCount::stalls], 0U);
}

TEST(DavisTransfers, MoreTransfersThanTheKernelHasMemoryForAreRefusedWithTheWayOut) {
    PluggedIn camera_side;
    camera_side.bed.limit_memory(100 << 10);
    DavisCamera camera{at_once()};
    RawPacket packet;
    EXPECT_THAT(failure_of([&] { camera.read(packet); }), HasSubstr("usbfs_memory_mb"));
}

TEST(DavisTransfers, SaysWhenNoDataCome) {
    PluggedIn camera_side;
    DavisCamera camera{at_once()};
    camera_side.bed.limit_transfer(1);  // half a word at a time: the marker never shows
    RawPacket packet;
    EXPECT_THAT(failure_of([&] { camera.read(packet); }), HasSubstr("no data came"));
}

}  // namespace
}  // namespace eventide::test
