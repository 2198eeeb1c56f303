// The renderer's layers behind the first in one pass, of float32 numbers: see HiddenRows.
#if defined(EVENTIDE_HIDDEN_ROWS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef EVENTIDE_HIDDEN_ROWS_INL_H
#undef EVENTIDE_HIDDEN_ROWS_INL_H
#else
#define EVENTIDE_HIDDEN_ROWS_INL_H
#endif

#include "src/kernels/render_kernels-inl.h"
#include "src/kernels/vector_dots-inl.h"

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace eventide::HWY_NAMESPACE {

constexpr int kRowLanes = int(hn::MaxLanes(D()));
/// Pixels whose sums of two vectors are in registers together, and those whose last products wait
/// to be added up, a vector of pixels at a time.
constexpr int kGroup = kManyRegisters ? 12 : 6, kBatch = 48;
static_assert(kBatch % kGroup == 0 && kBatch % kRowLanes == 0);

/// What pixels pass through, within a core's first cache:
///
///     numbers         [pixel of a group][width]: relu(sums + base + dx slope)
///     products        [mu, log sigma][pixel of a batch][lane]: products of the last layer, which
///                     add up over lanes
///     last            [mu, log sigma][outputs]: its weights, zeros past the last
///     shift           [width]: base + dx slope, where dx is the same for all pixels
struct HiddenRoom {
    static constexpr int kMost = 64;  ///< numbers of a layer
    HWY_ALIGN float numbers[kGroup * kMost];
    HWY_ALIGN float products[2][kBatch * kRowLanes];
    HWY_ALIGN float last[2][kMost] = {};
    HWY_ALIGN float shift[kMost];
};

/// base + dx slope, of a vector of outputs from c on.
HWY_INLINE V shift_of(const OffsetRows& r, int c, V dx) {
    return hn::MulAdd(dx, hn::LoadU(D(), r.slope + c), hn::LoadU(D(), r.base + c));
}

/// Whether all pixels have the same dx, as in frames of the sensor's size.
HWY_INLINE bool is_shifted_alike(const OffsetRows& r) {
    const D d;
    const V first = hn::Set(d, r.dx[0]);
    int p = 0;
    for (; p + kRowLanes <= r.pixels; p += kRowLanes)
        if (!hn::AllTrue(d, hn::Eq(hn::LoadU(d, r.dx + p), first))) return false;
    for (; p < r.pixels; ++p)
        if (r.dx[p] != r.dx[0]) return false;
    return true;
}

/// The first layer of a group from pixel p on; past the last pixel the last again.
template <bool kAlike>
HWY_INLINE void offset_group(const OffsetRows& r, int p, HiddenRoom& room) {
    const D d;
    float* out = room.numbers;
    for (int i = 0; i < kGroup; ++i, out += r.width) {
        const int pixel = std::min(p + i, r.pixels - 1);
        const float* sums =
            static_cast<const float*>(r.sums) + std::ptrdiff_t(r.column[pixel]) * r.width;
        for (int c = 0; c < r.width; c += 64 / int(sizeof(float)))
            __builtin_prefetch(sums + r.ahead + c, 0, 2);
        const V dx = hn::Set(d, r.dx[pixel]);
        for (int c = 0; c < r.width; c += kRowLanes) {
            const V shift = kAlike ? hn::Load(d, room.shift + c) : shift_of(r, c, dx);
            hn::Store(hn::Max(hn::Add(hn::LoadU(d, sums + c), shift), hn::Zero(d)), d, out + c);
        }
    }
}

/// relu(sums) times the last layer's weights, onto what earlier outputs gave.
template <bool kTwo>
struct LastProducts {
    float *first, *second;  // of the group's pixel 0
    V first_a, first_b, second_a, second_b;
    bool is_begin;

    HWY_INLINE void operator()(int pixel, V a, V b) const {
        const D d;
        const V zero = hn::Zero(d);
        a = hn::Max(a, zero);
        float *one = first + pixel * kRowLanes, *two = second + pixel * kRowLanes;
        V x = hn::MulAdd(a, first_a, is_begin ? zero : hn::Load(d, one)),
          y = hn::MulAdd(a, second_a, is_begin ? zero : hn::Load(d, two));
        if (kTwo) {
            b = hn::Max(b, zero);
            x = hn::MulAdd(b, first_b, x);
            y = hn::MulAdd(b, second_b, y);
        }
        hn::Store(x, d, one);
        hn::Store(y, d, two);
    }
};

/// One or two vectors of hidden outputs, from output `first` on, of a group that is pixel `at` of
/// its batch.
template <bool kTwo>
HWY_NOINLINE void hidden_block(const HiddenRows& r, const float* weight, int first, int at,
                               HiddenRoom& room) {
    const D d;
    constexpr int kSecond = kTwo ? kRowLanes : 0, kWidth = kRowLanes + kSecond;
    const int width = r.offset.width;
    Sums<D, kGroup, kTwo> sums;
    sums.start(hn::LoadU(d, r.bias + first), hn::LoadU(d, r.bias + first + kSecond));
    const float* in = room.numbers;
    for (int k = 0; k < width; k += kRowLanes)
        for (int i = 0; i < kRowLanes; ++i, ++in, weight += kWidth)
            sums.add(in, width, hn::LoadU(d, weight), hn::LoadU(d, weight + kSecond));
    float *one = room.products[0] + at * kRowLanes, *two = room.products[1] + at * kRowLanes;
    const float *last = room.last[0] + first, *second = room.last[1] + first;
    sums.each(LastProducts<kTwo>{one, two, hn::LoadU(d, last), hn::LoadU(d, last + kSecond),
                                 hn::LoadU(d, second), hn::LoadU(d, second + kSecond), first == 0});
}

/// The lanes of kCount pixels added up, each pixel's in its share of a vector (add_neighbours()).
template <int kCount>
HWY_INLINE V added_up(const float* products) {
    if constexpr (kCount == 1) {
        return hn::Load(D(), products);
    } else {
        constexpr int kHalf = kCount / 2;
        return add_neighbours(added_up<kHalf>(products),
                              added_up<kHalf>(products + kHalf * kRowLanes));
    }
}

/// False, and nothing done, for layers it is not made for. What a pixel gets does not depend on
/// which others are beside it.
bool hidden_rows(const HiddenRows& r) {
    const OffsetRows& offset = r.offset;
    if (offset.width % kRowLanes != 0 || offset.width > HiddenRoom::kMost ||
        r.outputs > HiddenRoom::kMost)
        return false;
    HiddenRoom room;
    for (int n = 0; n < 2; ++n) std::copy_n(r.last_weight + n * r.outputs, r.outputs, room.last[n]);
    const V bias[] = {hn::Set(D(), r.last_bias[0]), hn::Set(D(), r.last_bias[1])};
    const bool is_alike = offset.pixels > 0 && is_shifted_alike(offset);
    for (int c = 0; is_alike && c < offset.width; c += kRowLanes)
        hn::Store(shift_of(offset, c, hn::Set(D(), offset.dx[0])), D(), room.shift + c);
    for (int begin = 0; begin < offset.pixels; begin += kBatch) {
        const int count = std::min(kBatch, offset.pixels - begin);
        for (int at = 0; at < count; at += kGroup) {
            is_alike ? offset_group<true>(offset, begin + at, room)
                     : offset_group<false>(offset, begin + at, room);
            const auto* weight = static_cast<const float*>(r.weight);
            for (int first = 0; first < r.outputs;) {
                const bool is_two = r.outputs - first > kRowLanes;
                is_two ? hidden_block<true>(r, weight, first, at, room)
                       : hidden_block<false>(r, weight, first, at, room);
                const int outputs = is_two ? 2 * kRowLanes : kRowLanes;
                weight += offset.width * outputs;
                first += outputs;
            }
        }
        for (int n = 0; n < 2; ++n)
            for (int p = 0; p < count; p += kRowLanes)
                store_some(hn::Add(added_up<kRowLanes>(room.products[n] + p * kRowLanes), bias[n]),
                           (n == 0 ? r.mu : r.log_sigma) + begin + p, count - p);
    }
    return true;
}

}  // namespace eventide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
