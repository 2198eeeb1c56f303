// A stream of records of one size, cut anywhere.
#pragma once

#include "src/codec/whole_words.h"

#include <cstddef>
#include <span>

namespace eventide {

/// Hands out whole records and keeps what is left until its end comes.
template <std::size_t kBytes>
class FixedRecords {
public:
    /// Calls use(const std::byte* record) for each record the bytes complete.
    template <typename Use>
    void feed(std::span<const std::byte> bytes, Use&& use) {
        words_.feed(bytes, [&](std::span<const std::byte> whole) {
            for (; !whole.empty(); whole = whole.subspan(kBytes)) use(whole.data());
        });
    }

    bool is_half_read() const { return words_.is_half_read(); }
    void drop() { words_.drop(); }

private:
    WholeWords<kBytes> words_;
};

}  // namespace eventide
