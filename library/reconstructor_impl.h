// The network at work: windows are encoded when a frame needs them, frames are handed out one by
// one.
#pragma once

#include "library/event_intake.h"
#include "pipeline/frame_clock.h"
#include "pipeline/frame_output.h"
#include "pipeline/silence_guard.h"
#include "src/binning/binner.h"
#include "src/core/frame_stamp.h"
#include "src/model/encode/encoder.h"
#include "src/model/render/fused_renderer.h"
#include "src/nn/safetensors.h"

#include <array>
#include <optional>
#include <string>

namespace eventide {

class Reconstructor::Impl {
public:
    /// width and height are sane; everything else is checked here. Throws Error.
    Impl(const Model& model, int width, int height, const ReconstructorOptions& options);

    EventIntake& intake() { return intake_; }
    const Encoder& encoder() const { return encoder_; }
    const ReconstructorCounters& counters() const { return counters_; }

    bool next(Frame& frame);
    Readiness readiness(SensorTime t);
    void render(SensorTime t, const FrameSize& size, Frame& frame);
    void render(SensorTime t, Frame& frame) { render(t, options_.size, frame); }
    std::optional<SensorTime> newest();
    void reset();
    /// `name` stands for the state in messages.
    void restore(const TensorFile& state, const std::string& name);

private:
    bool step();
    std::uint64_t most_waiting() const;
    bool keeps_frames() const;
    void bin(const EventWindow& event_window);
    void encode();
    void correct();
    void note_images() noexcept;
    void note_window();
    void forget_stream();
    void forget_events();
    void open_next();
    WindowStamp& seen(std::uint64_t k) { return seen_[k % seen_.size()]; }
    void check_silence();
    void render_due(Frame& frame);
    void render_request(SensorTime t, const FrameSize& size, Frame& frame);
    void make_room(const FrameSize& size, Frame& frame);

    const ReconstructorOptions options_;
    const EngineOptions engine_;
    ReconstructorCounters counters_;
    EventIntake intake_;
    Binner binner_;
    Encoder encoder_;
    Renderer renderer_;
    std::optional<FusedRenderer> fused_;  // none: images do not correct frames
    bool has_images_ = false;             // of this stream one has come
    VoxelGrid grid_;
    LatentMap latent_;
    RenderRequest request_;
    std::optional<FrameSize> room_for_;  // images correct frames of this size

    FrameSchedule schedule_;
    std::array<WindowStamp, LatentWindow::kLatentsKept>
        seen_;                   // of event window k in k % kLatentsKept
    std::uint64_t encoded_ = 0;  // event windows of this stream
    std::uint64_t opened_ = 0;   // of those, whose frames next() gave or gives
    WindowStamp open_;           // whose frames are due
    SilenceGuard silence_;
    GapCarrier gaps_;
    bool follows_ = false;    // next() gave a frame, and its frames stay
    bool ended_ = false;      // the renderer was told that no window follows
    bool new_clock_ = false;  // grid_ begins another stream, which waits for the frames before
};

}  // namespace eventide
