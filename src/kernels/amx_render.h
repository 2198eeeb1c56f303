// The renderer's layers behind the first, by AMX.
#pragma once

#include "src/kernels/render_kernels.h"

namespace eventide::amx {

/// See HiddenRows. False, and nothing done, for layers it is not made for.
bool hidden_rows(const HiddenRows& rows);

}  // namespace eventide::amx
