// Event packets of a ROS 2 driver as a source.
#include "drivers/ros2/ros2_source.h"

#include "src/core/error.h"
#include "src/core/list_text.h"
#include "src/core/sensor_limits.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace eventide {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kReadTimeout = 20ms;
constexpr std::size_t kEnoughBytes = 256 << 10;  // of messages at once

std::string list_text(const std::vector<std::string>& names) {
    return names.empty() ? "none" : list_of(names);
}

}  // namespace

Ros2Source::Ros2Source(Ros2SourceName name, const CameraOptions& options)
    : name_{std::move(name)},
      reconnect_{options.reconnect},
      warnings_{options.warn},
      topic_{Participant::join(), name_.topic} {
    if (!options.settings.empty())
        throw Error(ErrorKind::usage, label() +
                                          ": expected no camera settings, as the driver "
                                          "that publishes has them; found " +
                                          options.settings.string());
    wait_for_first(options.give_up);
}

void Ros2Source::wait_for_first(const std::function<bool()>& give_up) {
    const auto until = Clock::now() + name_.wait;
    bool heard_of_one = false;
    while (true) {
        if (give_up && give_up())
            throw Error(ErrorKind::failed, label() + ": stopped before the first message");
        if (topic_.find_publisher(kReadTimeout)) {
            heard_of_one = true;
            if (const auto message = topic_.take()) return begin(*message);
            topic_.wait(kReadTimeout);
        }
        if (Clock::now() < until || reconnect_) continue;
        if (heard_of_one)
            throw Error(ErrorKind::device, label() + ": its publisher sent nothing in " +
                                               std::to_string(name_.wait.count() / 1000) +
                                               " ms; ?wait=60s waits longer");
        throw Error(ErrorKind::device,
                    label() + ": expected a publisher, found none in " +
                        std::to_string(name_.wait.count() / 1000) +
                        " ms; topics of event packets there: " + list_text(topic_.event_topics()) +
                        " (see ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY; ?wait=60s waits longer)");
    }
}

void Ros2Source::begin(const EventMessage& message) {
    encoding_name_ = message.encoding;
    const auto encoding = event_packet_encoding(message.encoding);
    if (!encoding)
        throw Error(ErrorKind::device, label() +
                                           ": expected encoding evt3, libcaer, libcaer_cmp or "
                                           "mono, found '" +
                                           encoding_name_ + "'");
    if (message.big_endian)
        throw Error(ErrorKind::device,
                    label() + ": expected little-endian packets, found big-endian ones");
    if (message.width < 1 || message.width > kLargestSensorSide || message.height < 1 ||
        message.height > kLargestSensorSide)
        throw Error(ErrorKind::device, label() + ": expected a sensor of 1 to " +
                                           std::to_string(kLargestSensorSide) +
                                           " px each way, found " + std::to_string(message.width) +
                                           "x" + std::to_string(message.height));
    encoding_ = *encoding;
    info_.name = "ROS 2 " + name_.topic;
    info_.format = encoding_name_;
    info_.width = message.width;
    info_.height = message.height;
    publisher_ = message.publisher;
    next_seq_ = message.seq + 1;
    append(message, held_);
}

ReadStatus Ros2Source::read(RawPacket& into) {
    into.bytes.clear();
    into.gap_before = false;
    if (stopped_) return ReadStatus::end;
    if (!held_.empty()) {
        into.bytes.swap(held_);
        into.gap_before = std::exchange(gap_before_held_, false);
    }
    take_messages(into);
    if (into.bytes.empty()) {
        topic_.wait(kReadTimeout);
        take_messages(into);
    }
    if (into.bytes.empty() && topic_.publishers() == 0) {
        take_messages(into);  // what came before it went
        if (into.bytes.empty()) return lost();
    }
    if (into.bytes.empty()) return stopped_ ? ReadStatus::end : ReadStatus::timeout;
    if (!std::exchange(is_there_, true)) {
        count(CameraCount::reconnects);
        warnings_.is_back();
        into.gap_before = true;
    }
    into.arrived = Clock::now();
    return ReadStatus::data;
}

