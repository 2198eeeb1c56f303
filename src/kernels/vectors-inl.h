// The vector of the instruction set that is being compiled for, and its first n numbers alone.
#if defined(EVENTIDE_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef EVENTIDE_VECTORS_INL_H
#undef EVENTIDE_VECTORS_INL_H
#else
#define EVENTIDE_VECTORS_INL_H
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace eventide::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
/// As many lanes as a register of the target has: 4 with SSE4 and NEON, 8 with AVX2, 16 with
/// AVX-512.
using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;

/// The first n numbers, at most a vector of them, and zeros behind; what lies past them is not
/// read.
template <class Tag>
HWY_INLINE hn::Vec<Tag> load_some(Tag d, const float* from, std::size_t n) {
    HWY_ALIGN float whole[HWY_MAX_BYTES / sizeof(float)] = {};
    std::memcpy(whole, from, n * sizeof(float));
    return hn::Load(d, whole);
}
HWY_INLINE V load_some(const float* from, std::size_t n) {
    return load_some(D(), from, n);
}

/// The first n lanes of v; what lies past them is not written.
/// All of v where n is at least its size.
template <class Tag>
HWY_INLINE void store_some(Tag d, hn::Vec<Tag> v, float* out, int n) {
    if (n >= int(hn::Lanes(d))) {
        hn::StoreU(v, d, out);
        return;
    }
    HWY_ALIGN float whole[HWY_MAX_BYTES / sizeof(float)];
    hn::Store(v, d, whole);
    for (int i = 0; i < n; ++i) out[i] = whole[i];
}
HWY_INLINE void store_some(V v, float* out, int n) {
    store_some(D(), v, out, n);
}

}  // namespace eventide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
