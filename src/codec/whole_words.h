// Whole words out of a stream that is cut anywhere.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

namespace eventide {

/// Calls use(span of whole words) at most twice for each piece of the stream.
template <std::size_t kBytes>
class WholeWords {
public:
    template <typename Use>
    void feed(std::span<const std::byte> bytes, Use&& use) {
        if (carried_ > 0) {
            const std::size_t n = std::min(kBytes - carried_, bytes.size());
            std::copy_n(bytes.begin(), n, carry_.begin() + std::ptrdiff_t(carried_));
            carried_ += n;
            bytes = bytes.subspan(n);
            if (carried_ < kBytes) return;
            carried_ = 0;
            use(std::span<const std::byte>(carry_));
        }
        const std::size_t whole = bytes.size() / kBytes * kBytes;
        if (whole > 0) use(bytes.first(whole));
        carried_ = bytes.size() - whole;
        std::copy_n(bytes.begin() + std::ptrdiff_t(whole), carried_, carry_.begin());
    }
    bool is_half_read() const { return carried_ > 0; }
    void drop() { carried_ = 0; }

private:
    std::array<std::byte, kBytes> carry_{};
    std::size_t carried_ = 0;
};

}  // namespace eventide
