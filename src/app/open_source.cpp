// SOURCE on the command line becomes a source of bytes.
#include "src/app/open_source.h"

#include "drivers/devices.h"
#include "drivers/simulated/simulated_camera.h"
#include "replay/formats.h"
#include "src/core/error.h"

#include <utility>

namespace eventide::app {

namespace {

OpenedSource open_file(const RunSettings& settings, double speed) {
    auto recording = open_recording(settings.source, settings.input.options());
    OpenedSource opened;
    if (speed > 0) {
        auto paced = std::make_unique<Paced>(std::move(recording), speed);
        opened.recording = opened.paced = paced.get();
        opened.source = std::move(paced);
    } else {
        opened.recording = recording.get();
        opened.source = std::move(recording);
    }
    return opened;
}

void require_size(const Source& source, const std::string& name) {
    if (source.info().width < 1 || source.info().height < 1)
        throw Error(ErrorKind::usage, name +
                                          ": the recording does not say the sensor's size; "
                                          "--input-size 240x180 tells it");
}

}  // namespace

OpenedSource open_source(const RunSettings& settings, double speed) {
    OpenedSource opened;
    if (names_simulation(settings.source))
        opened.source = open_simulation(settings.source);
    else if (names_camera(settings.source))
        opened.source = open_camera(settings.source, {settings.camera, settings.reconnect});
    else
        opened = open_file(settings, speed);
    require_size(*opened.source, settings.source);
    return opened;
}

}  // namespace eventide::app
