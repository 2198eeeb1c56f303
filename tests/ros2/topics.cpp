#include "tests/ros2/topics.h"

#include <dds/ddsi/ddsi_serdata.h>

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

namespace eventide::test {

namespace {

dds_domainid_t domain_of(const Participant& participant) {
    return participant.domain();
}

void require(bool holds, const char* what) {
    if (!holds) throw std::runtime_error(what);
}

}  // namespace

std::string own_name(const std::string& name) {
    const char* owner = std::getenv("TEST_DOMAIN_OF");
    return "/t" + std::string{owner == nullptr ? "" : owner} + name;
}

TopicReader::TopicReader(const MessageType& type, const std::string& ros_name,
                         ReaderSettings settings)
    : domain_{Participant::join()},
      participant_{dds_create_participant(domain_of(*domain_), nullptr, nullptr), "join"},
      topic_{dds_create_topic(participant_.get(), &type.descriptor,
                              dds_topic_name(ros_name).c_str(), nullptr, nullptr),
             "create a topic"} {
    const DdsQos qos = make_dds_qos();
    dds_qset_reliability(qos.get(),
                         settings.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                         DDS_MSECS(100));
    if (settings.depth > 0)
        dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, settings.depth);
    else
        dds_qset_history(qos.get(), DDS_HISTORY_KEEP_ALL, 0);
    reader_ = DdsEntity{dds_create_reader(participant_.get(), topic_.get(), qos.get(), nullptr),
                        "create a reader"};
    waitset_ = DdsEntity{dds_create_waitset(participant_.get()), "create a waitset"};
    check_dds(dds_set_status_mask(reader_.get(),
                                  DDS_DATA_AVAILABLE_STATUS | DDS_SUBSCRIPTION_MATCHED_STATUS),
              "set a mask");
    check_dds(dds_waitset_attach(waitset_.get(), reader_.get(), 0), "attach");
}

TopicReader::~TopicReader() {
    if (loan_ != nullptr) dds_return_loan(reader_.get(), &loan_, 1);
}

bool TopicReader::wait(std::chrono::milliseconds limit) {
    std::uint32_t status = 0;
    dds_take_status(reader_.get(), &status, DDS_SUBSCRIPTION_MATCHED_STATUS);
    return dds_waitset_wait(waitset_.get(), nullptr, 0, DDS_MSECS(limit.count())) > 0;
}

std::optional<std::vector<std::uint8_t>> TopicReader::next_cdr(std::chrono::milliseconds limit) {
    const auto until = std::chrono::steady_clock::now() + limit;
    while (true) {
        ddsi_serdata* data = nullptr;
        dds_sample_info_t info{};
        const dds_return_t n = dds_takecdr(reader_.get(), &data, 1, &info, DDS_ANY_STATE);
        check_dds(n, "take");
        if (n == 1) {
            std::vector<std::uint8_t> bytes(ddsi_serdata_size(data));
            ddsi_serdata_to_ser(data, 0, bytes.size(), bytes.data());
            ddsi_serdata_unref(data);
            if (info.valid_data) return bytes;
            continue;
        }
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
            until - std::chrono::steady_clock::now());
        if (left.count() <= 0) return std::nullopt;
        wait(std::min(left, std::chrono::milliseconds{100}));
    }
}

const void* TopicReader::next_sample(std::chrono::milliseconds limit) {
    const auto until = std::chrono::steady_clock::now() + limit;
    while (true) {
        if (loan_ != nullptr) dds_return_loan(reader_.get(), &loan_, 1);
        loan_ = nullptr;
        dds_sample_info_t info{};
        const dds_return_t n = dds_take(reader_.get(), &loan_, &info, 1, 1);
        check_dds(n, "take");
        if (n == 1 && info.valid_data) return loan_;
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
            until - std::chrono::steady_clock::now());
        if (n == 0) loan_ = nullptr;
        if (left.count() <= 0) return nullptr;
        if (n == 0) wait(std::min(left, std::chrono::milliseconds{100}));
    }
}

bool TopicReader::wait_for_writers(int n) {
    const auto until = std::chrono::steady_clock::now() + kLimit;
    while (std::chrono::steady_clock::now() < until) {
        dds_subscription_matched_status_t status{};
        check_dds(dds_get_subscription_matched_status(reader_.get(), &status), "count writers");
        if (int(status.current_count) == n) return true;
        wait(std::chrono::milliseconds{100});
    }
    return false;
}

