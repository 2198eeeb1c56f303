// Reading event_camera_msgs/EventPacket from a ROS 2 topic.
#include "drivers/ros2/event_topic.h"

#include "src/core/error.h"

#include <algorithm>
#include <array>

namespace eventide {

namespace {

using Packet = event_camera_msgs_msg_dds__EventPacket_;
using Clock = std::chrono::steady_clock;

/// "event_array_msgs::msg::dds_::EventArray_" -> "event_array_msgs/msg/EventArray"
std::string ros_type_name(std::string dds_name) {
    const auto replace = [&](std::string_view from, std::string_view to) {
        if (const auto at = dds_name.find(from); at != dds_name.npos)
            dds_name.replace(at, from.size(), to);
    };
    replace("::msg::dds_::", "/msg/");
    if (dds_name.ends_with('_')) dds_name.pop_back();
    return dds_name;
}

EventMessage message_of(const Packet& packet, std::uint64_t publisher) {
    constexpr std::int64_t kSecond = 1'000'000'000;
    EventMessage message;
    message.stamp_ns = packet.header.stamp.sec * kSecond + packet.header.stamp.nanosec;
    message.width = int(packet.width);
    message.height = int(packet.height);
    message.seq = packet.seq;
    message.time_base = packet.time_base;
    message.encoding = packet.encoding;
    message.big_endian = packet.is_bigendian;
    message.payload = {reinterpret_cast<const std::byte*>(packet.events._buffer),
                       packet.events._length};
    message.publisher = publisher;
    return message;
}

}  // namespace

EventTopic::EventTopic(std::shared_ptr<Participant> participant, std::string ros_name)
    : participant_{std::move(participant)},
      name_{std::move(ros_name)},
      dds_name_{dds_topic_name(name_)},
      discovery_{dds().dds_create_reader(participant_->handle(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION,
                                         nullptr, nullptr),
                 "look for publishers"},
      woken_{dds().dds_create_guardcondition(participant_->handle()), "wait for messages"},
      waitset_{dds().dds_create_waitset(participant_->handle()), "wait for messages"} {
    check_dds(dds().dds_set_status_mask(discovery_.get(), DDS_DATA_AVAILABLE_STATUS),
              "look for publishers");
    check_dds(dds().dds_waitset_attach(waitset_.get(), woken_.get(), 0), "wait for messages");
}

EventTopic::~EventTopic() {
    give_back();
}

std::vector<EventTopic::Endpoint> EventTopic::endpoints() const {
    constexpr std::size_t kMax = 4096;
    std::vector<Endpoint> found;
    // Read, not taken: what was seen stays there until its publisher goes.
    std::vector<void*> samples(kMax, nullptr);
    std::vector<dds_sample_info_t> infos(kMax);
    const dds_return_t n =
        dds().dds_read(discovery_.get(), samples.data(), infos.data(), kMax, std::uint32_t(kMax));
    check_dds(n, "look for publishers");
    for (std::size_t i = 0; i < std::size_t(n); ++i) {
        if (!infos[i].valid_data || infos[i].instance_state != DDS_IST_ALIVE) continue;
        const auto& endpoint = *static_cast<const dds_builtintopic_endpoint_t*>(samples[i]);
        dds_reliability_kind_t reliability = DDS_RELIABILITY_BEST_EFFORT;
        dds().dds_qget_reliability(endpoint.qos, &reliability, nullptr);
        found.push_back({endpoint.topic_name, endpoint.type_name, reliability});
    }
    if (n > 0) dds().dds_return_loan(discovery_.get(), samples.data(), n);
    return found;
}

std::vector<std::string> EventTopic::event_topics() const {
    std::vector<std::string> topics;
    for (const Endpoint& endpoint : endpoints())
        if (endpoint.type == kEventPacketType.descriptor.m_typename &&
            endpoint.topic.starts_with("rt/"))
            topics.push_back(endpoint.topic.substr(2));
    std::ranges::sort(topics);
    topics.erase(std::unique(topics.begin(), topics.end()), topics.end());
    return topics;
}

bool EventTopic::find_publisher(std::chrono::milliseconds at_most) {
    const auto until = Clock::now() + at_most;
    while (true) {
        std::string other_type;
        for (const Endpoint& endpoint : endpoints()) {
            if (endpoint.topic != dds_name_) continue;
            if (endpoint.type == kEventPacketType.descriptor.m_typename) {
                open(endpoint.reliability);
                return true;
            }
            other_type = ros_type_name(endpoint.type);
        }
        if (!other_type.empty())
            throw Error(ErrorKind::device, "ros2:" + name_ + ": expected a topic of type " +
                                               std::string{kEventPacketType.name} + ", found " +
                                               other_type);
        if (Clock::now() >= until) return false;
        // What is discovered is no event of the waitset's own: it is looked for ten times a second.
        constexpr std::chrono::milliseconds kLook{100};
        const auto left =
            std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now());
        std::array<dds_attach_t, 1> woken{};
        const dds_return_t n = dds().dds_waitset_wait(
            waitset_.get(), woken.data(), woken.size(),
            DDS_MSECS(std::clamp<std::int64_t>(left.count(), 0, kLook.count())));
        if (n > 0 && woken[0] == 0) return false;
    }
}

/// As reliable as the publisher is: more would be refused, less would lose what it need not.
void EventTopic::open(dds_reliability_kind_t reliability) {
    if (reader_.get() > 0 && reliability == reliability_) return;
    reliability_ = reliability;
    give_back();
    reader_ = {};
    topic_ = DdsEntity{dds().dds_create_topic(participant_->handle(), &kEventPacketType.descriptor,
                                              dds_name_.c_str(), nullptr, nullptr),
                       "read the topic " + name_};
    const DdsQos qos = make_dds_qos();
    dds().dds_qset_reliability(qos.get(), reliability, DDS_MSECS(100));
    dds().dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, kDepth);
    dds().dds_qset_durability(qos.get(), DDS_DURABILITY_VOLATILE);
    const std::string user_data = "typehash=" + std::string{kEventPacketType.hash} + ";";
    dds().dds_qset_userdata(qos.get(), user_data.data(), user_data.size());
    reader_ =
        DdsEntity{dds().dds_create_reader(participant_->handle(), topic_.get(), qos.get(), nullptr),
                  "read the topic " + name_};
    check_dds(dds().dds_set_status_mask(reader_.get(), DDS_DATA_AVAILABLE_STATUS),
              "wait for messages");
    check_dds(dds().dds_waitset_attach(waitset_.get(), reader_.get(), 1), "wait for messages");
}

