// Damage in messages.
#pragma once

#include "src/core/damage.h"
#include "src/core/list_text.h"

#include <string>

namespace eventide {

/// "truncated 1, time_backwards 12"; empty where there is none.
inline std::string damage_text(const Damage& damage) {
    std::string reasons;
    for (std::size_t i = 0; i < kDamageReasons; ++i)
        if (const auto n = damage[DamageReason(i)]; n > 0)
            add_to_list(reasons, std::string{name_of(DamageReason(i))} + " " + std::to_string(n));
    return reasons;
}

}  // namespace eventide
