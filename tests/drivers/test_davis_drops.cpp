// Events that a DAVIS itself drops, as its own counter says.
#include "tests/drivers/davis_streams.h"
#include "tests/support/keep_in.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace eventide::test {
namespace {

using testing::HasSubstr;
using testing_support::DavisModelSettings;

/// Of what the multiplexer dropped: the lower half of the counter.
constexpr davis::Register kDroppedLow{davis::mux, 84};

TEST(DavisDrops, WhatTheCameraItselfDropsInABurstIsCountedByItAndTheRestIsWhole) {
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

TEST(DavisDrops, ACounterOfDropsThatBeganAnewIsNotTakenForALotOfThem) {
    PluggedIn camera_side;
    camera_side.model->write({kDroppedLow, 1000});  // before it was started
    DavisCamera camera{at_once()};
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    camera_side.bed.look([&] { camera_side.model->write({kDroppedLow, 3}); });
    camera.stop();
    EXPECT_EQ(camera.read(packet), ReadStatus::end);
    EXPECT_EQ(camera.counters()[CameraCount::dropped_events], 3U);
}

TEST(DavisDrops, DropsAreReadWhereTheMultiplexerCountsThem) {
    for (const bool counts : {true, false}) {
        DavisModelSettings settings;
        settings.mux_statistics = counts;
        settings.dvs_statistics = !counts;
        PluggedIn camera_side{settings};
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

TEST(DavisDrops, DropsAreCountedWhileItRuns) {
    PluggedIn camera_side;
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

TEST(DavisDrops, ACameraThatRefusesToTellItsDropsGoesOnAndIsNotAskedAgain) {
    PluggedIn camera_side;
    std::vector<std::string> warnings;
    DavisOptions options = at_once();
    options.settings.auto_exposure = false;
    options.warn = keep_in(warnings);
    DavisCamera camera{options};
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    camera_side.bed.stall_control(1);
    while (warnings.empty()) camera.read(packet);
    EXPECT_THAT(warnings.front(), HasSubstr("does not tell how many events it drops: USB: "
                                            "reading register 0.83: the camera refused"));
    const int requests = camera_side.bed.requests();
    camera.stop();
    EXPECT_EQ(camera.read(packet), ReadStatus::end);
    EXPECT_GT(camera_side.bed.requests(), requests) << "it is still made idle";
}

/// The upper half of what it dropped is another each time it is asked.
class Restless final : public testing_support::UsbModel {
public:
    explicit Restless(std::shared_ptr<testing_support::DavisModel> camera)
        : camera_(std::move(camera)) {}
    testing_support::UsbModelIdentity identity() const override { return camera_->identity(); }
    int control(const testing_support::UsbSetup& setup, std::span<std::uint8_t> data) override {
        const int n = camera_->control(setup, data);
        const bool upper_half = setup.type == 0xC0 && setup.value == davis::mux &&
                                setup.index == kDroppedLow.address - 1;
        if (upper_half) data[3] = ++asked_;
        return n;
    }
    std::size_t send(std::span<std::byte> out) override { return camera_->send(out); }
    void clear_endpoint() override { camera_->clear_endpoint(); }

private:
    std::shared_ptr<testing_support::DavisModel> camera_;
    std::uint8_t asked_ = 0;
};

TEST(DavisDrops, ACounterThatNeverStandsStillIsNotReadForEver) {
    const auto model = camera_before(2'000);
    testing_support::UsbTestbed bed;
    bed.plug_in(std::make_shared<Restless>(model));
    std::vector<std::string> warnings;
    DavisOptions options = at_once();
    options.warn = keep_in(warnings);
    DavisCamera camera{options};
    EXPECT_EQ(stream(camera, bed, *model).data.events.size(), 2'000U);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_THAT(warnings.front(), HasSubstr("counter 0.83: its upper half is another each time"));
}

TEST(DavisDrops, ACameraThatNeverTellsThemIsOfUseAllTheSame) {
    PluggedIn camera_side;
    std::vector<std::string> warnings;
    DavisOptions options = at_once();
    options.warn = keep_in(warnings);
    DavisCamera camera{options};
    camera_side.bed.stall_control(1);
    EXPECT_EQ(stream(camera, camera_side.bed, *camera_side.model).data.events,
              camera_side.seen.events);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_THAT(warnings.front(), HasSubstr("does not tell how many events it drops"));
}

TEST(DavisDrops, ACameraThatRefusesToTellItsLastDropsIsMadeIdleAllTheSame) {
    PluggedIn camera_side;
    std::vector<std::string> warnings;
    DavisOptions options = at_once();
    options.warn = keep_in(warnings);
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
