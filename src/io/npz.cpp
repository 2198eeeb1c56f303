// Zip archives of .npy files, unpacked array by array.
#include "src/io/npz.h"

#include "src/core/error.h"
#include "src/io/input_file.h"
#include "src/io/numpy_array.h"

#include <zlib.h>

#include <algorithm>
#include <span>
#include <utility>

namespace eventide {
namespace {

constexpr std::uint64_t kLargestArrayBytes = std::uint64_t{1} << 31;
constexpr std::uint64_t kMaxInflation = 1032;  // of deflate: 258 bytes from 2 bits

/// Whether the packed bytes are those of `out`, all of it, as deflate packs them.
bool inflates(std::span<const std::byte> packed, std::span<std::byte> out) {
    z_stream z{};
    z.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(packed.data()));
    z.avail_in = uInt(packed.size());
    z.next_out = reinterpret_cast<Bytef*>(out.data());
    z.avail_out = uInt(out.size());
    if (inflateInit2(&z, -MAX_WBITS) != Z_OK) return false;
    const int status = inflate(&z, Z_FINISH);
    inflateEnd(&z);
    return status == Z_STREAM_END && z.total_out == out.size();
}

}  // namespace

NpzFile::NpzFile(const std::filesystem::path& path)
    : file_(path.string()), bytes_(read_bytes_of_file(path)) {
    const auto read_at = [this](std::uint64_t offset, std::span<std::byte> into) {
        const auto rest = std::span{bytes_}.subspan(std::size_t(offset));
        const std::size_t count = std::min(rest.size(), into.size());
        std::copy_n(rest.begin(), count, into.begin());
        return count;
    };
    for (ZipEntry& entry : read_zip_directory({file_, bytes_.size(), read_at})) {
        std::string name = entry.name;
        if (name.ends_with(".npy")) name.resize(name.size() - 4);
        entries_.insert_or_assign(std::move(name), std::move(entry));
    }
}

void NpzFile::refuse(const std::string& what) const {
    throw Error(ErrorKind::input, file_ + ": " + what + " (expected an npz file)");
}

std::vector<std::byte> NpzFile::unpacked(const std::string& name) const {
    const auto found = entries_.find(name);
    if (found == entries_.end()) refuse("array '" + name + "' is missing");
    const ZipEntry& entry = found->second;
    const auto packed =
        std::span{bytes_}.subspan(std::size_t(entry.begin), std::size_t(entry.packed_size));
    // Before memory is taken for what the directory says.
    if (entry.size > kLargestArrayBytes || entry.size > packed.size() * kMaxInflation)
        refuse("array '" + name + "' is said to be of " + std::to_string(entry.size) +
               " bytes, which " + std::to_string(packed.size()) + " packed ones cannot give");
    std::vector<std::byte> out(std::size_t(entry.size));
    if (entry.method == 0) {
        if (packed.size() != out.size()) refuse("array '" + name + "' has two sizes");
        std::copy(packed.begin(), packed.end(), out.begin());
    } else if (entry.method == 8) {
        if (!inflates(packed, out)) refuse("array '" + name + "' does not unpack");
    } else {
        refuse("array '" + name + "' is packed by method " + std::to_string(entry.method) +
               ", only 0 (stored) and 8 (deflated) are read");
    }
    const auto crc = crc32(0, reinterpret_cast<const Bytef*>(out.data()), uInt(out.size()));
    if (crc != entry.crc) refuse("array '" + name + "' fails its checksum");
    return out;
}

NpzArray NpzFile::array(const std::string& name) const {
    const std::vector<std::byte> bytes = unpacked(name);
    MemoryBytes source{bytes};
    const NumpyArray array = read_numpy_header(source, file_ + ": array '" + name + "'");
    if (!array.is_of_numbers_in_rows() || array.fields.front().kind != 'f')
        refuse("array '" + name + "' is not of numbers of kind 'f' in C order");
    const NumpyField& number = array.fields.front();
    if (const auto held = bytes.size() - array.data_offset; held != array.items() * number.bytes)
        refuse("array '" + name + "' holds " + std::to_string(held) + " bytes, its shape needs " +
               std::to_string(array.items() * number.bytes));
    NpzArray out{{array.shape.begin(), array.shape.end()}, {}};
    out.values.reserve(std::size_t(array.items()));
    for (std::size_t at = std::size_t(array.data_offset); at < bytes.size(); at += number.bytes)
        out.values.push_back(float(numpy_number(number, bytes.data() + at)));
    return out;
}

}  // namespace eventide
