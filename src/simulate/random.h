// Random numbers of the simulator: small, quick, the same on every machine and compiler.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace eventide {

/// Bounds of a random number, `low` to `high`. Whether it is drawn evenly between them, or evenly
/// in the logarithm, is said where the range is used.
struct Range {
    double low = 0, high = 0;
};

/// xoshiro256** by Blackman and Vigna (public domain algorithm), seeded through splitmix64. The
/// standard library's distributions differ between implementations, so they are written out here.
class Random {
public:
    explicit Random(std::uint64_t seed) {
        for (std::uint64_t& word : state_) {
            seed += 0x9e3779b97f4a7c15ULL;
            std::uint64_t z = seed;
            z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
            z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
            word = z ^ (z >> 31);
        }
    }

    std::uint64_t bits() {
        const std::uint64_t result = rotate(state_[1] * 5, 7) * 9;
        const std::uint64_t t = state_[1] << 17;
        state_[2] ^= state_[0];
        state_[3] ^= state_[1];
        state_[1] ^= state_[2];
        state_[0] ^= state_[3];
        state_[2] ^= t;
        state_[3] = rotate(state_[3], 45);
        return result;
    }

    /// A generator of its own, so that what one part draws does not shift what another one gets.
    Random fork() { return Random{bits()}; }

    double uniform() { return double(bits() >> 11) * 0x1p-53; }  ///< [0, 1)
    double uniform(Range r) { return r.low + (r.high - r.low) * uniform(); }
    /// Evenly in the logarithm; a range from 0 or below is drawn evenly.
    double log_uniform(Range r) {
        return r.low > 0 ? r.low * std::exp(uniform() * std::log(r.high / r.low)) : uniform(r);
    }
    int integer(int low, int high) {  ///< low..high, both included
        return low + int((bits() >> 33) * std::uint64_t(high - low + 1) >> 31);
    }
    bool chance(double probability) { return uniform() < probability; }
    double exponential() { return -std::log1p(-uniform()); }  ///< mean 1
    double normal() {                                         ///< mean 0, deviation 1
        const double r = std::sqrt(2 * exponential());
        return r * std::cos(2 * std::numbers::pi * uniform());
    }

private:
    static std::uint64_t rotate(std::uint64_t x, int k) { return (x << k) | (x >> (64 - k)); }
    std::uint64_t state_[4];
};

}  // namespace eventide
