// An EventSource of a library's user as the source of a pipeline.
#pragma once

#include "pipeline/source.h"

#include <eventide/pipeline.h>

#include <atomic>
#include <optional>

namespace eventide {

/// What a batch says of the stream goes from the read thread to the bin thread as bytes: a packet
/// is the clock, the images (or their times alone), and the events as they lie in memory.
class UserSource final : public Source {
public:
    /// Borrowed. `with_images`: else their times alone are handed on.
    UserSource(EventSource& source, bool with_images);

    const SensorInfo& info() const override { return source_.info(); }
    bool is_live() const noexcept override { return source_.is_live(); }
    ReadStatus read(RawPacket& into) override;
    void stop() noexcept override;
    std::unique_ptr<Parser> make_parser() const override;

private:
    EventSource& source_;
    const bool with_images_;
    Batch batch_;                       // source thread
    std::optional<SensorTime> clock_;   // source thread: what was handed on
    bool ended_ = false;                // source thread
    std::atomic<bool> stopped_{false};  // any thread
};

}  // namespace eventide
