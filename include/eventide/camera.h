/// @file
/// Live sources: event cameras, real or simulated.
#pragma once

#include <eventide/event.h>
#include <eventide/pipeline.h>
#include <eventide/version.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace eventide {

/// How a camera is opened.
struct CameraSettings {
    /// A file of settings, as in share/eventide/cameras; empty: the defaults. Simulations and UDP
    /// have none.
    std::filesystem::path file;
    bool reconnect = false;  ///< wait for an unplugged camera to come back
    /// Called every 20 ms or so while a topic's first message is waited for: what it throws comes
    /// out of the constructor. May be empty.
    std::function<void()> while_waiting{};
    /// Told, in sentences for people, what makes no call fail: why a camera was passed over for the
    /// next one, why one is waited for and not back yet. Called by the constructor and by read(),
    /// out of which comes what it throws. May be empty.
    std::function<void(const std::string&)> warn{};
};

/// A camera that sends events from the first read() on. Thread: one at a time, stop() excepted.
class EVENTIDE_API EventCamera final : public EventSource {
public:
    /// "davis:", "dvxplorer:", "dvs128:" (the first one that can be used), "davis:SERIAL",
    /// "v4l2:/dev/video0"; "ros2:/TOPIC", event packets of a ROS 2 driver;
    /// "udp://HOST:PORT?size=640x480", events that another program sends to this address of this
    /// machine; "sim:SCENE" is one in software. Throws Error: usage for a name that makes no sense,
    /// device for a camera that is missing or cannot be used, with what to do.
    explicit EventCamera(const std::string& name, const CameraSettings& settings = {});
    ~EventCamera() override;
    EventCamera(EventCamera&&) noexcept;             ///< leaves the other empty
    EventCamera& operator=(EventCamera&&) noexcept;  ///< leaves the other empty

    const SensorInfo& info() const noexcept override;  ///< as it looks behind the filters
    int width() const noexcept;                        ///< px
    int height() const noexcept;                       ///< px

    /// Puts a filter behind the camera and its other filters, as EventReader::add_filter() does.
    void add_filter(const std::string& filter);

    /// Waits for data, at most some 20 ms: `batch` is emptied first and stays empty where none came
    /// in that time. Events are as EventReader::read() gives them. False after stop(). Throws Error
    /// (device) when the camera is lost.
    bool read(Batch& batch) override;

    /// Every event before this time has been read: what Reconstructor::advance() wants, so that
    /// frames go on while nothing moves. Empty before the first data. In a camera's silence the
    /// host's clock goes on for it; should it have stood still meanwhile (a sender that was
    /// paused), this goes back to where it is, and a Reconstructor begins anew a second later.
    std::optional<SensorTime> clock() const override;

    /// Whether data were lost before the newest batch: what Reconstructor::mark_gap() wants.
    bool gap_before() const noexcept override;

    /// False for a simulation as fast as it can be ("sim:demo?speed=max").
    bool is_live() const noexcept override;

    std::uint64_t damaged() const noexcept;  ///< places where bytes made no sense, so far

    /// Thread: any. A read() that waits returns false soon.
    void stop() noexcept override;

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace eventide
