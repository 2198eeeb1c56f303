// DVXplorers in software, of every board, plugged in and shown a scene.
#pragma once

#include "drivers/usb/dvxplorer_camera.h"
#include "tests/drivers/usb_sessions.h"
#include "tests/support/usb/dvxplorer_model.h"

#include <memory>
#include <random>
#include <vector>

namespace eventide::test::dvxplorer {

/// Readouts of the sensor: within one time, column by column, each pixel once.
inline Batch readouts(const DvxplorerSensor& sensor, int count, unsigned seed = 1) {
    std::mt19937 rng{seed};
    Batch scene;
    std::int64_t t = 0;
    for (int i = 0; i < count; ++i) {
        t += 1 + std::int64_t(rng() % (i % 50 == 0 ? 90'000 : 400));
        for (int column = int(rng() % 100); column < sensor.columns();
             column += int(rng() % 97) + 1)
            for (int row = int(rng() % 60); row < sensor.rows(); row += int(rng() % 90) + 1) {
                const auto x = std::uint16_t(sensor.swapped ? row : column);
                const auto y = std::uint16_t(sensor.swapped ? column : row);
                scene.events.push_back({from_us(t), x, y, Polarity(rng() % 2)});
            }
    }
    for (int i = 1; i <= 3; ++i) {
        scene.imu.push_back({from_us(t * i / 4), {.5F, 0, 1}, {100, -20, 3}, {}, 30});
        scene.triggers.push_back({from_us(t * i / 5), Trigger::Kind::rising, 0});
    }
    return scene;
}

/// No wait for hardware.
inline DvxplorerOptions at_once() {
    DvxplorerOptions options;
    options.waits = kNoWaits;
    return options;
}

/// A camera in software on a bus of its own, and what it is shown.
struct PluggedIn {
    explicit PluggedIn(testing_support::DvxplorerModelSettings settings = {}, int count = 200)
        : model(std::make_shared<testing_support::DvxplorerModel>(settings)),
          seen(readouts(settings.sensor, count)) {
        model->show(seen);
        bed.plug_in(model);
    }
    testing_support::UsbTestbed bed;
    std::shared_ptr<testing_support::DvxplorerModel> model;
    Batch seen;
};

/// A DVXplorer, a Lite, one whose sensor has its axes swapped, a Mini.
inline std::vector<testing_support::DvxplorerModelSettings> boards() {
    testing_support::DvxplorerModelSettings red, lite, swapped, mini;
    lite.sensor.width = 320;
    lite.sensor.height = 240;
    lite.chip = 19;
    swapped = lite;
    swapped.sensor.swapped = true;
    mini.mini = true;
    return {red, lite, swapped, mini};
}

}  // namespace eventide::test::dvxplorer
