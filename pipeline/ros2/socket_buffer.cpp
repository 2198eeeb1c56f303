// Whether an image fits into a socket's receive buffer.
#include "pipeline/ros2/socket_buffer.h"

#include "src/core/number_text.h"

#include <algorithm>
#include <bit>
#include <fstream>

namespace eventide {

std::size_t largest_socket_buffer() {
    std::string bytes;
    std::ifstream{"/proc/sys/net/core/rmem_max"} >> bytes;
    return number_in<std::size_t>(bytes).value_or(0);
}

/// The kernel counts its own bookkeeping against the buffer; it grants twice what is asked for to
/// make up for that.
std::size_t burst_bytes(std::size_t image_bytes) {
    constexpr std::size_t kFragment = 65'000, kPerFragment = 1'024;
    return image_bytes + (image_bytes / kFragment + 1) * kPerFragment;
}

bool fits_socket_buffer(std::size_t image_bytes, std::size_t rmem_max) {
    return rmem_max == 0 || burst_bytes(image_bytes) <= 2 * rmem_max;
}

std::string socket_buffer_command(std::size_t image_bytes) {
    constexpr std::size_t kUsual = std::size_t{4} << 20;
    // Room for two: the next one comes before the reader has taken the first.
    const std::size_t needed = std::max(kUsual, std::bit_ceil(2 * burst_bytes(image_bytes)));
    return "sudo sysctl -w net.core.rmem_max=" + std::to_string(needed);
}

}  // namespace eventide