TopicReader::Writer TopicReader::writer() {
    dds_instance_handle_t handle{};
    require(dds_get_matched_publications(reader_.get(), &handle, 1) == 1, "expected one writer");
    dds_builtintopic_endpoint_t* endpoint = dds_get_matched_publication_data(reader_.get(), handle);
    require(endpoint != nullptr, "expected data of the writer");
    Writer writer{endpoint->type_name, {}, DDS_RELIABILITY_BEST_EFFORT, DDS_DURABILITY_PERSISTENT};
    dds_qget_reliability(endpoint->qos, &writer.reliability, nullptr);
    dds_qget_durability(endpoint->qos, &writer.durability);
    void* data = nullptr;
    std::size_t size = 0;
    if (dds_qget_userdata(endpoint->qos, &data, &size) && data != nullptr)
        writer.user_data.assign(static_cast<const char*>(data), size);
    dds_free(data);
    dds_builtintopic_free_endpoint(endpoint);
    return writer;
}

EventPublisher::EventPublisher(const std::string& ros_name, bool reliable, const MessageType& type)
    : domain_{Participant::join()},
      participant_{dds_create_participant(domain_of(*domain_), nullptr, nullptr), "join"},
      topic_{dds_create_topic(participant_.get(), &type.descriptor,
                              dds_topic_name(ros_name).c_str(), nullptr, nullptr),
             "create a topic"} {
    const DdsQos qos = make_dds_qos();
    dds_qset_reliability(
        qos.get(), reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, DDS_SECS(10));
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, 1000);
    writer_ = DdsEntity{dds_create_writer(participant_.get(), topic_.get(), qos.get(), nullptr),
                        "create a writer"};
}

void EventPublisher::publish(const Message& message) {
    event_camera_msgs_msg_dds__EventPacket_ packet{};
    packet.header.stamp.sec = std::int32_t(message.stamp_ns / 1'000'000'000);
    packet.header.stamp.nanosec = std::uint32_t(message.stamp_ns % 1'000'000'000);
    packet.header.frame_id = const_cast<char*>("camera");
    packet.width = std::uint32_t(message.width);
    packet.height = std::uint32_t(message.height);
    packet.seq = message.seq;
    packet.time_base = message.time_base;
    packet.encoding = const_cast<char*>(message.encoding.c_str());
    packet.is_bigendian = message.big_endian;
    packet.events._length = packet.events._maximum = std::uint32_t(message.payload.size());
    packet.events._buffer =
        reinterpret_cast<std::uint8_t*>(const_cast<std::byte*>(message.payload.data()));
    check_dds(dds_write(writer_.get(), &packet), "publish");
}

void EventPublisher::wait_for_readers(int n) {
    const auto until = std::chrono::steady_clock::now() + kLimit;
    const DdsEntity wait{dds_create_waitset(participant_.get()), "create a waitset"};
    check_dds(dds_set_status_mask(writer_.get(), DDS_PUBLICATION_MATCHED_STATUS), "set a mask");
    check_dds(dds_waitset_attach(wait.get(), writer_.get(), 0), "attach");
    while (std::chrono::steady_clock::now() < until) {
        dds_publication_matched_status_t status{};
        check_dds(dds_get_publication_matched_status(writer_.get(), &status), "count readers");
        if (int(status.current_count) == n) return;
        dds_waitset_wait(wait.get(), nullptr, 0, DDS_MSECS(100));
    }
    throw std::runtime_error("no reader came");
}

void EventPublisher::wait_until_taken() {
    check_dds(dds_wait_for_acks(writer_.get(), DDS_SECS(kLimit.count())), "wait for readers");
}

std::uint64_t digest(const std::vector<std::uint8_t>& bytes) {
    std::uint64_t hash = 0xCBF29CE484222325U;
    for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 0x100000001B3U;
    return hash;
}

std::string message_line(const std::vector<std::uint8_t>& cdr) {
    require(cdr.size() >= 12, "expected a message with a header");
    std::int32_t sec = 0;
    std::uint32_t nanosec = 0;
    std::memcpy(&sec, cdr.data() + 4, 4);
    std::memcpy(&nanosec, cdr.data() + 8, 4);
    const auto stamp_us = std::uint64_t(sec) * 1'000'000 + nanosec / 1000;
    char line[kLineBytes + 1];
    std::snprintf(line, sizeof line, "%016llx %016llx\n", static_cast<unsigned long long>(stamp_us),
                  static_cast<unsigned long long>(digest({cdr.begin() + 4, cdr.end()})));
    return line;
}

}  // namespace eventide::test
