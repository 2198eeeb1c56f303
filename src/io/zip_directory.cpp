// PKWARE APPNOTE 6.3, sections 4.3.7 (local entry), 4.3.12 (directory), 4.3.14 to 16 (its end),
// 4.5.3 (zip64).
#include "src/io/zip_directory.h"

#include "src/core/byte_order.h"
#include "src/core/error.h"

#include <algorithm>
#include <span>

namespace eventide {

namespace {

constexpr std::uint32_t kLocalEntry = 0x04034b50, kDirectoryEntry = 0x02014b50,
                        kEndOfDirectory = 0x06054b50, kEndOfDirectory64 = 0x06064b50,
                        kLocator64 = 0x07064b50;
constexpr std::size_t kLocalBytes = 30, kDirectoryBytes = 46, kEndBytes = 22, kEnd64Bytes = 56,
                      kLocatorBytes = 20;
constexpr std::uint64_t kLongestComment = 65535;
constexpr std::uint64_t kLargestDirectory = std::uint64_t{1} << 24;

using Bytes = std::vector<std::byte>;

template <typename T>
T number(const Bytes& bytes, std::size_t at) {
    return load_little<T>(bytes.data() + at);
}

[[noreturn]] void refuse(const ZipArchive& archive, const std::string& what) {
    throw Error(ErrorKind::input,
                archive.name + ": expected an npz file (a zip archive), found " + what);
}

Bytes read(const ZipArchive& archive, std::uint64_t at, std::uint64_t size) {
    Bytes bytes(static_cast<std::size_t>(size));
    if (at > archive.size || size > archive.size - at || archive.read_at(at, bytes) != bytes.size())
        refuse(archive, "one that is cut short");
    return bytes;
}

struct Directory {
    std::uint64_t begin = 0, size = 0;
};

Directory find_directory(const ZipArchive& archive) {
    const std::uint64_t tail = std::min(archive.size, kEndBytes + kLongestComment);
    const std::uint64_t tail_begin = archive.size - tail;
    const Bytes bytes = read(archive, tail_begin, tail);
    for (std::size_t n = kEndBytes; n <= bytes.size(); ++n) {
        const std::size_t at = bytes.size() - n;
        if (number<std::uint32_t>(bytes, at) != kEndOfDirectory) continue;
        const Directory usual{number<std::uint32_t>(bytes, at + 16),
                              number<std::uint32_t>(bytes, at + 12)};
        const std::uint64_t end = tail_begin + at;
        if (end < kLocatorBytes) return usual;
        const Bytes locator = read(archive, end - kLocatorBytes, kLocatorBytes);
        if (number<std::uint32_t>(locator, 0) != kLocator64) return usual;
        const Bytes large = read(archive, number<std::uint64_t>(locator, 8), kEnd64Bytes);
        if (number<std::uint32_t>(large, 0) != kEndOfDirectory64) refuse(archive, "a damaged one");
        return {number<std::uint64_t>(large, 48), number<std::uint64_t>(large, 40)};
    }
    refuse(archive, "no directory in it");
}

/// Numbers that do not fit 32 bits stand in an extra field, in this order, those that do not.
void read_large_numbers(std::span<const std::byte> extra, ZipEntry& entry, std::uint64_t& offset) {
    while (extra.size() >= 4) {
        const auto kind = load_little<std::uint16_t>(extra.data());
        const std::size_t size = load_little<std::uint16_t>(extra.data() + 2);
        extra = extra.subspan(4);
        if (size > extra.size()) return;
        auto field = extra.first(size);
        extra = extra.subspan(size);
        if (kind != 1) continue;
        for (std::uint64_t* value : {&entry.size, &entry.packed_size, &offset}) {
            if (*value != 0xFFFFFFFFU || field.size() < 8) continue;
            *value = load_little<std::uint64_t>(field.data());
            field = field.subspan(8);
        }
    }
}

/// The data begin behind a second header, whose own lengths count.
void find_data(const ZipArchive& archive, std::uint64_t offset, ZipEntry& entry) {
    const Bytes local = read(archive, offset, kLocalBytes);
    if (number<std::uint32_t>(local, 0) != kLocalEntry)
        refuse(archive, "no entry '" + entry.name + "' where its directory says");
    entry.begin =
        offset + kLocalBytes + number<std::uint16_t>(local, 26) + number<std::uint16_t>(local, 28);
    if (entry.begin > archive.size || entry.packed_size > archive.size - entry.begin)
        refuse(archive, "an entry '" + entry.name + "' that is cut short");
}

}  // namespace

std::vector<ZipEntry> read_zip_directory(const ZipArchive& archive) {
    const Directory directory = find_directory(archive);
    if (directory.size > kLargestDirectory) refuse(archive, "a directory of more than 16 MiB");
    const Bytes bytes = read(archive, directory.begin, directory.size);
    std::vector<ZipEntry> entries;
    for (std::size_t at = 0; bytes.size() - at >= kDirectoryBytes;) {
        if (number<std::uint32_t>(bytes, at) != kDirectoryEntry)
            refuse(archive, "a damaged directory");
        ZipEntry entry;
        entry.method = number<std::uint16_t>(bytes, at + 10);
        entry.crc = number<std::uint32_t>(bytes, at + 16);
        entry.packed_size = number<std::uint32_t>(bytes, at + 20);
        entry.size = number<std::uint32_t>(bytes, at + 24);
        std::uint64_t offset = number<std::uint32_t>(bytes, at + 42);
        const std::size_t name = number<std::uint16_t>(bytes, at + 28),
                          extra = number<std::uint16_t>(bytes, at + 30),
                          comment = number<std::uint16_t>(bytes, at + 32);
        at += kDirectoryBytes;
        if (name + extra + comment > bytes.size() - at) refuse(archive, "a damaged directory");
        entry.name.assign(reinterpret_cast<const char*>(bytes.data() + at), name);
        read_large_numbers(std::span(bytes).subspan(at + name, extra), entry, offset);
        at += name + extra + comment;
        find_data(archive, offset, entry);
        entries.push_back(std::move(entry));
    }
    return entries;
}

}  // namespace eventide
