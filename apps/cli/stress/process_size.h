// What this process holds, as the system says.
#pragma once

#include <cstdint>

namespace eventide::stress {

struct ProcessSize {
    std::int64_t resident = 0;   ///< bytes
    int files = 0, threads = 0;  ///< open descriptors; threads
};

/// Zeros where the system does not say.
ProcessSize process_size();

/// Bytes that may be taken without swapping; 0 where the system does not say.
std::uint64_t free_memory();

}  // namespace eventide::stress
