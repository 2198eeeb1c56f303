// The container of ROS 1 bags, format 2.0: records, some of them packed in chunks.
#pragma once

#include "src/core/byte_order.h"
#include "src/core/damage.h"
#include "src/core/error.h"
#include "src/core/sensor_time.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace eventide {

inline std::string_view text_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Numbers and blocks as ROS writes them, from front to back; what it does not hold is 0, and
/// good() false.
class BlockReader {
public:
    explicit BlockReader(std::span<const std::byte> bytes) : rest_(bytes) {}

    template <typename T>
    T number() {
        const auto bytes = take(sizeof(T));
        return bytes.empty() ? T{} : load_little<T>(bytes.data());
    }
    std::span<const std::byte> block() { return take(number<std::uint32_t>()); }
    std::span<const std::byte> take(std::size_t n) {
        good_ = good_ && n <= rest_.size();
        if (!good_) return {};
        const auto front = rest_.first(n);
        rest_ = rest_.subspan(n);
        return front;
    }
    /// Seconds and nanoseconds.
    SensorTime time() {
        const auto s = number<std::uint32_t>(), ns = number<std::uint32_t>();
        return from_us(std::int64_t{s} * 1'000'000 + (std::int64_t{ns} + 500) / 1000);
    }
    bool good() const { return good_; }

private:
    std::span<const std::byte> rest_;
    bool good_ = true;
};

/// What is wrong with a bag, for who counts it and reads on behind it.
class BagError : public Error {
public:
    BagError(DamageReason reason, const std::string& message)
        : Error(ErrorKind::input, message), reason_(reason) {}
    DamageReason reason() const noexcept { return reason_; }

private:
    DamageReason reason_;
};

/// A header of named fields, and data.
struct BagRecord {
    enum Op : int { message = 2, chunk = 5, connection = 7 };

    std::map<std::string, std::string_view, std::less<>> fields;
    std::span<const std::byte> data;
    int op = -1;
};

/// Name and value of each field "name=value" in a row of blocks.
std::map<std::string, std::string_view, std::less<>> bag_fields(std::span<const std::byte> bytes);

/// Reads from the beginning to the end, a record at a time; the index is not needed. Errors are
/// BagError and name the file, what was expected and what was found. After one for a chunk that
/// does not unpack (bad_compression) or a record in it (bad_record), read() goes on with what
/// follows.
class BagRecords {
public:
    explicit BagRecords(const std::filesystem::path& path);

    /// Gives the next record, or each of those in it when it is a chunk; false at the end. Of a
    /// chunk that is not packed and cut short, gives the whole records before it throws
    /// (truncated).
    bool read(const std::function<void(const BagRecord&)>& use);

    /// Where the next record begins, for go_to(). Bytes.
    std::uint64_t position() const { return size_ - left_; }
    void go_to(std::uint64_t position);
    std::uint64_t size() const { return size_; }
    /// The op of the next record, which it passes over unread; -1 at the end.
    int skip();

    /// The number in a record's field of 4 bytes.
    std::uint32_t number(const BagRecord& record, std::string_view field) const;
    [[noreturn]] void refuse(const std::string& what,
                             DamageReason reason = DamageReason::bad_record) const;

private:
    struct Bytes {
        std::vector<std::byte> bytes;
        std::uint64_t missing = 0;  ///< at the end, of a chunk that is not packed
    };
    std::optional<Bytes> next_bytes();  ///< of one record; none at the end
    BagRecord parse(std::span<const std::byte>& bytes) const;
    std::vector<std::byte> unpack(const BagRecord& chunk) const;
    [[noreturn]] void refuse_short(std::uint64_t wanted) const;

    std::filesystem::path path_;
    std::ifstream file_;
    std::uint64_t size_ = 0;  ///< bytes of the file
    std::uint64_t left_ = 0;  ///< of them, not yet read
};

}  // namespace eventide
