// Frames of a source, one by one.
#include "src/core/number_text.h"

#include <eventide/error.h>
#include <eventide/pipeline.h>

namespace eventide {

void refuse_other_sensor(const EventSource& source, const Reconstructor& reconstructor) {
    const SensorInfo& sensor = source.info();
    const bool is_known = sensor.width > 0 && sensor.height > 0;
    if (is_known &&
        (sensor.width != reconstructor.width() || sensor.height != reconstructor.height()))
        throw Error(ErrorKind::usage, "source: expected a sensor of " +
                                          size_text(reconstructor.width(), reconstructor.height()) +
                                          " px, as of the reconstructor, found one of " +
                                          size_text(sensor.width, sensor.height));
}

void push_from(const EventSource& source, const Batch& batch, Reconstructor& reconstructor) {
    refuse_other_sensor(source, reconstructor);
    if (source.gap_before()) reconstructor.mark_gap();
    reconstructor.push(batch);
    if (const auto clock = source.clock(); clock && source.is_live()) reconstructor.advance(*clock);
}

bool read_frame(EventSource& source, Reconstructor& reconstructor, Frame& frame) {
    refuse_other_sensor(source, reconstructor);
    for (Batch batch; !reconstructor.next(frame);) {
        if (!source.read(batch)) {
            reconstructor.finish(source.clock());
            return reconstructor.next(frame);
        }
        push_from(source, batch, reconstructor);
    }
    return true;
}

}  // namespace eventide
