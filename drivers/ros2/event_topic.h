// Reading event_camera_msgs/EventPacket from a ROS 2 topic.
#pragma once

#include "pipeline/ros2/participant.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace eventide {

/// One message, borrowed from the topic until its next call.
struct EventMessage {
    std::int64_t stamp_ns = 0;  ///< header.stamp: ROS time
    int width = 0, height = 0;  ///< px
    std::uint64_t seq = 0, time_base = 0;
    std::string_view encoding;
    bool big_endian = false;
    std::span<const std::byte> payload;
    std::uint64_t publisher = 0;  ///< a number for each that was ever there
};

/// Thread: one at a time, wake() excepted.
class EventTopic {
public:
    /// Messages that are kept for us: a driver sends 1000 a second.
    static constexpr int kDepth = 512;

    EventTopic(std::shared_ptr<Participant> participant, std::string ros_name);
    ~EventTopic();

    /// Whether a publisher of the topic is there, waiting at most so long: the reader is then made
    /// as reliable as that publisher is. False after wake(). Throws Error (device) where all there
    /// is on the topic is of another type.
    bool find_publisher(std::chrono::milliseconds at_most);
    /// Topics with event packets, for messages of ours.
    std::vector<std::string> event_topics() const;

    /// The next message that is there. After find_publisher() said yes.
    std::optional<EventMessage> take();
    /// Until there may be a message, at most so long, or wake().
    void wait(std::chrono::milliseconds at_most);
    int publishers() const;
    bool has_publisher(std::uint64_t publisher) const;  ///< EventMessage::publisher

    void wake() noexcept;  ///< any thread: wait() returns at once, from now on

private:
    struct Endpoint {
        std::string topic, type;
        dds_reliability_kind_t reliability;
    };
    std::vector<Endpoint> endpoints() const;
    std::vector<dds_instance_handle_t> matched_publishers() const;
    void open(dds_reliability_kind_t reliability);
    void give_back() noexcept;

    std::shared_ptr<Participant> participant_;
    std::string name_, dds_name_;
    DdsEntity discovery_, woken_, waitset_, topic_, reader_;
    dds_reliability_kind_t reliability_ = DDS_RELIABILITY_BEST_EFFORT;  // of reader_
    void* loan_ = nullptr;
};

}  // namespace eventide
