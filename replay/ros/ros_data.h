// Messages of ROS 1 and 2 with events and images, as data.
#pragma once

#include "src/codec/event_packet.h"
#include "src/core/damage.h"
#include "src/core/event.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace eventide {

/// How messages are bytes: ROS 1's own way, or CDR with its four bytes in front.
enum class RosWire { ros1, cdr };

enum class RosKind {
    other,
    events,   ///< dvs_msgs/EventArray, prophesee_event_msgs/EventArray
    packets,  ///< event_camera_msgs/EventPacket
    images    ///< sensor_msgs/Image
};

/// The kind of messages of this type, whose name may be with or without ROS 2's "/msg".
RosKind ros_kind(std::string_view type);

/// What a topic's messages are.
struct RosForm {
    RosKind kind = RosKind::other;
    RosWire wire = RosWire::cdr;
    friend bool operator==(const RosForm&, const RosForm&) = default;
};

struct RosImageSize {
    int width = 0, height = 0;  ///< px
};

/// Time of the first event in a message of kind events. Empty where there is none.
std::optional<SensorTime> first_time(RosWire wire, std::span<const std::byte> message);
/// Size of the image in a message of kind images. Empty where it is cut short. One of another size
/// than the events' is not the event camera's.
std::optional<RosImageSize> image_size(RosWire wire, std::span<const std::byte> message);

/// The messages of one topic with events and one with images, in order.
class RosData {
public:
    /// Appends what the message holds. False, and nothing appended, where it is cut short or says
    /// what cannot be (then damage is counted). Times are ROS's: those of packets are shifted as
    /// EventPacketParser does.
    bool take(RosForm form, std::span<const std::byte> message, Batch& into, Damage& damage);

    /// There are no more: appends what waited for one that could contradict it.
    void finish(Batch& into, Damage& damage);

    /// px, as the messages with events say; 0 before the first.
    int width() const { return width_; }
    int height() const { return height_; }

    /// What comes next is the beginning once more.
    void restart();

private:
    template <typename Reader>
    bool take_with(Reader reader, RosKind kind, Batch& into, Damage& damage);
    template <typename Reader>
    bool take_events(Reader& reader, Batch& into, Damage& damage);
    template <typename Reader>
    bool take_packet(Reader& reader, Batch& into, Damage& damage);
    template <typename Reader>
    bool take_image(Reader& reader, Batch& into);
    bool take_size(std::uint32_t width, std::uint32_t height);
    bool is_gap_before(std::uint64_t sequence);
    void count_damage_of_packets(Damage& damage);

    int width_ = 0, height_ = 0;
    std::optional<EventPacketParser> packets_;
    std::string encoding_;
    Damage packet_damage_;                   ///< of packets_, what was counted already
    std::optional<std::uint64_t> sequence_;  ///< of the packet before
    std::vector<std::byte> packet_;
};

}  // namespace eventide
