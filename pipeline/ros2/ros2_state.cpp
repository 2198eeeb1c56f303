// What `eventide doctor` says of ROS 2.
#include "pipeline/ros2/participant.h"
#include "pipeline/ros2/ros2_sink.h"
#include "pipeline/ros2/socket_buffer.h"
#include "src/core/error.h"

#include <dds/version.h>

namespace eventide {

Ros2State look_at_ros2() {
    Ros2State state;
    state.built = true;
    constexpr std::size_t kLargeImage = std::size_t{1280} * 720;
    const std::size_t most = largest_socket_buffer();
    try {
        const auto participant = Participant::join();
        state.found = "Cyclone DDS " DDS_VERSION ", domain " +
                      std::to_string(participant->domain()) + "; net.core.rmem_max " +
                      std::to_string(most);
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
