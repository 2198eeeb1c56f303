// The renderer's layers behind the first, of bf16 numbers.
#pragma once

#include "src/kernels/render_kernels.h"

namespace eventide {

namespace avx512_bf16 {
/// See HiddenRows. False, and nothing done, for layers it is not made for.
bool hidden_rows(const HiddenRows& rows);
}  // namespace avx512_bf16

namespace amx {
bool hidden_rows(const HiddenRows& rows);
/// hidden_rows() for 9 to 16 outputs, by AMX or by vectors; false where it does not do such layers.
bool narrow_rows(const HiddenRows& rows, bool by_tiles);
}  // namespace amx

}  // namespace eventide
