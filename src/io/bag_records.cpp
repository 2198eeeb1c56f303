// Records are: u32 length and fields, u32 length and data; all little-endian
// (docs/protocols.md D, wiki.ros.org/Bags/Format/2.0).
#include "src/io/bag_records.h"

#include "src/core/error.h"
#include "src/io/bag_unpack.h"

#include <algorithm>
#include <array>

namespace eventide {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
// Of a record or an unpacked chunk. rosbag closes a chunk at 768 KiB, or after one longer message.
constexpr std::uint32_t kLongest = 1U << 28;
constexpr std::uint32_t kLongestHeader = 1U << 16;  // of what is passed over

bool is_bare_chunk(std::span<const std::byte> header) {
    const auto fields = bag_fields(header);
    const auto op = fields.find("op"), packing = fields.find("compression");
    return op != fields.end() && op->second == std::string_view("\5") &&
           (packing == fields.end() || packing->second == "none");
}

/// The record in front, which is taken from the bytes; empty where it is cut short.
std::optional<BagRecord> take_record(std::span<const std::byte>& bytes) {
    BlockReader reader{bytes};
    const auto header = reader.block();
    BagRecord record;
    record.data = reader.block();
    if (!reader.good()) return {};
    bytes = bytes.subspan(8 + header.size() + record.data.size());
    record.fields = bag_fields(header);
    const auto op = record.fields.find("op");
    if (op != record.fields.end() && op->second.size() == 1)
        record.op = static_cast<unsigned char>(op->second[0]);
    return record;
}

}  // namespace

std::map<std::string, std::string_view, std::less<>> bag_fields(std::span<const std::byte> bytes) {
    std::map<std::string, std::string_view, std::less<>> fields;
    for (BlockReader reader{bytes};;) {
        const std::string_view field = text_of(reader.block());
        if (!reader.good() || field.empty()) return fields;
        const std::size_t equals = std::min(field.find('='), field.size() - 1);
        fields[std::string{field.substr(0, equals)}] = field.substr(equals + 1);
    }
}

BagRecords::BagRecords(const std::filesystem::path& path)
    : path_(path), file_(path, std::ios::binary) {
    std::string magic(kMagic.size(), '\0');
    if (!file_.read(magic.data(), std::streamsize(magic.size())) || magic != kMagic)
        refuse("expected a ROS bag that begins with '#ROSBAG V2.0', found something else");
    size_ = std::filesystem::file_size(path);
    left_ = size_ - kMagic.size();
}

void BagRecords::go_to(std::uint64_t position) {
    file_.clear();
    file_.seekg(std::streamoff(position));
    left_ = size_ - position;
}

int BagRecords::skip() {
    if (left_ == 0) return -1;
    const auto length = [&] {
        std::array<char, 4> bytes;
        if (left_ < bytes.size() || !file_.read(bytes.data(), bytes.size()))
            refuse("expected the length of a record, found the end", DamageReason::truncated);
        left_ -= bytes.size();
        const auto n = load_little<std::uint32_t>(reinterpret_cast<const std::byte*>(bytes.data()));
        if (n > left_) refuse_short(n);
        left_ -= n;
        return n;
    };
    std::vector<std::byte> header(std::min(length(), kLongestHeader));
    file_.read(reinterpret_cast<char*>(header.data()), std::streamsize(header.size()));
    go_to(position());
    length();
    go_to(position());
    const auto fields = bag_fields(header);
    const auto op = fields.find("op");
    return op != fields.end() && op->second.size() == 1 ? op->second[0] : 0;
}

void BagRecords::refuse_short(std::uint64_t wanted) const {
    refuse("expected " + std::to_string(wanted) + " more bytes of a record, found " +
               std::to_string(left_) + ": the file is cut short",
           DamageReason::truncated);
}

bool BagRecords::read(const std::function<void(const BagRecord&)>& use) {
    const auto next = next_bytes();
    if (!next) return false;
    std::span<const std::byte> rest{next->bytes};
    const BagRecord record = parse(rest);
    if (next->missing > 0) {
        for (rest = record.data; const auto whole = take_record(rest);) use(*whole);
        refuse_short(next->missing);
    }
    if (record.op != BagRecord::chunk) {
        use(record);
        return true;
    }
    const std::vector<std::byte> unpacked = unpack(record);
    for (rest = unpacked; !rest.empty();) use(parse(rest));
    return true;
}

/// The two lengths and what they announce, in one piece.
std::optional<BagRecords::Bytes> BagRecords::next_bytes() {
    if (left_ == 0) return {};
    Bytes next;
    std::vector<std::byte>& bytes = next.bytes;
    for (int part = 0; part < 2; ++part) {
        const auto grow = [&](std::size_t n) {
            if (n > left_) refuse_short(n);
            const std::size_t at = bytes.size();
            bytes.resize(at + n);
            file_.read(reinterpret_cast<char*>(bytes.data() + at), std::streamsize(n));
            if (!file_) refuse("cannot be read");
            left_ -= n;
            return bytes.data() + at;
        };
        auto length = load_little<std::uint32_t>(grow(4));
        if (length > kLongest)
            refuse("expected records of at most 256 MiB, found one of " + std::to_string(length) +
                       " bytes",
                   DamageReason::bad_length);
        if (part == 1 && length > left_ &&
            is_bare_chunk(std::span{bytes}.subspan(4, bytes.size() - 8))) {
            next.missing = length - left_;
            length = std::uint32_t(left_);
            bytes.resize(bytes.size() - 4);
            append_little(bytes, length);
        }
        grow(length);
    }
    return next;
}

BagRecord BagRecords::parse(std::span<const std::byte>& bytes) const {
    const auto record = take_record(bytes);
    if (!record) refuse("expected whole records inside a chunk, found one cut short");
    return *record;
}

std::uint32_t BagRecords::number(const BagRecord& record, std::string_view field) const {
    const auto found = record.fields.find(field);
    if (found == record.fields.end() || found->second.size() != 4)
        refuse("expected a field '" + std::string{field} + "' of 4 bytes, found none");
    return load_little<std::uint32_t>(reinterpret_cast<const std::byte*>(found->second.data()));
}

std::vector<std::byte> BagRecords::unpack(const BagRecord& chunk) const {
    const std::uint32_t size = number(chunk, "size");
    const auto packing = chunk.fields.find("compression");
    const std::string name{packing == chunk.fields.end() ? "none" : packing->second};
    auto bytes = size <= kLongest ? unpack_bag_chunk(name, chunk.data, size) : std::nullopt;
    if (!bytes)
        refuse("expected a chunk that unpacks (none, bz2 or lz4) to " + std::to_string(size) +
                   " bytes, found one that does not ('" + name + "')",
               DamageReason::bad_compression);
    return *std::move(bytes);
}

void BagRecords::refuse(const std::string& what, DamageReason reason) const {
    throw BagError(reason, path_.string() + ": " + what);
}

}  // namespace eventide
