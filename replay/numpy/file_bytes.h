// Bytes of an array in a file, as they are or deflated.
#pragma once

#include "replay/stream/byte_file.h"
#include "src/io/byte_source.h"

#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace eventide {

/// `file` is borrowed.
class StoredBytes final : public ByteSource {
public:
    StoredBytes(const ByteFile& file, std::uint64_t begin, std::uint64_t size)
        : file_(file), begin_(begin), size_(size) {}
    std::uint64_t size() const override { return size_; }
    bool read_at(std::uint64_t offset, std::span<std::byte> into) override;
    bool is_sequential() const override { return false; }

private:
    const ByteFile& file_;
    std::uint64_t begin_, size_;
};

/// Inflates from the beginning up to what is asked for, in memory of bounded size.
class DeflatedBytes final : public ByteSource {
public:
    /// `size`: unpacked, as the archive says.
    DeflatedBytes(const ByteFile& file, std::uint64_t begin, std::uint64_t packed_size,
                  std::uint64_t size);
    ~DeflatedBytes() override;
    DeflatedBytes(const DeflatedBytes&) = delete;
    DeflatedBytes& operator=(const DeflatedBytes&) = delete;
    std::uint64_t size() const override { return size_; }
    bool read_at(std::uint64_t offset, std::span<std::byte> into) override;
    bool is_sequential() const override { return true; }

private:
    void begin_anew();
    bool inflate_into(std::span<std::byte> into);

    const ByteFile& file_;
    std::uint64_t begin_, packed_size_, size_;
    std::uint64_t taken_ = 0;     // of the packed bytes
    std::uint64_t position_ = 0;  // in the unpacked ones
    std::optional<std::uint64_t> broken_at_;
    z_stream stream_{};
    std::vector<std::byte> packed_, passed_over_;
};

}  // namespace eventide
