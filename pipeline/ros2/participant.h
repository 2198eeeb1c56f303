// Our place in a DDS domain, and what is written and read there.
#pragma once

#include "pipeline/ros2/dds_library.h"
#include "pipeline/ros2/environment.h"
#include "pipeline/ros2/message_types.h"

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace eventide {

/// An entity of Cyclone DDS, and those below it; deleted with this object.
class DdsEntity {
public:
    DdsEntity() = default;
    /// `handle` as Cyclone returned it. Throws Error (failed) where that is an error; `doing` is
    /// what was tried: "create a topic".
    DdsEntity(dds_entity_t handle, const std::string& doing);
    ~DdsEntity();
    DdsEntity(DdsEntity&& other) noexcept;
    DdsEntity& operator=(DdsEntity&& other) noexcept;

    dds_entity_t get() const { return handle_; }

private:
    dds_entity_t handle_ = 0;
};

/// Throws Error (failed) where `code` is an error.
void check_dds(dds_return_t code, const std::string& doing);

using DdsQos = std::unique_ptr<dds_qos_t, void (*)(dds_qos_t*)>;
DdsQos make_dds_qos();

/// One for the whole process, as a domain can be set up only once. Its threads are Cyclone's and
/// live as long as it does.
class Participant {
public:
    /// Joins the domain that the environment names, or gives the participant that is there already.
    /// Throws Error: usage for the environment, failed with Cyclone's own words. Thread: any.
    static std::shared_ptr<Participant> join();

    explicit Participant(Ros2Environment environment);

    dds_entity_t handle() const { return participant_.get(); }
    unsigned domain() const { return environment_.domain; }
    /// What Cyclone warned of while it was set up; for people, may be empty.
    const std::string& warnings() const { return warnings_; }

private:
    Ros2Environment environment_;
    std::string warnings_;
    DdsEntity domain_;
    DdsEntity participant_;  // before the domain, which it is part of
};

/// "/camera/image_raw" -> "rt/camera/image_raw", what ROS 2 calls a topic in DDS.
std::string dds_topic_name(std::string_view ros_name);

/// Writes one topic as ROS 2's publishers of images do: reliable, the last 5, nothing for those
/// who come late. It waits for nobody: a reader that is behind misses what is older than the
/// last 5.
class Ros2Writer {
public:
    static constexpr int kDepth = 5;

    /// Throws Error (failed).
    Ros2Writer(std::shared_ptr<Participant> participant, const MessageType& type,
               const std::string& ros_name);

    /// How many readers there are now.
    int readers() const;
    /// Waits until there are `n` readers. `give_up` (may be empty) is asked ten times a second;
    /// false when it says so.
    bool wait_for_readers(int n, const std::function<bool()>& give_up);
    /// `message` is of the type's C struct and stays the caller's. Throws Error (failed).
    void write(const void* message);
    /// Waits until all readers have all there is, at most so long.
    void wait_for_readers_to_take_all(std::chrono::milliseconds at_most);

private:
    std::shared_ptr<Participant> participant_;
    std::string name_;
    DdsEntity topic_, writer_;
};

}  // namespace eventide
