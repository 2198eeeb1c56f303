// Topics and messages of a bag.
#include "replay/ros/ros_reader.h"

#include "src/core/error.h"
#include "src/core/list_text.h"
#include "src/core/number_text.h"

#include <algorithm>
#include <utility>

namespace eventide {

namespace {

constexpr int kPartsToLookAt = 64;  // for the first image, once the first event is found

bool has_events(RosKind kind) {
    return kind == RosKind::events || kind == RosKind::packets;
}

/// "/davis/left" of "/davis/left/events".
std::string_view namespace_of(std::string_view topic) {
    return topic.substr(0, std::min(topic.rfind('/'), topic.size()));
}

}  // namespace

void RosReader::open(std::string_view format, const OpenOptions& options) {
    Damage damage;
    look_for_sizes(damage);
    if (!wanted_.empty() && data_.width() == 0) refuse_topic();
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
    if (message.form.kind != RosKind::images) {
        if (data_.width() == 0) data_.take(message.form, message.bytes, unused, damage);
    } else if (!size) {
        size = image_size(message.form.wire, message.bytes);
    }
}

/// Of the one chosen there is no message that can be read: the next that has some. Recorders name
/// topics of which nothing came.
bool RosReader::choose_other_events() {
    if (!events_) return false;
    for (auto& [number, topic] : topics_)
        topic.is_void |= is_read(number) && has_events(topic.form.kind);
    const auto next = std::ranges::find_if(topics_, [](const auto& each) {
        const Topic& topic = each.second;
        return has_events(topic.form.kind) && topic.has_messages && !topic.is_void;
    });
    if (next == topics_.end()) return false;
    events_ = next->first;
    return true;
}

bool RosReader::has_all_sizes() const {
    return std::ranges::all_of(topics_, [](const auto& each) {
        return each.second.form.kind != RosKind::images || each.second.size;
    });
}

bool RosReader::has_size_of_events(const Topic& topic) const {
    return topic.size && topic.size->width == data_.width() && topic.size->height == data_.height();
}

bool RosReader::read(Batch& into, Damage& damage) {
    while (messages_.empty()) {
        if (ended_) {
            data_.finish(into, damage);
            return false;
        }
        ended_ = !read_part(damage);
    }
    const Message message = std::move(messages_.front());
    messages_.pop_front();
    data_.take(message.form, message.bytes, into, damage);
    return true;
}

void RosReader::begin_anew() {
    rewind();
    messages_.clear();
    data_.restart();
    ended_ = false;
}

bool RosReader::has_whole_times() const {
    return events_ && topics_.at(*events_).form.kind == RosKind::events;
}

void RosReader::add_topic(std::uint32_t number, std::string_view name, std::string_view type,
                          RosWire wire) {
    if (topics_.contains(number)) return;
    const RosKind kind = ros_kind(type);
    topics_[number] = {std::string(name), {kind, wire}};
    types_.insert(std::string(type));
    if (kind == RosKind::images && !images_ && !images_refused_) images_ = number;
    const bool is_wanted = wanted_.empty() || wanted_ == name;
    if (has_events(kind) && is_wanted && !events_) events_ = number;
}

void RosReader::add_message(std::uint32_t number, std::span<const std::byte> bytes) {
    const auto found = topics_.find(number);
    if (found == topics_.end()) return;
    found->second.has_messages = true;
    const RosForm form = found->second.form;
    if (is_read(number) || (opening_ && form.kind == RosKind::images))
        messages_.push_back({form, number, std::vector(bytes.begin(), bytes.end())});
}

/// A topic has a number for each of its publishers.
bool RosReader::is_read(std::uint32_t number) const {
    const auto found = topics_.find(number);
    const auto is_topic_of = [&](const std::optional<std::uint32_t>& chosen) {
        return chosen && found->second.name == topics_.at(*chosen).name &&
               found->second.form == topics_.at(*chosen).form;
    };
    return found != topics_.end() && (is_topic_of(events_) || is_topic_of(images_));
}

void RosReader::refuse(const Damage& damage) const {
    throw Error(ErrorKind::input,
                path_ +
                    ": expected messages with events (dvs_msgs/EventArray, "
                    "prophesee_event_msgs/EventArray, event_camera_msgs/EventPacket), found " +
                    (types_.empty() ? "none" : list_of(types_)) +
                    (damage.total() > 0 ? ", and damage" : ""));
}

void RosReader::refuse_topic() const {
    std::set<std::string> names;
    for (const auto& [number, topic] : topics_)
        if (has_events(topic.form.kind) && topic.has_messages) names.insert(topic.name);
    throw Error(ErrorKind::usage, path_ + ": expected events of the topic '" + wanted_ +
                                      "' that can be read, found " +
                                      (names.empty() ? "none" : "events of " + list_of(names)));
}

/// Images in the namespace of events that are not read: of a stereo pair the other one's.
bool RosReader::is_of_other_camera(const Topic& images) const {
    const std::string_view name = namespace_of(images.name);
    const auto has_events_there = [&](const auto& each) {
        return has_events(each.second.form.kind) && namespace_of(each.second.name) == name;
    };
    return name != namespace_of(topics_.at(*events_).name) &&
           std::ranges::any_of(topics_, has_events_there);
}

/// The first of the events' size, in their namespace if there is one; else the first that did not
/// tell its own.
void RosReader::choose_images() {
    if (!images_) return;
    const auto choose = [&](auto&& is_wanted) {
        const auto found = std::ranges::find_if(topics_, [&](const auto& each) {
            return each.second.form.kind == RosKind::images && !is_of_other_camera(each.second) &&
                   is_wanted(each.second);
        });
        if (found != topics_.end()) images_ = found->first;
        return found != topics_.end();
    };
    const std::string_view camera = namespace_of(topics_.at(*events_).name);
    if (choose([&](const Topic& topic) {
            return has_size_of_events(topic) && namespace_of(topic.name) == camera;
        }) ||
        choose([&](const Topic& topic) { return has_size_of_events(topic); }) ||
        choose([](const Topic& topic) { return !topic.size; }))
        return;
    images_.reset();
    images_refused_ = true;
}

void RosReader::name_other_topics() {
    std::set<std::string> named;
    for (const auto& [number, topic] : topics_) {
        const bool images = topic.form.kind == RosKind::images;
        if (is_read(number) || (!images && !has_events(topic.form.kind))) continue;
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
        else if (images && !images_)
            remarks_.push_back(what + " are left out: they are of another camera");
        else if (images)
            remarks_.push_back(what + " are left out, those of " + topics_[*images_].name +
                               " are read");
        else
            remarks_.push_back(left_out_stream(topic.name, topics_[*events_].name, topic.name));
    }
}

}  // namespace eventide
