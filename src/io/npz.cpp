// Zip (PKWARE APPNOTE 6.3, sections 4.3.7, 4.3.12, 4.3.16) around .npy files.
#include "src/io/npz.h"

#include "src/core/error.h"
#include "src/io/input_file.h"
#include "src/io/npy.h"

#include <zlib.h>

#include <bit>
#include <cstring>
#include <span>
#include <string_view>

namespace eventide {
namespace {

static_assert(std::endian::native == std::endian::little, "zip and '<f4' are read in place");

constexpr std::uint32_t kEndOfDirectory = 0x06054b50, kDirectoryEntry = 0x02014b50,
                        kLocalEntry = 0x04034b50;
constexpr std::size_t kEndBytes = 22, kDirectoryBytes = 46, kLocalBytes = 30;
constexpr std::uint64_t kLargestArrayBytes = std::uint64_t{1} << 31;
constexpr std::uint64_t kMaxInflation = 1032;  // of deflate: 258 bytes from 2 bits

template <typename T>
T number_at(std::span<const std::byte> bytes, std::size_t offset) {
    T value;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

std::string_view text_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

NpzFile::NpzFile(const std::filesystem::path& path)
    : file_(path.string()), bytes_(read_bytes_of_file(path)) {
    read_directory();
}

void NpzFile::refuse(const std::string& what) const {
    throw Error(ErrorKind::input, file_ + ": " + what + " (expected an npz file)");
}

void NpzFile::read_directory() {
    const std::span<const std::byte> bytes{bytes_};
    // The end record is last, but for a comment of at most 65,535 bytes.
    std::size_t end = bytes.size() < kEndBytes ? 0 : bytes.size() - kEndBytes + 1;
    const std::size_t lowest = end > 65536 ? end - 65536 : 0;
    while (end > lowest && number_at<std::uint32_t>(bytes, end - 1) != kEndOfDirectory) --end;
    if (end == lowest) refuse("no zip directory found");
    --end;
    const auto count = number_at<std::uint16_t>(bytes, end + 10);
    std::size_t at = number_at<std::uint32_t>(bytes, end + 16);
    for (int i = 0; i < count; ++i) {
        if (at > end || end - at < kDirectoryBytes ||
            number_at<std::uint32_t>(bytes, at) != kDirectoryEntry)
            refuse("the zip directory is damaged at entry " + std::to_string(i));
        Entry entry;
        entry.method = number_at<std::uint16_t>(bytes, at + 10);
        entry.crc = number_at<std::uint32_t>(bytes, at + 16);
        entry.packed_bytes = number_at<std::uint32_t>(bytes, at + 20);
        entry.unpacked_bytes = number_at<std::uint32_t>(bytes, at + 24);
        entry.header_offset = number_at<std::uint32_t>(bytes, at + 42);
        const std::size_t name_bytes = number_at<std::uint16_t>(bytes, at + 28);
        const std::size_t rest = name_bytes + number_at<std::uint16_t>(bytes, at + 30) +
                                 number_at<std::uint16_t>(bytes, at + 32);
        at += kDirectoryBytes;
        if (rest > end - at) refuse("the zip directory is cut short");
        std::string name{text_of(bytes.subspan(at, name_bytes))};
        if (name.ends_with(".npy")) name.resize(name.size() - 4);
        entries_.insert_or_assign(std::move(name), entry);
        at += rest;
    }
}

std::vector<std::byte> NpzFile::unpacked(const std::string& name) const {
    const auto found = entries_.find(name);
    if (found == entries_.end()) refuse("array '" + name + "' is missing");
    const Entry& entry = found->second;
    const std::span<const std::byte> bytes{bytes_};
    const auto header = std::size_t(entry.header_offset);
    if (header > bytes.size() || bytes.size() - header < kLocalBytes ||
        number_at<std::uint32_t>(bytes, header) != kLocalEntry)
        refuse("array '" + name + "' has no zip entry where the directory says");
    const std::size_t data = header + kLocalBytes + number_at<std::uint16_t>(bytes, header + 26) +
                             number_at<std::uint16_t>(bytes, header + 28);
    if (data > bytes.size() || entry.packed_bytes > bytes.size() - data ||
        entry.unpacked_bytes > kLargestArrayBytes)
        refuse("array '" + name + "' is cut short");
    const auto packed = bytes.subspan(data, std::size_t(entry.packed_bytes));

    // Before memory is taken for what the directory says.
    if (entry.unpacked_bytes > packed.size() * kMaxInflation)
        refuse("array '" + name + "' is said to be of " + std::to_string(entry.unpacked_bytes) +
               " bytes, which " + std::to_string(packed.size()) + " packed ones cannot give");
    std::vector<std::byte> out(std::size_t(entry.unpacked_bytes));
    if (entry.method == 0) {
        if (packed.size() != out.size()) refuse("array '" + name + "' has two sizes");
        std::copy(packed.begin(), packed.end(), out.begin());
    } else if (entry.method == 8) {
        z_stream z{};
        z.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(packed.data()));
        z.avail_in = uInt(packed.size());
        z.next_out = reinterpret_cast<Bytef*>(out.data());
        z.avail_out = uInt(out.size());
        if (inflateInit2(&z, -MAX_WBITS) != Z_OK) refuse("zlib does not start");
        const int status = inflate(&z, Z_FINISH);
        inflateEnd(&z);
        if (status != Z_STREAM_END || z.total_out != out.size())
            refuse("array '" + name + "' does not unpack");
    } else {
        refuse("array '" + name + "' is packed by method " + std::to_string(entry.method) +
               ", only 0 (stored) and 8 (deflated) are read");
    }
    const auto crc = crc32(0, reinterpret_cast<const Bytef*>(out.data()), uInt(out.size()));
    if (crc != entry.crc) refuse("array '" + name + "' fails its checksum");
    return out;
}

NpzArray NpzFile::array(const std::string& name) const {
    const std::vector<std::byte> file = unpacked(name);
    const NpyHeader header = parse_npy_header(file, file_ + ": array '" + name + "'");
    if (header.kind != 'f')
        refuse("array '" + name + "' is of kind '" + header.kind +
               "', expected numbers of kind 'f'");
    const std::size_t bytes = file.size() - header.data_offset;
    const auto item = std::size_t(header.item_bytes);
    if (header.count > kLargestArrayBytes || std::size_t(header.count) * item != bytes)
        refuse("array '" + name + "' holds " + std::to_string(bytes) + " bytes, its shape needs " +
               std::to_string(header.count * item));
    NpzArray array{header.shape, std::vector<float>(std::size_t(header.count))};
    for (std::size_t i = 0; i < array.values.size(); ++i)
        array.values[i] = float(npy_number(header, file.data() + header.data_offset, i));
    return array;
}

}  // namespace eventide
