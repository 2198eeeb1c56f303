// The other side of a topic: what a node of ROS 2 would have.
#pragma once

#include "pipeline/ros2/participant.h"

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace eventide::test {

/// More than any machine needs; nothing waits so long where all is well.
constexpr std::chrono::seconds kLimit{60};

/// "/t1234/camera": no other test's.
std::string own_name(const std::string& name);

struct ReaderSettings {
    bool reliable = true;
    int depth = 0;  ///< KEEP_LAST; 0: KEEP_ALL
};

/// Messages as they come over the wire: CDR with its four bytes of encapsulation.
class TopicReader {
public:
    TopicReader(const MessageType& type, const std::string& ros_name, ReaderSettings settings = {});

    /// Empty when none came within the limit.
    std::optional<std::vector<std::uint8_t>> next_cdr(std::chrono::milliseconds limit = kLimit);
    /// The same as a message, which lives until the next call.
    template <typename Message>
    const Message* next(std::chrono::milliseconds limit = kLimit) {
        return static_cast<const Message*>(next_sample(limit));
    }
    bool wait_for_writers(int n);
    /// What its writer said of itself, of the only one there is.
    struct Writer {
        std::string type, user_data;
        dds_reliability_kind_t reliability;
        dds_durability_kind_t durability;
    };
    Writer writer();

    ~TopicReader();

private:
    const void* next_sample(std::chrono::milliseconds limit);
    bool wait(std::chrono::milliseconds limit);

    std::shared_ptr<Participant> domain_;  // which sets the domain up
    DdsEntity participant_, topic_, reader_, waitset_;
    void* loan_ = nullptr;
};

/// A driver's topic of event packets.
class EventPublisher {
public:
    /// Of another type it can only be there.
    explicit EventPublisher(const std::string& ros_name, bool reliable = true,
                            const MessageType& type = kEventPacketType);

    struct Message {
        std::int64_t stamp_ns = 0;
        int width = 64, height = 48;
        std::uint64_t seq = 0, time_base = 0;
        std::string encoding = "mono";
        bool big_endian = false;
        std::vector<std::byte> payload;
    };
    void publish(const Message& message);
    void wait_for_readers(int n);
    /// All readers have all there is.
    void wait_until_taken();

private:
    std::shared_ptr<Participant> domain_;
    DdsEntity participant_, topic_, writer_;
};

/// FNV-1a, for comparing payloads across processes.
std::uint64_t digest(const std::vector<std::uint8_t>& bytes);

/// What a listening program prints for each message: the stamp in us and the digest of the CDR
/// behind its encapsulation, in hex, on a line of kLineBytes.
std::string message_line(const std::vector<std::uint8_t>& cdr);
constexpr std::size_t kLineBytes = 16 + 1 + 16 + 1;

/// What it prints first: it has found the topic's writer. A best-effort reader gets nothing before.
inline std::string ready_line() {
    std::string line(kLineBytes, '-');
    line.back() = '\n';
    return line;
}

}  // namespace eventide::test
