// Four numbers at once, in the vector types both compilers know: the loops over pixels are written
// with them, so that they are fast on every machine and in every build type.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

namespace eventide::lanes {

using F4 = float __attribute__((vector_size(16)));
using I4 = std::int32_t __attribute__((vector_size(16)));
using U4 = std::uint32_t __attribute__((vector_size(16)));

inline F4 splat(float v) {
    return F4{v, v, v, v};
}
inline U4 splat(std::uint32_t v) {
    return U4{v, v, v, v};
}
inline F4 load(const float* p) {
    F4 v;
    std::memcpy(&v, p, sizeof v);
    return v;
}
inline U4 load(const std::uint32_t* p) {
    U4 v;
    std::memcpy(&v, p, sizeof v);
    return v;
}
inline void store(float* p, F4 v) {
    std::memcpy(p, &v, sizeof v);
}
inline F4 to_float(U4 v) {  ///< of numbers below 2^31
    return __builtin_convertvector(I4(v), F4);
}
inline I4 truncate(F4 v) {
    return __builtin_convertvector(v, I4);
}
inline F4 select(I4 mask, F4 yes, F4 no) {
    return F4((mask & I4(yes)) | (~mask & I4(no)));
}
inline F4 min(F4 a, F4 b) {
    return select(a < b, a, b);
}
inline F4 max(F4 a, F4 b) {
    return select(a > b, a, b);
}
inline F4 clamp(F4 v, float low, float high) {
    return min(max(v, splat(low)), splat(high));
}
inline bool any(I4 mask) {
    std::uint64_t halves[2];
    std::memcpy(halves, &mask, sizeof halves);
    return (halves[0] | halves[1]) != 0;
}

/// e^x for |x| < 40, within 3e-6 of it (relative): 2^n from the exponent bits, the rest from a
/// polynomial.
inline F4 exp(F4 x) {
    const F4 y = x * 1.44269504f;
    const I4 n = truncate(y + select(y < 0, splat(-.5f), splat(.5f)));
    const F4 f = (y - __builtin_convertvector(n, F4)) * .693147181f;  // |f| <= ln 2 / 2
    F4 p = f * (1.f / 720) + 1.f / 120;
    p = p * f + 1.f / 24;
    p = p * f + 1.f / 6;
    p = p * f + .5f;
    p = p * f + 1.f;
    p = p * f + 1.f;
    return F4(I4(p) + (n << 23));
}

/// ln x for positive normal x, within 3e-7: ln m = 2 artanh((m - 1) / (m + 1)), m in [.7, 1.42).
inline F4 log(F4 x) {
    const I4 bits = I4(x) - 0x3f3504f3;  // sqrt(1/2): steps of the exponent fall between m's ends
    const I4 n = bits >> 23;
    const F4 m = F4(I4(x) - (n << 23));
    const F4 s = (m - 1.f) / (m + 1.f), s2 = s * s;
    const F4 series = ((s2 * (1.f / 7) + 1.f / 5) * s2 + 1.f / 3) * s2 + 1.f;
    return __builtin_convertvector(n, F4) * .693147181f + 2.f * s * series;
}

/// 1 / sqrt(x) for positive x, within 5e-6 of it: a guess from the bits, two steps of Newton.
inline F4 inverse_sqrt(F4 x) {
    F4 y = F4(0x5f3759df - (I4(x) >> 1));
    y = y * (1.5f - .5f * x * y * y);
    return y * (1.5f - .5f * x * y * y);
}

}  // namespace eventide::lanes