/// What is there, up to the next gap.
void Ros2Source::take_messages(RawPacket& into) {
    while (held_.empty() && into.bytes.size() < kEnoughBytes) {
        const auto message = topic_.take();
        if (!message) return;
        if (!is_as_before(*message) || !is_of_this_publisher(*message)) continue;
        const bool gap = is_gap_before(*message);
        if (gap && !into.bytes.empty()) {
            append(*message, held_);
            gap_before_held_ = true;
            return;
        }
        into.gap_before |= gap;
        append(*message, into.bytes);
    }
}

/// One that is new takes over; what the one before still sends is left out, unless the new one has
/// ended meanwhile.
bool Ros2Source::is_of_this_publisher(const EventMessage& message) {
    constexpr std::size_t kMax = 64;
    if (message.publisher == publisher_) return true;
    const auto before = std::ranges::find(publishers_before_, message.publisher);
    if (before != publishers_before_.end()) {
        if (topic_.has_publisher(publisher_)) return false;
        publishers_before_.erase(before);
    }
    publishers_before_.push_back(publisher_);
    if (publishers_before_.size() > kMax) publishers_before_.pop_front();
    publisher_ = message.publisher;
    next_seq_ = message.seq + 1;
    gap_before_held_ = true;
    return true;
}

void Ros2Source::append(const EventMessage& message, std::vector<std::byte>& bytes) {
    append_event_packet({message.time_base, message.stamp_ns}, message.payload, bytes);
    count(CameraCount::transfers);
    count(CameraCount::bytes, message.payload.size());
}

/// A jump forward is as many messages lost; back, that the publisher counts anew.
bool Ros2Source::is_gap_before(const EventMessage& message) {
    const bool jump = message.seq != next_seq_ && message.seq + 1 != next_seq_;
    if (message.seq > next_seq_) count(CameraCount::lost_transfers, message.seq - next_seq_);
    next_seq_ = message.seq + 1;
    return std::exchange(gap_before_held_, false) || jump;
}

bool Ros2Source::is_as_before(const EventMessage& message) {
    if (message.width == info_.width && message.height == info_.height &&
        message.encoding == encoding_name_ && !message.big_endian)
        return true;
    const Error error{ErrorKind::device,
                      label() + ": expected " + std::to_string(info_.width) + "x" +
                          std::to_string(info_.height) + " " + encoding_name_ +
                          " as before, found " + std::to_string(message.width) + "x" +
                          std::to_string(message.height) + " " + std::string{message.encoding} +
                          (message.big_endian ? ", big-endian" : "")};
    if (!reconnect_) throw error;
    warnings_.tell(error);
    return false;
}

/// The reader is as reliable as the publisher that went away was, and hears none that is less.
bool Ros2Source::finds_less_reliable_one() {
    try {
        return topic_.find_publisher(std::chrono::milliseconds{0}) && topic_.publishers() > 0;
    } catch (const Error& error) {  // of another type
        if (reconnect_) warnings_.tell(error);
        return false;
    }
}

ReadStatus Ros2Source::lost() {
    is_there_ = false;
    if (!finds_less_reliable_one() && !reconnect_)
        throw Error(ErrorKind::device, label() + ": its publisher went away" + kReconnect);
    return stopped_ ? ReadStatus::end : ReadStatus::timeout;
}

void Ros2Source::stop() noexcept {
    stopped_ = true;
    topic_.wake();
}

std::unique_ptr<Parser> Ros2Source::make_parser() const {
    return std::make_unique<EventPacketParser>(encoding_, info_.width, info_.height);
}

std::unique_ptr<Camera> open_ros2_source(std::string_view which, const CameraOptions& options) {
    return std::make_unique<Ros2Source>(parse_ros2_source_name(which), options);
}

}  // namespace eventide
