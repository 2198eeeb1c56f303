// The real driver, through the real libusb, against a DVS128 in software.
#include "drivers/usb/dvs128_camera.h"

#include "drivers/devices.h"
#include "tests/drivers/usb_sessions.h"
#include "tests/support/usb/dvs128_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace eventide::test {
namespace {

using testing::HasSubstr;
using testing_support::Dvs128Model;
using testing_support::UsbTestbed;
using Request = Dvs128Model::Request;

Batch scene(int events) {
    std::mt19937 rng{1};
    Batch batch;
    std::int64_t t = 0;
    for (int i = 0; i < events; ++i) {
        t += std::int64_t(rng() % (i % 100 == 0 ? 100'000 : 20));
        batch.events.push_back({from_us(t), std::uint16_t(rng() % 128), std::uint16_t(rng() % 128),
                                Polarity(rng() % 2)});
    }
    batch.triggers.push_back({from_us(t / 2), Trigger::Kind::rising, 0});
    return batch;
}

Dvs128Options at_once() {
    Dvs128Options options;
    options.waits = kNoWaits;
    return options;
}

struct PluggedIn {
    explicit PluggedIn(int events = 50'000, std::uint8_t firmware = 14)
        : model(std::make_shared<Dvs128Model>(firmware)), seen(scene(events)) {
        model->show(seen);
        bed.plug_in(model);
    }
    UsbTestbed bed;
    std::shared_ptr<Dvs128Model> model;
    Batch seen;
};

TEST(Dvs128Camera, GivesTheEventsThatTheCameraSawAtEachTransferSize) {
    PluggedIn side;
    for (const std::size_t kib : {4, 8, 64}) {
        Dvs128Options options = at_once();
        options.settings.transfers.bytes = kib << 10;
        Dvs128Camera camera{options};
        EXPECT_EQ(camera.packet_bytes(), kib << 10);
        const Batch got = stream_scene(camera, side.bed, *side.model);
        EXPECT_EQ(got.events, side.seen.events) << kib << " KiB";
        ASSERT_EQ(got.triggers.size(), 2U);
        EXPECT_EQ(got.triggers[0].kind, Trigger::Kind::timestamp_reset);
        EXPECT_EQ(got.triggers[1], side.seen.triggers[0]);
    }
}

TEST(Dvs128Camera, StartsAndStopsWithItsOwnRequests) {
    PluggedIn side{10};
    {
        Dvs128Options options = at_once();
        options.settings.biases["diffOn"] = 0x123456;
        Dvs128Camera camera{options};
        RawPacket packet;
        while (camera.read(packet) != ReadStatus::data) continue;
    }
    const auto& requests = side.model->requests();
    ASSERT_FALSE(requests.empty());
    // Twelve biases of three bytes, the highest first, in libcaer's order: diffOn is the ninth.
    EXPECT_EQ(requests[0].request, 0xB8);
    ASSERT_EQ(requests[0].data.size(), 36U);
    const auto bias = [&](std::size_t i) {
        const auto& b = requests[0].data;
        return (b[3 * i] << 16) | (b[3 * i + 1] << 8) | b[3 * i + 2];
    };
    EXPECT_EQ(bias(0), 1992);
    EXPECT_EQ(bias(8), 0x123456);
    EXPECT_EQ(bias(11), 217);
    const std::vector<Request> rest{
        {0xBE, 1, {}},  // master of the time (libcaer's TS_MASTER)
        {0xB4, 0, {}},  // nothing from before
        {0xB3, 0, {}},  // dvs128DataStart
        {0xBB, 0, {}},  // RESET_TS, whose mark is waited for
        {0xB4, 0, {}}   // dvs128DataStop
    };
    EXPECT_EQ((std::vector<Request>{requests.begin() + 1, requests.end()}), rest);
}

TEST(Dvs128Camera, ASlaveBeginsWithoutTheMarkThatOnlyAMasterSends) {
    PluggedIn side;
    Dvs128Options options = at_once();
    options.settings.master = false;
    Dvs128Camera camera{options};
    const Batch got = stream_scene(camera, side.bed, *side.model);
    EXPECT_EQ(got.events, side.seen.events);
    EXPECT_EQ(got.triggers, side.seen.triggers);
}

// 128 events in 9 ms fill a packet, and from there on a transfer ends only when it is full.
TEST(Dvs128Camera, NoTransferHoldsBackEventsForLong) {
    constexpr std::int64_t kPauseUs = 9'000 / 128;
    PluggedIn side;
    Batch steady;
    for (int i = 0; i < 5'000; ++i)
        steady.events.push_back({from_us(i * kPauseUs), 1, 2, Polarity::on});
    side.model->show(steady);
    Dvs128Camera camera{at_once()};
    expect_events_held_back_less_than(SensorDuration{20'000}, camera, steady.events.size());
}

TEST(Dvs128Camera, OldFirmwareAndUnknownBiasesAreRefused) {
    const PluggedIn side{1, 13};
    EXPECT_THAT(error_of([] { Dvs128Camera{at_once()}; }, ErrorKind::device),
                HasSubstr("the DVS128 'DVS00128' has firmware 13, at least 14"));
    Dvs128Settings settings;
    settings.biases["DiffBn"] = 1;
    EXPECT_THAT(error_of([&] { bias_bytes(settings); }, ErrorKind::usage),
                HasSubstr("no bias 'DiffBn'"));
}

TEST(Dvs128Camera, ShippedFileSaysTheDefaults) {
    const Dvs128Settings file = load_dvs128_settings(shipped("dvs128.toml")), code;
    EXPECT_EQ(bias_bytes(file), bias_bytes(code));
    EXPECT_EQ(file.master, code.master);
    EXPECT_EQ(file.transfers.bytes, code.transfers.bytes);
    EXPECT_EQ(file.transfers.transfers, code.transfers.transfers);
    EXPECT_THAT(error_of([] { load_dvs128_settings(written("master = true\nroi = 1\n")); },
                         ErrorKind::usage),
                HasSubstr(":2: unknown key 'roi'"));
    EXPECT_EQ(load_dvs128_settings(written("[biases]\npuX = 16777215\n")).biases.at("puX"),
              0xFFFFFFU);
    EXPECT_THAT(error_of([] { load_dvs128_settings(written("[biases]\npuX = 16777216\n")); },
                         ErrorKind::usage),
                HasSubstr("16777216"));
}

TEST(Dvs128Camera, UnpluggedItComesBackBehindAGap) {
    PluggedIn side;
    Dvs128Options options = at_once();
    options.reconnect = true;
    Dvs128Camera camera{options};
    expect_return_behind_a_gap(camera, side.bed, side.model);
}

TEST(Dvs128Camera, IsListedAndOpenedByItsNameOnTheCommandLine) {
    const PluggedIn side{1};
    const auto cameras = list_cameras();
    ASSERT_EQ(cameras.size(), 1U);
    EXPECT_EQ(cameras[0].source, "dvs128:DVS00128");
    EXPECT_EQ(cameras[0].name, "DVS128");
    EXPECT_EQ(cameras[0].logic, "") << "it has none";
    EXPECT_EQ(cameras[0].problem, "");
    EXPECT_EQ(open_camera("dvs128:", {})->info().format, "dvs128");
}

}  // namespace
}  // namespace eventide::test
