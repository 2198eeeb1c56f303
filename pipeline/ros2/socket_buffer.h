// Whether an image fits into the receive buffer that the system grants a subscriber.
#pragma once

#include <cstddef>
#include <string>

namespace eventide {

/// Bytes that net.core.rmem_max allows a socket, 0 where the system does not say.
std::size_t largest_socket_buffer();

/// What an image takes in a socket's buffer when it comes in one burst.
std::size_t burst_bytes(std::size_t image_bytes);

/// Whether a best-effort reader with the buffer that `rmem_max` allows gets such images: one that
/// does not fit loses a part of each, and so all of them. True where rmem_max is 0.
bool fits_socket_buffer(std::size_t image_bytes, std::size_t rmem_max);

/// "sudo sysctl -w net.core.rmem_max=4194304", with what such images need.
std::string socket_buffer_command(std::size_t image_bytes);

}  // namespace eventide
