// Scenes before a DAVIS in software, and what the driver makes of them.
#pragma once

#include "drivers/usb/davis_camera.h"
#include "src/codec/parser.h"
#include "src/core/error.h"
#include "src/core/event.h"
#include "tests/support/holdings.h"
#include "tests/support/usb/davis_model.h"
#include "tests/support/usb/davis_sensors.h"
#include "tests/support/usb/usb_testbed.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace eventide::test {

/// Events, three images and three IMU samples. Events come 1 us apart in the mean, with pauses of
/// at most so many us here and there.
struct SceneSettings {
    int events = 20'000;
    unsigned longest_pause_us = 2000;
    unsigned seed = 1;
};
/// Nothing wraps within this one, so that after a loss the next time word tells the whole time.
inline constexpr SceneSettings kShortScene{.events = 20'000, .longest_pause_us = 3};
Batch davis_scene(const DavisSensor& sensor, SceneSettings settings = {});

/// A camera in software needs no time to settle.
DavisOptions at_once();

/// The words of a device Error; "nothing was thrown" where there was none.
std::string failure_of(const std::function<void()>& what);

struct Streamed {
    Batch data;
    Damage damaged;
    std::vector<std::size_t> gaps;  ///< number of events before each
    std::uint64_t bytes = 0;
};

/// Reads until the model's scene is over and nothing more comes.
Streamed stream(DavisCamera& camera, testing_support::UsbTestbed& bed,
                const testing_support::DavisModel& model);

/// A DAVIS346 that has been plugged in and sees a scene.
struct PluggedIn {
    explicit PluggedIn(testing_support::DavisModelSettings settings = {}, SceneSettings scene = {})
        : model(std::make_shared<testing_support::DavisModel>(std::move(settings))),
          seen(davis_scene(model->settings().sensor, scene)) {
        model->show(seen);
        bed.plug_in(model);
    }
    testing_support::UsbTestbed bed;
    std::shared_ptr<testing_support::DavisModel> model;
    Batch seen;
};

/// A DAVIS346 that sees so many events.
std::shared_ptr<testing_support::DavisModel> camera_before(int events);

/// At once, with four transfers of 8 KiB.
DavisOptions small_transfers(bool reconnect);

/// Opens the camera with transfers of 8 KiB and reads its scene to the end.
Streamed streamed_by(PluggedIn& camera_side);

/// `some` is `all` with parts left out.
bool is_part_of(const std::vector<Event>& some, const std::vector<Event>& all);

}  // namespace eventide::test
