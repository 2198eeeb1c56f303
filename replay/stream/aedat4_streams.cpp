// Packets are i32 stream, i32 size, payload.
#include "replay/stream/aedat4_streams.h"

#include "src/codec/aedat4/aedat4_compression.h"
#include "src/codec/aedat4/aedat4_flat.h"
#include "src/core/byte_order.h"

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <string_view>

namespace eventide {

namespace {

constexpr std::size_t kHeaderBytes = 8;
constexpr std::int32_t kMaxStreams = 256;
constexpr std::size_t kLargestFirst = std::size_t{1} << 24;  // bytes that are read for a look

struct Found {
    std::uint64_t packets = 0;
    std::string identifier;  ///< of the first; empty where it does not unpack
};

std::string identifier_of(const ByteFile& file, std::uint64_t position, std::size_t size) {
    std::vector<std::byte> payload(std::min(size, kLargestFirst));
    if (size > kLargestFirst || file.read_at(position, payload) < size) return {};
    Aedat4Unpacker unpacker;
    const auto unpacked = unpacker.unpack(payload);
    const auto root = unpacked ? read_flat_root(*unpacked) : std::nullopt;
    return root ? std::string(root->identifier) : std::string{};
}

std::map<std::int32_t, Found> streams_in_packets(const ByteFile& file, const Aedat4Header& header) {
    const std::uint64_t end = header.table_position > 0
                                  ? std::min(std::uint64_t(header.table_position), file.size())
                                  : file.size();
    std::map<std::int32_t, Found> streams;
    std::array<std::byte, kHeaderBytes> bytes;
    for (std::uint64_t at = header.stream.data_offset; at + kHeaderBytes <= end;) {
        if (file.read_at(at, bytes) < kHeaderBytes) break;
        const auto stream = load_little<std::int32_t>(bytes.data());
        const auto size = load_little<std::int32_t>(bytes.data() + 4);
        const bool good = stream >= 0 && stream < kMaxStreams && size > 0 &&
                          std::size_t(size) <= kLargestAedat4Packet;
        at += kHeaderBytes;
        if (!good || std::uint64_t(size) > end - at) break;
        Found& found = streams[stream];
        if (found.packets++ == 0) found.identifier = identifier_of(file, at, std::size_t(size));
        at += std::uint64_t(size);
    }
    return streams;
}

}  // namespace

std::vector<std::string> compare_aedat4_streams(const ByteFile& file, const Aedat4Header& header) {
    std::vector<std::string> remarks;
    if (header.streams.empty()) return remarks;  // then the packets themselves say what they are
    const auto found = streams_in_packets(file, header);
    for (const auto& [id, stream] : found) {
        const auto named = std::ranges::find(header.streams, id, &Aedat4Stream::id);
        const std::string packets = std::to_string(stream.packets) + " packets of stream " +
                                    std::to_string(id) + " (" +
                                    (stream.identifier.empty() ? "?" : stream.identifier) + ")";
        if (named == header.streams.end())
            remarks.push_back(packets + " are left out: the header names no such stream");
        else if (!stream.identifier.empty() && named->identifier != stream.identifier)
            remarks.push_back(packets + " are left out: the header calls them '" +
                              named->identifier + "'");
    }
    if (remarks.empty()) return remarks;
    for (const Aedat4Stream& stream : header.streams)
        if (!found.contains(stream.id))
            remarks.push_back("the header names a stream " + std::to_string(stream.id) + " ('" +
                              stream.identifier + "'), of which there is no packet");
    return remarks;
}

std::optional<std::string> find_joined_aedat4(const ByteFile& file, const Aedat4Header& header) {
    if (header.table_position <= 0) return {};
    const std::string_view begin = kAedat4Magic;
    std::string bytes(std::size_t{1} << 20, '\0');
    const std::uint64_t step = bytes.size() - begin.size();  // one that is cut is seen whole next
    for (auto at = std::uint64_t(header.table_position); at < file.size(); at += step) {
        const std::size_t n = file.read_at(at, std::as_writable_bytes(std::span(bytes)));
        const std::size_t found = std::string_view(bytes).substr(0, n).find(begin);
        if (found != begin.npos)
            return "another recording was joined to it, at byte " + std::to_string(at + found) +
                   ", and is left out: split the file there";
    }
    return {};
}

}  // namespace eventide
