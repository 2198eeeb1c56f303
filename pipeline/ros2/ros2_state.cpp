// What `eventide doctor` says of ROS 2.
#include "pipeline/ros2/participant.h"
#include "pipeline/ros2/ros2_sink.h"
#include "pipeline/ros2/socket_buffer.h"
#include "src/core/environment.h"
#include "src/core/error.h"

#include <dds/ddsrt/log.h>
#include <dds/version.h>

#include <mutex>
#include <string_view>

namespace eventide {

namespace {

/// So that Cyclone tells what it chose while it was set up.
constexpr const char* kTellChoices =
    ",<CycloneDDS><Domain><Tracing><Category>config</Category><OutputFile>/dev/null</OutputFile>"
    "</Tracing></Domain></CycloneDDS>";

/// Which network interface Cyclone chose, and its address.
class HeardChoice {
public:
    HeardChoice() { dds().dds_set_trace_sink(hear, this); }
    ~HeardChoice() { dds().dds_set_trace_sink(nullptr, nullptr); }
    HeardChoice(const HeardChoice&) = delete;
    HeardChoice& operator=(const HeardChoice&) = delete;

    /// "eth0 (udp/192.0.2.2)"; empty where it was not told.
    std::string text() {
        const std::lock_guard lock{mutex_};
        if (interface_.empty()) return {};
        return address_.empty() ? interface_ : interface_ + " (" + address_ + ")";
    }

private:
    /// What stands behind `before`, up to a blank behind which nothing is of use.
    static void take(std::string_view line, std::string_view before, std::string& into) {
        const std::size_t at = line.find(before);
        if (at == line.npos) return;
        const std::string_view rest = line.substr(at + before.size());
        into = rest.substr(0, rest.find_first_of(" \n"));
    }
    static void hear(void* self, const dds_log_data_t* data) {
        auto& heard = *static_cast<HeardChoice*>(self);
        const std::string_view line{data->message, data->size};
        const std::lock_guard lock{heard.mutex_};
        take(line, "selected interfaces: ", heard.interface_);
        take(line, "ownip: ", heard.address_);
    }

    std::mutex mutex_;
    std::string interface_, address_;
};

}  // namespace

Ros2State look_at_ros2() {
    Ros2State state;
    state.built = true;
    constexpr std::size_t kLargeImage = std::size_t{1280} * 720;
    const std::size_t most = largest_socket_buffer();
    try {
        auto environment = ros2_environment(environment_value);
        environment.config += kTellChoices;
        HeardChoice choice;
        const Participant participant{std::move(environment)};
        const std::string interface = choice.text();
        state.found = "Cyclone DDS " DDS_VERSION ", domain " +
                      std::to_string(participant.domain()) +
                      (interface.empty() ? "" : ", interface " + interface) +
                      "; net.core.rmem_max " + std::to_string(most);
        state.works = true;
    } catch (const Error& error) {
        state.found = error.what();
        state.advice = "see CYCLONEDDS_URI, ROS_DOMAIN_ID and ROS_LOCALHOST_ONLY (docs/ros2.md)";
        return state;
    }
    if (!fits_socket_buffer(kLargeImage, most))
        state.advice =
            "images of 1280x720 are larger than a subscriber's socket buffer, and "
            "best-effort subscribers would get none: " +
            socket_buffer_command(kLargeImage);
    return state;
}

}  // namespace eventide
