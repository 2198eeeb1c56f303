// A word on events that came too late to be put in order.
#pragma once

#include "src/core/damage.h"

#include <cstdint>
#include <string>

namespace eventide::app {

/// How many events of `name` were left out because of their times, and what to do; empty where none
/// were. `events` were taken.
std::string disorder_text(const std::string& name, const std::string& format, std::uint64_t events,
                          const Damage& damaged);

}  // namespace eventide::app