void EventTopic::give_back() noexcept {
    if (loan_ != nullptr) dds().dds_return_loan(reader_.get(), &loan_, 1);
    loan_ = nullptr;
}

std::optional<EventMessage> EventTopic::take() {
    while (true) {
        give_back();
        dds_sample_info_t info{};
        const dds_return_t n = dds().dds_take(reader_.get(), &loan_, &info, 1, 1);
        check_dds(n, "take a message of " + name_);
        if (n == 0) {
            loan_ = nullptr;
            return std::nullopt;
        }
        // Else a publisher went away.
        if (info.valid_data)
            return message_of(*static_cast<const Packet*>(loan_), info.publication_handle);
    }
}

void EventTopic::wait(std::chrono::milliseconds at_most) {
    check_dds(dds().dds_waitset_wait(waitset_.get(), nullptr, 0, DDS_MSECS(at_most.count())),
              "wait for messages");
}

std::vector<dds_instance_handle_t> EventTopic::matched_publishers() const {
    constexpr std::size_t kMax = 64;
    std::vector<dds_instance_handle_t> handles(kMax);
    const dds_return_t n = dds().dds_get_matched_publications(reader_.get(), handles.data(), kMax);
    check_dds(n, "count the publishers of " + name_);
    handles.resize(std::min(std::size_t(n), kMax));  // it tells how many there are
    return handles;
}

int EventTopic::publishers() const {
    return int(matched_publishers().size());
}

bool EventTopic::has_publisher(std::uint64_t publisher) const {
    return std::ranges::count(matched_publishers(), publisher) > 0;
}

void EventTopic::wake() noexcept {
    dds().dds_set_guardcondition(woken_.get(), true);
}

}  // namespace eventide
