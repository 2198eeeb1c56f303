// USB cameras opened, read from and closed again and again.
#include "drivers/usb/dvs128_camera.h"
#include "tests/drivers/davis_streams.h"
#include "tests/drivers/dvxplorer_boards.h"
#include "tests/support/holdings.h"
#include "tests/support/usb/dvs128_model.h"

#include <gtest/gtest.h>

#include <memory>

namespace eventide::test {
namespace {

using testing_support::DavisModel;
using testing_support::Dvs128Model;
using testing_support::DvxplorerModel;
using testing_support::UsbTestbed;

/// Plugged in, opened, streaming, stopped, closed, unplugged.
template <typename CameraType, typename Options, typename MakeModel>
void expect_sessions_leave_nothing(const Options& options, MakeModel make_model) {
    UsbTestbed bed;
    expect_nothing_left([&] {
        bed.plug_in(make_model());
        {
            CameraType camera{options};
            const auto parser = camera.make_parser();
            RawPacket packet;
            while (camera.read(packet) != ReadStatus::data) continue;
            Batch batch;
            parser->parse(packet.bytes, batch);
            camera.stop();
        }
        bed.unplug();
    });
}

TEST(UsbOpenings, OfADavisLeaveNothingBehind) {
    expect_sessions_leave_nothing<DavisCamera>(at_once(), [] {
        const auto model = std::make_shared<DavisModel>(testing_support::DavisModelSettings{});
        model->show(davis_scene(model->settings().sensor, {.events = 500}));
        return model;
    });
}

TEST(UsbOpenings, OfADvs128LeaveNothingBehind) {
    Dvs128Options options;
    options.waits = kNoWaits;
    expect_sessions_leave_nothing<Dvs128Camera>(options, [] {
        const auto model = std::make_shared<Dvs128Model>(std::uint8_t{14});
        Batch scene;
        for (std::uint16_t n = 0; n < 500; ++n)
            scene.events.push_back({from_us(10 * n), std::uint16_t(n % 128), 5, Polarity::on});
        model->show(scene);
        return model;
    });
}

TEST(UsbOpenings, OfADvxplorerLeaveNothingBehind) {
    for (const auto& settings : dvxplorer::boards())
        expect_sessions_leave_nothing<DvxplorerCamera>(dvxplorer::at_once(), [&] {
            const auto model = std::make_shared<DvxplorerModel>(settings);
            model->show(dvxplorer::readouts(settings.sensor, 20));
            return model;
        });
}

}  // namespace
}  // namespace eventide::test
