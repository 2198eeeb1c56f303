// Bytes that are read by their position.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace eventide {

class ByteSource {
public:
    virtual ~ByteSource() = default;
    virtual std::uint64_t size() const = 0;
    /// False where they cannot be read, or there are not so many.
    virtual bool read_at(std::uint64_t offset, std::span<std::byte> into) = 0;
    /// Going back means to begin anew.
    virtual bool is_sequential() const = 0;
};

/// In memory, which is borrowed.
class MemoryBytes final : public ByteSource {
public:
    explicit MemoryBytes(std::span<const std::byte> bytes) : bytes_(bytes) {}
    std::uint64_t size() const override { return bytes_.size(); }
    bool read_at(std::uint64_t offset, std::span<std::byte> into) override {
        if (offset > size() || into.size() > size() - offset) return false;
        std::ranges::copy(bytes_.subspan(std::size_t(offset), into.size()), into.begin());
        return true;
    }
    bool is_sequential() const override { return false; }

private:
    std::span<const std::byte> bytes_;
};

}  // namespace eventide
