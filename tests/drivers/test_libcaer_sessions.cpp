// Each camera in software streams for a driver that does what libcaer does (docs/protocols.md
// A.5 to A.8, A.12), which never resets timestamps: a camera counts from power-up.
#include "drivers/usb/davis_registers.h"
#include "drivers/usb/davis_settings.h"
#include "drivers/usb/dvxplorer_registers.h"
#include "drivers/usb/dvxplorer_settings.h"
#include "replay/formats.h"
#include "src/codec/inivation/davis.h"
#include "src/codec/inivation/dvs128.h"
#include "src/codec/inivation/dvxplorer.h"
#include "src/codec/inivation/dvxplorer_mini.h"
#include "tests/drivers/davis_streams.h"
#include "tests/drivers/dvxplorer_boards.h"
#include "tests/support/usb/davis_fire_hose.h"
#include "tests/support/usb/dvs128_model.h"
#include "tests/support/usb/recorded_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

namespace eventide::test {
namespace {

using namespace davis;
using testing_support::DavisModel;
using testing_support::DavisModelSettings;
using testing_support::Dvs128Model;
using testing_support::UsbModel;

/// usbConfigSet(): one register by a request of its own.
void set(UsbModel& camera, Register at, std::uint32_t value) {
    std::array<std::uint8_t, 4> data{std::uint8_t(value >> 24), std::uint8_t(value >> 16),
                                     std::uint8_t(value >> 8), std::uint8_t(value)};
    EXPECT_EQ(camera.control({0x40, 0xBF, at.module, at.address}, data), 4);
}

/// libcaer's transfers, 8 of 8 KiB; each is handed in again as soon as it was read.
class Transfers {
public:
    explicit Transfers(UsbModel& camera) : camera_(camera) {}

