// Topics and messages of a bag.
#include "replay/ros/ros_reader.h"

#include "src/core/error.h"

#include <utility>

namespace eventide {

namespace {

constexpr int kPartsToLookAt = 64;  // for the first image, once the first event is found

bool has_events(RosKind kind) {
    return kind == RosKind::events || kind == RosKind::packets;
}

}  // namespace

void RosReader::open(std::string_view format, const OpenOptions& options) {
    Damage damage;
    Batch unused;
    for (int parts = 0; data_.width() == 0 || parts < kPartsToLookAt; ++parts) {
        if (!read_part(damage)) break;
        for (const Message& message : messages_)
            if (message.kind == RosKind::images ? data_.image_width() == 0 : data_.width() == 0)
                data_.take(message.kind, message.bytes, unused, damage);
        messages_.clear();
        if (data_.width() > 0 && (data_.image_width() > 0 || !images_)) break;
    }
    if (data_.width() == 0) refuse(damage);
    leave_out_other_images();
    name_other_topics();
    header_.format = format;
    header_.width = options.width > 0 ? options.width : data_.width();
    header_.height = options.width > 0 ? options.height : data_.height();
    begin_anew();
}

bool RosReader::read(Batch& into, Damage& damage) {
    while (messages_.empty()) {
        if (ended_) return false;
        ended_ = !read_part(damage);
    }
    const Message message = std::move(messages_.front());
    messages_.pop_front();
    data_.take(message.kind, message.bytes, into, damage);
    return true;
}

void RosReader::begin_anew() {
    rewind();
    messages_.clear();
    data_.restart();
    ended_ = false;
}

bool RosReader::has_whole_times() const {
    return events_ && topics_.at(*events_).kind == RosKind::events;
}

void RosReader::add_topic(std::uint32_t number, std::string_view name, std::string_view type) {
    if (topics_.contains(number)) return;
    const RosKind kind = ros_kind(type);
    topics_[number] = {std::string(name), kind};
    types_.insert(std::string(type));
    if (kind == RosKind::images && !images_ && !images_refused_) images_ = number;
    if (has_events(kind) && !events_) events_ = number;
}

void RosReader::add_message(std::uint32_t number, std::span<const std::byte> bytes) {
    if (is_read(number))
        messages_.push_back({topics_[number].kind, std::vector(bytes.begin(), bytes.end())});
}

/// A topic has a number for each of its publishers.
bool RosReader::is_read(std::uint32_t number) const {
    const auto found = topics_.find(number);
    const auto is_topic_of = [&](const std::optional<std::uint32_t>& chosen) {
        return chosen && found->second.name == topics_.at(*chosen).name &&
               found->second.kind == topics_.at(*chosen).kind;
    };
    return found != topics_.end() && (is_topic_of(events_) || is_topic_of(images_));
}

void RosReader::refuse(const Damage& damage) const {
    std::string types;
    for (const std::string& type : types_) types += (types.empty() ? "" : ", ") + type;
    throw Error(ErrorKind::input,
                path_ +
                    ": expected messages with events (dvs_msgs/EventArray, "
                    "prophesee_event_msgs/EventArray, event_camera_msgs/EventPacket), found " +
                    (types.empty() ? "none" : types) + (damage.total() > 0 ? ", and damage" : ""));
}

void RosReader::leave_out_other_images() {
    if (data_.image_width() == 0 ||
        (data_.image_width() == data_.width() && data_.image_height() == data_.height()))
        return;
    remarks_.push_back("the images of " + topics_[*images_].name + " are left out: they are " +
                       std::to_string(data_.image_width()) + "x" +
                       std::to_string(data_.image_height()) + " px, the events' sensor has " +
                       std::to_string(data_.width()) + "x" + std::to_string(data_.height()));
    images_.reset();
    images_refused_ = true;
}

void RosReader::name_other_topics() {
    for (const auto& [number, topic] : topics_)
        if (!is_read(number) && has_events(topic.kind))
            remarks_.push_back("the events of " + topic.name + " are left out, those of " +
                               topics_[*events_].name + " are read");
}

}  // namespace eventide
