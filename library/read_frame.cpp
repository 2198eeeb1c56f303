// Frames of a source, one by one.
#include <eventide/pipeline.h>

namespace eventide {

void push_from(const EventSource& source, const Batch& batch, Reconstructor& reconstructor) {
    if (source.gap_before()) reconstructor.mark_gap();
    reconstructor.push(batch);
    if (const auto clock = source.clock(); clock && source.is_live()) reconstructor.advance(*clock);
}

bool read_frame(EventSource& source, Reconstructor& reconstructor, Frame& frame) {
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