    /// Each transfer is tried so many times, which is what waiting is without a clock.
    void wait(int tries, Parser& parser, Batch& into) {
        for (int i = 0; i < tries; ++i) {
            auto& transfer = buffers_[next_++ % buffers_.size()];
            const std::size_t n = camera_.send(transfer);
            parser.parse(std::span{transfer}.first(n), into);
        }
    }

private:
    UsbModel& camera_;
    std::array<std::array<std::byte, 8192>, 8> buffers_{};
    std::size_t next_ = 0;
};

/// davisSendDefaultConfig() as far as it decides what flows, then davisDataStart().
template <typename Camera>
void start_davis(Camera& camera, Transfers& transfers, Parser& parser, Batch& into) {
    // Among the defaults: no reset, and everything off.
    set(camera, kTimestampReset, 0);
    for (const Write& write : idle_writes()) set(camera, write.at, write.value);
    camera.clear_endpoint();
    set(camera, kRunChip, 1);
    transfers.wait(200, parser, into);  // 200 ms: the biases settle
    set(camera, kUsbRun, 1);
    set(camera, kTimestampRun, 1);
    set(camera, kRun, 1);
    transfers.wait(50, parser, into);  // 50 ms
    for (const Register at :
         {kDvsRun, kApsRun, kImuRunAccel, kImuRunGyro, kImuRunTemperature, kExtRun}) {
        set(camera, at, 1);
        transfers.wait(5, parser, into);
    }
}

template <typename Camera>
void read_to_the_end(Camera& camera, Transfers& transfers, Parser& parser, Batch& into) {
    for (int i = 0; i < 1000 && !camera.is_scene_over(); ++i) transfers.wait(100, parser, into);
    EXPECT_TRUE(camera.is_scene_over());
    EXPECT_EQ(parser.damaged().total(), 0U);
}

TEST(LibcaerSession, ADavisStreamsWithoutATimestampReset) {
    for (const bool real_time : {false, true}) {
        DavisModelSettings settings;
        if (real_time)  // 200 us pass each time somebody looks
            settings.now = [t = std::int64_t{5'000'000}]() mutable { return from_us(t += 200); };
        DavisModel camera{settings};
        const Batch seen = davis_scene(settings.sensor);
        camera.show(seen);
        Transfers transfers{camera};
        DavisParser parser{settings.sensor};
        for (int session = 0; session < 2; ++session) {
            Batch got;
            start_davis(camera, transfers, parser, got);
            read_to_the_end(camera, transfers, parser, got);
            ASSERT_EQ(got.events.size(), seen.events.size()) << real_time << " " << session;
            ASSERT_FALSE(got.events.empty());
            const SensorDuration later = got.events[0].t - seen.events[0].t;
            EXPECT_TRUE(later.count() > 0 || !real_time) << "it counted before the scene began";
            for (std::size_t i = 0; i < got.events.size(); ++i)
                ASSERT_EQ(got.events[i].t - seen.events[i].t, later) << i;
            EXPECT_EQ(got.images.size(), seen.images.size());
            EXPECT_EQ(got.imu.size(), seen.imu.size());
            EXPECT_TRUE(got.triggers.empty()) << "no marker of a reset that was not asked for";
            parser = DavisParser{settings.sensor};
        }
    }
}

TEST(LibcaerSession, ADavisShowsARecordingWhole) {
    const auto file = std::filesystem::path{EVENTIDE_SOURCE_DIR} /
                      "../shared/data/formats/davis346_robotarm.aedat4";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no shared/data/recordings";
    const auto recording = open_recording(file.string());
    DavisModelSettings settings;
    settings.sensor = testing_support::sensor_for(recording->info());
    DavisModel camera{settings};
    camera.show(testing_support::scene_of(*recording));
    Transfers transfers{camera};
    DavisParser parser{settings.sensor};
    Batch got;
    start_davis(camera, transfers, parser, got);
    read_to_the_end(camera, transfers, parser, got);
    EXPECT_EQ(got.events.size(), 117'667U);
    EXPECT_EQ(std::ranges::count(got.events, Polarity::on, &Event::polarity), 72'363);
    EXPECT_EQ(got.images.size(), 3U);
}

TEST(LibcaerSession, AFireHoseStreamsWithoutATimestampReset) {
    testing_support::FireHoseSettings settings;
    settings.now = [t = std::int64_t{0}]() mutable { return from_us(t += 100); };
    testing_support::DavisFireHose camera{settings};
    Transfers transfers{camera};
    DavisParser parser{DavisSensor{}};
    Batch got;
    start_davis(camera, transfers, parser, got);
    transfers.wait(300, parser, got);
    ASSERT_GT(got.events.size(), 100'000U);
    for (std::size_t i = 0; i < got.events.size(); ++i) ASSERT_EQ(got.events[i], camera.event(i));
    EXPECT_TRUE(got.triggers.empty());
}

/// dvxplorerDataStart(): the chip's stream mode is the last of what open wrote.
void start_dvxplorer(UsbModel& camera, bool mini, Transfers& transfers, Parser& parser,
                     Batch& into) {
    for (const Write& write : dvxplorer_idle_writes(mini)) set(camera, write.at, write.value);
    camera.clear_endpoint();
    set(camera, eventide::dvxplorer::kCropBypass, 1);
    set(camera, eventide::dvxplorer::kMode, eventide::dvxplorer::kModeStream);
    if (!mini) {
        set(camera, kRunChip, 1);
        transfers.wait(200, parser, into);
        for (const Register at : {kUsbRun, kTimestampRun, kRun}) set(camera, at, 1);
    }
    transfers.wait(50, parser, into);
    for (const Register at : {kDvsRun, kImuRunAccel, kImuRunGyro, kImuRunTemperature, kExtRun}) {
        if (mini && at == kExtRun) continue;
        set(camera, at, 1);
        transfers.wait(5, parser, into);
    }
}

TEST(LibcaerSession, ADvxplorerStreamsWithoutATimestampResetWithEachBoard) {
    for (const auto& settings : dvxplorer::boards()) {
        testing_support::DvxplorerModel camera{settings};
        const Batch seen = dvxplorer::readouts(settings.sensor, 100);
        camera.show(seen);
        Transfers transfers{camera};
        std::unique_ptr<Parser> parser = std::make_unique<DvxplorerParser>(settings.sensor);
        if (settings.mini) parser = std::make_unique<DvxplorerMiniParser>(settings.sensor);
        Batch got;
        start_dvxplorer(camera, settings.mini, transfers, *parser, got);
        std::array<std::byte, 64> message{};
        for (int i = 0; i < 1000 && !camera.is_scene_over(); ++i) {
            transfers.wait(100, *parser, got);
            camera.message(message);
        }
        EXPECT_EQ(got.events, seen.events) << "mini " << settings.mini;
        EXPECT_EQ(parser->damaged().total(), 0U);
        if (!settings.mini) {
            EXPECT_EQ(got.triggers, seen.triggers);
        }
    }
}

TEST(LibcaerSession, ADvs128StreamsFromItsStart) {
    Batch seen;
    for (int i = 0; i < 5000; ++i)
        seen.events.push_back(
            {from_us(i * 37), std::uint16_t(i % 128), std::uint16_t(i * 7 % 128), Polarity(i % 2)});
    Dvs128Model camera;
    camera.show(seen);
    Transfers transfers{camera};
    Dvs128Parser parser;
    std::array<std::uint8_t, 36> biases{};
    constexpr std::uint8_t kStart = 0xB3, kSetBiases = 0xB8;
    EXPECT_EQ(camera.control({0x40, kSetBiases, 0, 0}, biases), 36);
    camera.clear_endpoint();
    EXPECT_EQ(camera.control({0x40, kStart, 0, 0}, {}), 0);
    Batch got;
    read_to_the_end(camera, transfers, parser, got);
    EXPECT_EQ(got.events, seen.events);
    EXPECT_TRUE(got.triggers.empty());
}

}  // namespace
}  // namespace eventide::test
