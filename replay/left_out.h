// A word on events that were read and are not in what was made of them.
#pragma once

#include "src/core/damage.h"

#include <cstdint>
#include <string>

namespace eventide {

/// How many events of `name` were left out because of their times, or what most of them were left
/// out for, and what to do; empty where neither is so. `events` were taken.
std::string left_out_text(const std::string& name, const std::string& format, std::uint64_t events,
                          const Damage& damaged);

}  // namespace eventide
