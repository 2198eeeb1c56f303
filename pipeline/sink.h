// Where frames go.
#pragma once

#include "src/core/frame_data.h"

#include <span>

namespace eventide {

/// A sink looks at a frame and does not keep it. Throws Error when it cannot write.
class Sink {
public:
    virtual ~Sink() = default;

    /// Render thread.
    virtual void write(const Frame& frame) = 0;

    /// Render thread, before the first frame that it holds for: how many event windows after a
    /// frame's own came before Frame::arrived. Changes while a run goes on, and at its end.
    virtual void lookahead_is(int /*windows*/) {}

    /// Render thread, once, after the last frame, also after an error or SIGINT: complete and close
    /// what was written.
    virtual void close() {}

    /// False when nobody wants more frames (a window was closed): the run ends cleanly.
    virtual bool wants_more() const { return true; }

    /// Render thread. Of the last write(): how long somebody wished to look at that frame (a
    /// pause), which is no work.
    virtual HostTime::duration held() const { return {}; }

    /// Render thread. False while nobody sees what is written: a frame that no sink has watchers
    /// for is skipped.
    virtual bool is_watched() const { return true; }
};

}  // namespace eventide
