#include "src/evaluate/bag_unpack.h"

#include <bzlib.h>
#include <lz4frame.h>

#include <memory>

namespace eventide {
namespace {

bool unpack_bz2(std::span<const std::byte> bytes, std::span<std::byte> into) {
    auto size = static_cast<unsigned>(into.size());
    // The library's interface is older than const.
    auto* from = const_cast<char*>(reinterpret_cast<const char*>(bytes.data()));
    const int result = BZ2_bzBuffToBuffDecompress(reinterpret_cast<char*>(into.data()), &size, from,
                                                  static_cast<unsigned>(bytes.size()), 0, 0);
    return result == BZ_OK && size == into.size();
}

bool unpack_lz4(std::span<const std::byte> bytes, std::span<std::byte> into) {
    LZ4F_dctx* made = nullptr;
    if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION))) return false;
    const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context{
        made, LZ4F_freeDecompressionContext};
    std::size_t done = 0;
    while (true) {
        std::size_t out = into.size() - done, in = bytes.size();
        const std::size_t hint =
            LZ4F_decompress(context.get(), into.data() + done, &out, bytes.data(), &in, nullptr);
        if (LZ4F_isError(hint)) return false;
        done += out;
        bytes = bytes.subspan(in);
        if (hint == 0) return done == into.size();
        if (in == 0 && out == 0) return false;  // cut short, or longer than it said
    }
}

}  // namespace

std::optional<std::vector<std::byte>> unpack_bag_chunk(std::string_view packing,
                                                       std::span<const std::byte> bytes,
                                                       std::size_t size) {
    std::vector<std::byte> out(size);
    if (packing == "none") {
        if (bytes.size() != size) return {};
        out.assign(bytes.begin(), bytes.end());
        return out;
    }
    const bool good = packing == "bz2"   ? unpack_bz2(bytes, out)
                      : packing == "lz4" ? unpack_lz4(bytes, out)
                                         : false;
    return good ? std::optional(std::move(out)) : std::nullopt;
}

}  // namespace eventide
