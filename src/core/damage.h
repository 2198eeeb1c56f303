// Bytes that made no sense, counted by reason. Damage is never fatal and never printed by a parser.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace eventide {

enum class DamageReason : std::uint8_t {
    truncated,       ///< the stream ended inside a record
    out_of_range,    ///< a coordinate outside the sensor
    time_backwards,  ///< a time before the one before it; the event is left out
    unknown_word,    ///< a word or record type the format does not have, or that comes where it may
                     ///< not
    bad_length,      ///< a length or count that cannot be right
    bad_compression,  ///< a compressed block that does not unpack
    bad_record,  ///< a record whose fields contradict each other, or a line of text that does not
                 ///< parse
    bad_table,   ///< an index (AEDAT4 file table) that is missing or does not fit the data; it was
                 ///< rebuilt
    time_corrected,  ///< a camera's clock was set right by the host's after a loss
    kCount
};

constexpr std::size_t kDamageReasons = std::size_t(DamageReason::kCount);

constexpr std::string_view name_of(DamageReason reason) {
    switch (reason) {
        case DamageReason::truncated:
            return "truncated";
        case DamageReason::out_of_range:
            return "out_of_range";
        case DamageReason::time_backwards:
            return "time_backwards";
        case DamageReason::unknown_word:
            return "unknown_word";
        case DamageReason::bad_length:
            return "bad_length";
        case DamageReason::bad_compression:
            return "bad_compression";
        case DamageReason::bad_record:
            return "bad_record";
        case DamageReason::bad_table:
            return "bad_table";
        case DamageReason::time_corrected:
            return "time_corrected";
        case DamageReason::kCount:
            break;
    }
    return "";
}

/// One counter per reason.
class Damage {
public:
    void count(DamageReason reason, std::uint64_t n = 1) { counts_[std::size_t(reason)] += n; }
    std::uint64_t operator[](DamageReason reason) const { return counts_[std::size_t(reason)]; }
    std::uint64_t total() const {
        std::uint64_t sum = 0;
        for (const std::uint64_t n : counts_) sum += n;
        return sum;
    }
    Damage& operator+=(const Damage& other) {
        for (std::size_t i = 0; i < kDamageReasons; ++i) counts_[i] += other.counts_[i];
        return *this;
    }
    friend bool operator==(const Damage&, const Damage&) = default;

private:
    std::array<std::uint64_t, kDamageReasons> counts_{};
};

}  // namespace eventide
