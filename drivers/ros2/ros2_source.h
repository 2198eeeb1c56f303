// Event packets of a ROS 2 driver as a source, without ROS 2.
#pragma once

#include "drivers/camera.h"
#include "drivers/devices.h"
#include "drivers/ros2/event_topic.h"
#include "drivers/ros2/ros2_source_name.h"
#include "drivers/wait_warnings.h"
#include "src/codec/event_packet.h"

#include <atomic>
#include <deque>
#include <string_view>

namespace eventide {

/// The bytes are what EventPacketParser reads. A jump of the messages' numbers is a gap. One
/// publisher is read at a time: of several the one that was heard of last, and when it has ended
/// one that goes on. With reconnect what is of another size or encoding is left out until it is as
/// it was.
class Ros2Source final : public Camera {
public:
    /// Waits for the first message, which tells size and encoding: name.wait, or with
    /// options.reconnect for ever. Throws Error: usage for the environment or options.settings,
    /// device where nothing comes, with the topics that there are, and for an encoding that is none
    /// of ours; failed where options.give_up ends the wait.
    Ros2Source(Ros2SourceName name, const CameraOptions& options);

    const SensorInfo& info() const override { return info_; }
    ReadStatus read(RawPacket& into) override;
    void stop() noexcept override;
    std::unique_ptr<Parser> make_parser() const override;

private:
    void wait_for_first(const std::function<bool()>& give_up);
    void begin(const EventMessage& message);
    void take_messages(RawPacket& into);
    void append(const EventMessage& message, std::vector<std::byte>& bytes);
    bool is_of_this_publisher(const EventMessage& message);
    bool is_gap_before(const EventMessage& message);
    bool is_as_before(const EventMessage& message);
    bool finds_less_reliable_one();
    ReadStatus lost();
    std::string label() const { return "ros2:" + name_.topic; }

    Ros2SourceName name_;
    bool reconnect_;
    WaitWarnings warnings_;
    EventTopic topic_;
    SensorInfo info_;
    std::string encoding_name_;
    EventPacketEncoding encoding_ = EventPacketEncoding::evt3;
    std::vector<std::byte> held_;  ///< the first message, or one behind a gap
    bool gap_before_held_ = false;
    std::uint64_t publisher_ = 0, next_seq_ = 0;
    std::deque<std::uint64_t> publishers_before_;
    bool is_there_ = true;  ///< the publisher
    std::atomic<bool> stopped_{false};
};

/// `which` is what follows "ros2:".
std::unique_ptr<Camera> open_ros2_source(std::string_view which, const CameraOptions& options);

}  // namespace eventide
