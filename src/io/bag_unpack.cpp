#include "src/io/bag_unpack.h"

#include <bzlib.h>
#include <lz4frame.h>

#include <algorithm>
#include <memory>
#include <utility>

namespace eventide {
namespace {

/// A buffer that grows as it is filled, up to the size a chunk says it has: memory is taken for
/// what is there, not for what is said.
class GrowingBuffer {
public:
    explicit GrowingBuffer(std::size_t size) : size_(size) {
        bytes_.resize(std::min(kFirst, size));
    }

    /// What is not yet filled; empty only when all of it is.
    std::span<std::byte> room() {
        if (filled_ == bytes_.size()) bytes_.resize(std::min(2 * bytes_.size(), size_));
        return std::span{bytes_}.subspan(filled_);
    }
    void fill(std::size_t n) { filled_ += n; }
    bool is_full() const { return filled_ == size_; }
    std::vector<std::byte> take() && { return std::move(bytes_); }

private:
    static constexpr std::size_t kFirst = std::size_t{1} << 20;
    std::size_t size_, filled_ = 0;
    std::vector<std::byte> bytes_;
};

bool unpack_bz2(std::span<const std::byte> bytes, GrowingBuffer& into) {
    bz_stream stream{};
    if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return false;
    const std::unique_ptr<bz_stream, int (*)(bz_stream*)> end{&stream, BZ2_bzDecompressEnd};
    // The library's interface is older than const.
    stream.next_in = const_cast<char*>(reinterpret_cast<const char*>(bytes.data()));
    stream.avail_in = static_cast<unsigned>(bytes.size());
    for (int result = BZ_OK; result != BZ_STREAM_END;) {
        const auto room = into.room();
        stream.next_out = reinterpret_cast<char*>(room.data());
        stream.avail_out = static_cast<unsigned>(room.size());
        const unsigned in = stream.avail_in;
        result = BZ2_bzDecompress(&stream);
        if (result != BZ_OK && result != BZ_STREAM_END) return false;
        into.fill(room.size() - stream.avail_out);
        const bool stuck = stream.avail_out == room.size() && stream.avail_in == in;
        if (result == BZ_OK && stuck) return false;  // cut short, or longer than it said
    }
    return into.is_full();
}

bool unpack_lz4(std::span<const std::byte> bytes, GrowingBuffer& into) {
    LZ4F_dctx* made = nullptr;
    if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION))) return false;
    const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context{
        made, LZ4F_freeDecompressionContext};
    while (true) {
        const auto room = into.room();
        std::size_t out = room.size(), in = bytes.size();
        const std::size_t hint =
            LZ4F_decompress(context.get(), room.data(), &out, bytes.data(), &in, nullptr);
        if (LZ4F_isError(hint)) return false;
        into.fill(out);
        bytes = bytes.subspan(in);
        if (hint == 0) return into.is_full();
        if (in == 0 && out == 0) return false;  // cut short, or longer than it said
    }
}

}  // namespace

std::optional<std::vector<std::byte>> unpack_bag_chunk(std::string_view packing,
                                                       std::span<const std::byte> bytes,
                                                       std::size_t size) {
    if (packing == "none") {
        if (bytes.size() != size) return {};
        return std::vector(bytes.begin(), bytes.end());
    }
    GrowingBuffer out(size);
    const bool good = packing == "bz2"   ? unpack_bz2(bytes, out)
                      : packing == "lz4" ? unpack_lz4(bytes, out)
                                         : false;
    return good ? std::optional(std::move(out).take()) : std::nullopt;
}

}  // namespace eventide
