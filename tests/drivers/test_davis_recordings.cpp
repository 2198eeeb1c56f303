// Real recordings before a DAVIS in software: the same events, frames and IMU samples come out of
// the driver.
#include "replay/formats.h"
#include "tests/drivers/davis_streams.h"
#include "tests/support/usb/davis_fire_hose.h"
#include "tests/support/usb/recorded_scene.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace eventide::test {
namespace {

using testing_support::DavisModel;
using testing_support::DavisModelSettings;
using testing_support::scene_of;
using testing_support::sensor_for;
using testing_support::UsbTestbed;

/// As ten bits hold them; a DAVIS240's converter gives every second value.
ReferenceImage as_measured(ReferenceImage image, const DavisSensor& sensor) {
    for (std::uint16_t& pixel : image.pixels.values()) {
        int value = pixel >> 6;
        if (sensor.is_davis240()) value = std::min(2 * ((value + 1) / 2), 1023);
        pixel = std::uint16_t((value << 6) | (value >> 4));
    }
    image.t = image.exposure_begin + (image.exposure_end - image.exposure_begin) / 2;
    return image;
}

void expect_equal(const ImuSample& got, const ImuSample& seen) {
    constexpr double kAccelStep = 8.0 / 65536, kGyroStep = 1000.0 / 65536, kDegreeStep = 1 / 333.0;
    EXPECT_EQ(got.t, seen.t);
    for (std::size_t a = 0; a < 3; ++a) {
        EXPECT_NEAR(got.acceleration_g[a], seen.acceleration_g[a], kAccelStep);
        EXPECT_NEAR(got.gyro_dps[a], seen.gyro_dps[a], kGyroStep);
    }
    EXPECT_NEAR(got.temperature_c, seen.temperature_c, kDegreeStep);
}

class DavisRecordings : public testing::TestWithParam<const char*> {};

TEST_P(DavisRecordings, ComeOutAsTheyWentInAtAnyTransferSize) {
    const std::filesystem::path file =
        std::filesystem::path{EVENTIDE_SOURCE_DIR} / "../shared/data" / GetParam();
    if (!std::filesystem::exists(file))
        GTEST_SKIP() << "no " << GetParam() << " beside the project";
    const auto recording = open_recording(file.string());
    DavisModelSettings settings;
    settings.sensor = sensor_for(recording->info());
    const auto model = std::make_shared<DavisModel>(settings);
    const Batch seen = scene_of(*recording);
    ASSERT_FALSE(seen.events.empty());
    model->show(seen);
    UsbTestbed bed;
    bed.plug_in(model);
    for (std::size_t kib = 8; kib <= 1024; kib *= 2) {
        DavisOptions options = at_once();
        options.settings.transfers = {4, kib << 10};
        DavisCamera camera{options};
        const Streamed got = stream(camera, bed, *model);
        EXPECT_TRUE(got.data.events == seen.events) << "transfers of " << kib << " KiB";
        ASSERT_EQ(got.data.images.size(), seen.images.size());
        for (std::size_t i = 0; i < seen.images.size(); ++i)
            EXPECT_TRUE(got.data.images[i] == as_measured(seen.images[i], settings.sensor)) << i;
        ASSERT_EQ(got.data.imu.size(), seen.imu.size());
        for (std::size_t i = 0; i < seen.imu.size(); ++i)
            expect_equal(got.data.imu[i], seen.imu[i]);
        EXPECT_EQ(got.damaged.total(), 0U);
    }
}

/// The short form of davis-throughput, in time that the test makes: nothing can be too slow.
TEST(DavisThroughput, OfTwelveMillionEventsASecondNoneIsLostOrChanged) {
    testing_support::FireHoseSettings settings;
    settings.now = [t = std::int64_t{0}]() mutable { return from_us(t += 500); };
    const auto hose = std::make_shared<testing_support::DavisFireHose>(settings);
    UsbTestbed bed;
    bed.plug_in(hose);
    DavisOptions options = at_once();
    options.settings.frames = options.settings.imu = false;
    DavisCamera camera{options};
    const auto parser = camera.make_parser();
    Batch batch;
    std::uint64_t events = 0, wrong = 0;
    for (RawPacket packet; !parser->clock() || *parser->clock() < from_us(500'000);) {
        if (camera.read(packet) != ReadStatus::data) continue;
        batch.clear();
        parser->parse(packet.bytes, batch);
        for (const Event& event : batch.events) wrong += event == hose->event(events++) ? 0 : 1;
    }
    EXPECT_GE(events, 6'000'000U);
    EXPECT_EQ(wrong, 0U);
    EXPECT_EQ(parser->damaged().total(), 0U);
    bed.look([&] { EXPECT_EQ(hose->dropped(), 0U); });
}

INSTANTIATE_TEST_SUITE_P(AtHand, DavisRecordings,
                         testing::Values("formats/davis346_desk.aedat4",
                                         "formats/davis346_robotarm.aedat4",
                                         "formats/davis240_imu_rotdisk.aedat2",
                                         "recordings/camerashake_b",
                                         "recordings/slider_depth_head"));

}  // namespace
}  // namespace eventide::test
