// Real recordings before a DAVIS in software: the same events, frames and IMU samples come out of
// the driver.
#include "replay/formats.h"
#include "tests/drivers/davis_streams.h"
#include "tests/support/recorded_scene.h"

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
        if (sensor.is_davis240()) value = 1023 - std::min(2 * ((1023 - value + 1) / 2), 1023);
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

INSTANTIATE_TEST_SUITE_P(AtHand, DavisRecordings,
                         testing::Values("formats/davis346_desk.aedat4",
                                         "formats/davis346_robotarm.aedat4",
                                         "formats/davis240_imu_rotdisk.aedat2",
                                         "recordings/camerashake_b",
                                         "recordings/slider_depth_head"));

}  // namespace
}  // namespace eventide::test
