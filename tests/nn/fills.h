// Numbers a kernel may meet: ordinary, tiny, big, zero and mixed; and zones that nobody may write.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace eventide::test {

enum class Fill { ordinary, tiny, big, zero, mixed };
constexpr Fill kFills[] = {Fill::ordinary, Fill::tiny, Fill::big, Fill::zero, Fill::mixed};

class Numbers {
public:
    explicit Numbers(std::uint32_t seed) : random_(seed) {}
    float next(Fill fill) {
        const float unit = float(std::int32_t(random_())) * 0x1p-31F;  // -1 to 1
        switch (fill) {
            case Fill::ordinary:
                return unit;
            case Fill::tiny:
                return unit * 1e-30F;
            case Fill::big:
                return unit * 1e6F;
            case Fill::zero:
                return random_() % 2 == 0 ? 0.0F : -0.0F;
            case Fill::mixed:
                return std::ldexp(unit, int(random_() % 40) - 20);
        }
        return 0;
    }
    std::vector<float> many(std::size_t n, Fill fill) {
        std::vector<float> values(n);
        for (float& v : values) v = next(fill);
        return values;
    }

private:
    std::mt19937 random_;
};

/// A block of numbers with marked numbers before and behind.
class Guarded {
public:
    explicit Guarded(std::size_t n) : values_(n + 2 * kZone, kMark), n_(n) {}
    float* data() { return values_.data() + kZone; }
    bool intact() const {
        for (std::size_t i = 0; i < kZone; ++i)
            if (values_[i] != kMark || values_[kZone + n_ + i] != kMark) return false;
        return true;
    }

private:
    static constexpr std::size_t kZone = 64;
    static constexpr float kMark = 12345.678F;
    std::vector<float> values_;
    std::size_t n_;
};

}  // namespace eventide::test
