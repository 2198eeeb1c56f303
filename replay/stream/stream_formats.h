// How a recording that is a stream of bytes is opened: one function for each format in the table of
// formats.
#pragma once

#include "replay/open_options.h"
#include "replay/stream/file_recording.h"

#include <cstddef>
#include <span>

namespace eventide {

// Each reads the header from the first bytes of a file (all of it, or kHeadBytes). Throws Error
// (input) when it is not what it says.
OpenedStream open_aedat1(std::span<const std::byte> first_bytes, const OpenOptions& options);
OpenedStream open_aedat2(std::span<const std::byte> first_bytes, const OpenOptions& options);
OpenedStream open_aedat3(std::span<const std::byte> first_bytes, const OpenOptions& options);
OpenedStream open_aedat4(std::span<const std::byte> first_bytes, const OpenOptions& options);
OpenedStream open_evt2(std::span<const std::byte> first_bytes, const OpenOptions& options);
OpenedStream open_evt21(std::span<const std::byte> first_bytes, const OpenOptions& options);
OpenedStream open_evt3(std::span<const std::byte> first_bytes, const OpenOptions& options);
OpenedStream open_dat(std::span<const std::byte> first_bytes, const OpenOptions& options);
OpenedStream open_event_stream(std::span<const std::byte> first_bytes, const OpenOptions& options);
OpenedStream open_text(std::span<const std::byte> first_bytes, const OpenOptions& options);

}  // namespace eventide
