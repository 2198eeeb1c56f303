// A simulated camera as a source, in place of a real one.
#pragma once

#include "drivers/camera.h"
#include "drivers/simulated/simulated_name.h"
#include "src/codec/aedat/aedat3.h"

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace eventide {

/// Gives events and reference images as AEDAT 3.1 packets, at the pace of the host's clock or, with
/// speed 0, as fast as they are asked for. A machine too slow for the scene gives it slower: the
/// pace goes on from where it is, as the sensor's own clock would.
class SimulatedCamera final : public Camera {
public:
    static constexpr SensorDuration kChunk{2000};             ///< latency of the events
    static constexpr std::chrono::milliseconds kSilence{15};  ///< until read() says timeout
    static constexpr std::chrono::milliseconds kMaxLateness{100};

    static constexpr std::size_t kProceduralTextures = 25;

    explicit SimulatedCamera(const SimulatedSourceSettings& settings);

    const SensorInfo& info() const override { return info_; }
    bool is_live() const noexcept override { return speed_ > 0; }
    ReadStatus read(RawPacket& into) override;
    void stop() noexcept override;
    std::unique_ptr<Parser> make_parser() const override;

private:
    bool wait_until(HostTime due);
    HostTime due(SensorTime t);

    SensorInfo info_;
    double speed_;
    SimRecording recording_;
    Aedat3Writer writer_;
    Batch batch_;
    std::vector<Truth> truths_;  // stays empty
    struct Anchor {
        HostTime host;
        SensorTime sensor;
    };
    std::optional<Anchor> anchor_;

    std::mutex mutex_;
    std::condition_variable changed_;
    bool stopped_ = false;  // by mutex_
};

/// Throws Error: usage for a name that makes no sense, input for textures that cannot be read.
std::unique_ptr<SimulatedCamera> open_simulation(std::string_view source);

}  // namespace eventide
