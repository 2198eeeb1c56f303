// Frames of a source, one by one.
#include <eventide/pipeline.h>

namespace eventide {

bool read_frame(EventSource& source, Reconstructor& reconstructor, Frame& frame) {
    for (Batch batch; !reconstructor.next(frame);) {
        if (!source.read(batch)) {
            reconstructor.finish(source.clock());
            return reconstructor.next(frame);
        }
        if (source.gap_before()) reconstructor.mark_gap();
        reconstructor.push(batch);
        if (const auto clock = source.clock(); clock && source.is_live())
            reconstructor.advance(*clock);
    }
    return true;
}

}  // namespace eventide
