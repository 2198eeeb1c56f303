// A stream of records of one size, cut anywhere.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <span>

namespace eventide {

/// Hands out whole records and keeps what is left until its end comes.
template <std::size_t kBytes>
class FixedRecords {
public:
    /// Calls use(const std::byte* record) for each record the bytes complete.
    template <typename Use>
    void feed(std::span<const std::byte> bytes, Use&& use) {
        if (carried_ > 0) {
            const std::size_t n = std::min(kBytes - carried_, bytes.size());
            std::copy_n(bytes.begin(), n, carry_.begin() + carried_);
            carried_ += n;
            bytes = bytes.subspan(n);
            if (carried_ < kBytes) return;
            carried_ = 0;
            use(carry_.data());
        }
        for (; bytes.size() >= kBytes; bytes = bytes.subspan(kBytes)) use(bytes.data());
        std::copy(bytes.begin(), bytes.end(), carry_.begin());
        carried_ = bytes.size();
    }

    bool is_half_read() const { return carried_ > 0; }
    void drop() { carried_ = 0; }

private:
    std::array<std::byte, kBytes> carry_{};
    std::size_t carried_ = 0;
};

}  // namespace eventide
