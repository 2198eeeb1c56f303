// The built program with the other USB cameras in software: what each of them saw is what it
// records.
#include "tests/support/usb/dvs128_model.h"
#include "tests/support/usb/dvxplorer_model.h"
#include "tests/support/usb/usb_testbed.h"
#include "tests/system/program_test.h"
#include "tests/system/recorded.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <signal.h>

namespace eventide::test {
namespace {

using testing_support::Dvs128Model;
using testing_support::DvxplorerModel;
using testing_support::DvxplorerModelSettings;
using testing_support::UsbTestbed;
using Json = nlohmann::json;

/// Within one time in the order of a readout: by column, each pixel once. About 0.2 s.
Batch scene(int width, int height) {
    Batch scene;
    for (int i = 0; i < 400; ++i)
        for (int x = i % 7; x < width; x += 17)
            scene.events.push_back({SensorTime{SensorDuration{1 + i * 500}}, std::uint16_t(x),
                                    std::uint16_t((i * 31 + x * 7) % height),
                                    Polarity((i + x) % 2)});
    return scene;
}

class LiveCameras : public ProgramTest {
protected:
    /// Runs until the camera has sent all, and gives the events of the recording.
    template <typename Model>
    std::vector<Event> record(const std::string& source, const Model& camera,
                              std::size_t pixels_of_frame) {
        Process process =
            start({"run", source, "--fps", "50", "--record", "raw.aedat4", "--out", "gray8:-"},
                  {.output_to_pipe = true});
        for (bool over = false; !over;) {
            EXPECT_EQ(process.read_output(pixels_of_frame).size(), pixels_of_frame);
            if (HasFailure()) break;
            bed_.look([&] { over = camera.is_scene_over(); });
        }
        // What the camera has sent is not yet what the program has fetched.
        EXPECT_EQ(process.read_output(3 * pixels_of_frame).size(), 3 * pixels_of_frame);
        process.signal(SIGINT);
        const Result result = process.wait();
        EXPECT_EQ(result.exit_code, 0) << result.error;
        return recorded(temp_ / "raw.aedat4").events;
    }
    Json only_device() {
        const Json devices = Json::parse(eventide({"devices", "--json"}).output);
        EXPECT_EQ(devices.size(), 1U);
        return devices.at(0);
    }
    UsbTestbed bed_;
};

TEST_F(LiveCameras, Dvxplorer) {
    for (const bool mini : {false, true}) {
        DvxplorerModelSettings settings;
        settings.sensor.width = 320;
        settings.sensor.height = 240;
        settings.chip = 19;
        settings.mini = mini;
        const auto camera = std::make_shared<DvxplorerModel>(settings);
        const Batch seen = scene(320, 240);
        camera->show(seen);
        bed_.plug_in(camera);
        EXPECT_EQ(only_device()["usable"], true);
        EXPECT_EQ(record("dvxplorer:", *camera, 320 * 240), seen.events) << "mini " << mini;
        bed_.unplug();
        std::filesystem::remove(temp_ / "raw.aedat4");
    }
}

TEST_F(LiveCameras, Dvs128) {
    const auto camera = std::make_shared<Dvs128Model>();
    const Batch seen = scene(128, 128);
    camera->show(seen);
    bed_.plug_in(camera);
    EXPECT_EQ(only_device()["usable"], true);
    EXPECT_EQ(record("dvs128:", *camera, 128 * 128), seen.events);
}

}  // namespace
}  // namespace eventide::test
