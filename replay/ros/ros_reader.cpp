// Topics and messages of a bag.
#include "replay/ros/ros_reader.h"

#include "src/core/error.h"
#include "src/core/number_text.h"

#include <algorithm>
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
    look_for_sizes(damage);
    while (data_.width() == 0 && choose_other_events()) {
        begin_anew();
        look_for_sizes(damage);
    }
    if (data_.width() == 0) refuse(damage);
    opening_ = false;
    choose_images();
    name_other_topics();
    header_.format = format;
    header_.width = options.width > 0 ? options.width : data_.width();
    header_.height = options.width > 0 ? options.height : data_.height();
    begin_anew();
}

void RosReader::look_for_sizes(Damage& damage) {
    for (int parts = 0; data_.width() == 0 || parts < kPartsToLookAt; ++parts) {
        const bool goes_on = read_part(damage);
        for (const Message& message : messages_) look_at(message, damage);
        messages_.clear();
        if (!goes_on || (data_.width() > 0 && has_all_sizes())) break;
    }
}

void RosReader::look_at(const Message& message, Damage& damage) {
    Batch unused;
    auto& size = topics_[message.topic].size;
    if (message.kind != RosKind::images) {
        if (data_.width() == 0) data_.take(message.kind, message.bytes, unused, damage);
    } else if (!size) {
        size = data_.image_size(message.bytes);
    }
}

/// Of the one chosen there is no message that can be read: the next that has some. Recorders name
/// topics of which nothing came.
bool RosReader::choose_other_events() {
    if (!events_) return false;
    for (auto& [number, topic] : topics_)
        topic.is_void |= is_read(number) && has_events(topic.kind);
    const auto next = std::ranges::find_if(topics_, [](const auto& each) {
        const Topic& topic = each.second;
        return has_events(topic.kind) && topic.has_messages && !topic.is_void;
    });
    if (next == topics_.end()) return false;
    events_ = next->first;
    return true;
}

bool RosReader::has_all_sizes() const {
    return std::ranges::all_of(topics_, [](const auto& each) {
        return each.second.kind != RosKind::images || each.second.size;
    });
}

bool RosReader::has_size_of_events(const Topic& topic) const {
    return topic.size && topic.size->width == data_.width() && topic.size->height == data_.height();
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
    const auto found = topics_.find(number);
    if (found == topics_.end()) return;
    found->second.has_messages = true;
    const RosKind kind = found->second.kind;
    if (is_read(number) || (opening_ && kind == RosKind::images))
        messages_.push_back({kind, number, std::vector(bytes.begin(), bytes.end())});
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

/// The first of the events' size; else the first that did not tell its own.
void RosReader::choose_images() {
    if (!images_ || has_size_of_events(topics_[*images_])) return;
    const auto choose = [&](auto&& is_wanted) {
        const auto found = std::ranges::find_if(topics_, [&](const auto& each) {
            return each.second.kind == RosKind::images && is_wanted(each.second);
        });
        if (found != topics_.end()) images_ = found->first;
        return found != topics_.end();
    };
    if (choose([&](const Topic& topic) { return has_size_of_events(topic); })) return;
    if (!topics_[*images_].size || choose([](const Topic& topic) { return !topic.size; })) return;
    images_.reset();
    images_refused_ = true;
}

void RosReader::name_other_topics() {
    std::set<std::string> named;
    for (const auto& [number, topic] : topics_) {
        const bool images = topic.kind == RosKind::images;
        if (is_read(number) || (!images && !has_events(topic.kind))) continue;
        const std::string what = (images ? "the images of " : "the events of ") + topic.name;
        if (!named.insert(what).second) continue;
        if (topic.is_void)
            remarks_.push_back(topic.name + " has no events that can be read; those of " +
                               topics_[*events_].name + " are read");
        else if (images && topic.size && !has_size_of_events(topic))
            remarks_.push_back(what + " are left out: they are " +
                               size_text(topic.size->width, topic.size->height) +
                               " px, the events' sensor has " +
                               size_text(data_.width(), data_.height()));
        else
            remarks_.push_back(what + " are left out, those of " +
                               topics_[images ? *images_ : *events_].name + " are read");
    }
}

}  // namespace eventide
