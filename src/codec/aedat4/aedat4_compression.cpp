// LZ4 frames by lz4frame (blocks may depend on each other), ZSTD frames by libzstd.
#include "src/codec/aedat4/aedat4_compression.h"

#include "src/core/error.h"

#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <string>

namespace eventide {

namespace {

constexpr std::size_t kMaxAtOnce = std::size_t(256) << 10;  // bytes; more only for who fills them

void pack_lz4(std::span<const std::byte> bytes, int level, std::vector<std::byte>& out) {
    LZ4F_preferences_t preferences{};
    // Independent blocks of 256 KiB: a packet is mostly one block, and its reader needs no history.
    preferences.frameInfo.blockSizeID = LZ4F_max256KB;
    preferences.frameInfo.blockMode = LZ4F_blockIndependent;
    preferences.frameInfo.contentSize = bytes.size();
    preferences.compressionLevel = level;
    const std::size_t begin = out.size();
    out.resize(begin + LZ4F_compressFrameBound(bytes.size(), &preferences));
    const std::size_t size = LZ4F_compressFrame(out.data() + begin, out.size() - begin,
                                                bytes.data(), bytes.size(), &preferences);
    if (LZ4F_isError(size))
        throw Error(ErrorKind::failed, "LZ4: " + std::string(LZ4F_getErrorName(size)));
    out.resize(begin + size);
}

void pack_zstd(std::span<const std::byte> bytes, int level, std::vector<std::byte>& out) {
    const std::size_t begin = out.size();
    out.resize(begin + ZSTD_compressBound(bytes.size()));
    const std::size_t size =
        ZSTD_compress(out.data() + begin, out.size() - begin, bytes.data(), bytes.size(), level);
    if (ZSTD_isError(size))
        throw Error(ErrorKind::failed, "ZSTD: " + std::string(ZSTD_getErrorName(size)));
    out.resize(begin + size);
}

}  // namespace

Aedat4Compression usual_aedat4_compression() {
    return Aedat4Compression::lz4;
}

// Made with the first packet that needs one: most files have one kind, and many packets are bare.
struct Aedat4Unpacker::Contexts {
    LZ4F_dctx* lz4 = nullptr;
    ZSTD_DCtx* zstd = nullptr;
};

Aedat4Unpacker::Aedat4Unpacker(std::size_t largest)
    : largest_(largest), contexts_(std::make_unique<Contexts>()) {}

Aedat4Unpacker::~Aedat4Unpacker() {
    LZ4F_freeDecompressionContext(contexts_->lz4);
    ZSTD_freeDCtx(contexts_->zstd);
}

std::optional<std::size_t> Aedat4Unpacker::unpack_lz4(std::span<const std::byte> packed,
                                                      bool& too_small) {
    if (contexts_->lz4 == nullptr &&
        LZ4F_isError(LZ4F_createDecompressionContext(&contexts_->lz4, LZ4F_VERSION)))
        throw Error(ErrorKind::failed, "LZ4: no memory for a decompression context");
    LZ4F_resetDecompressionContext(contexts_->lz4);
    LZ4F_decompressOptions_t options{};
    options.stableDst = 1;  // all goes to one place, so the history need not be kept elsewhere
    std::size_t read = 0, written = 0;
    for (;;) {
        std::size_t n_in = packed.size() - read, n_out = unpacked_.size() - written;
        const std::size_t hint = LZ4F_decompress(contexts_->lz4, unpacked_.data() + written, &n_out,
                                                 packed.data() + read, &n_in, &options);
        if (LZ4F_isError(hint)) return {};
        read += n_in;
        written += n_out;
        // What follows the frame is no part of it: the packet's size lies, and may swallow others.
        if (hint == 0) return read == packed.size() ? std::optional(written) : std::nullopt;
        too_small = written == unpacked_.size();
        if (too_small || (n_in == 0 && n_out == 0)) return {};
    }
}

std::optional<std::size_t> Aedat4Unpacker::unpack_zstd(std::span<const std::byte> packed,
                                                       bool& too_small) {
    if (contexts_->zstd == nullptr) contexts_->zstd = ZSTD_createDCtx();
    // In one call: the output is the window, so no memory is taken for what the frame claims.
    const std::size_t n = ZSTD_decompressDCtx(contexts_->zstd, unpacked_.data(), unpacked_.size(),
                                              packed.data(), packed.size());
    if (!ZSTD_isError(n)) return n;
    too_small = std::string_view(ZSTD_getErrorName(n)).find("too small") != std::string_view::npos;
    return {};
}

std::optional<std::span<const std::byte>> Aedat4Unpacker::unpack(
    std::span<const std::byte> packed) {
    const bool lz4 = is_lz4_frame(packed);
    if (!lz4 && !is_zstd_frame(packed)) return packed;
    constexpr std::size_t kUsualRatio = 4, kLeastBytes = 4096;
    const std::size_t likely = std::clamp(kUsualRatio * packed.size(), kLeastBytes, kMaxAtOnce);
    if (unpacked_.size() < likely) unpacked_.resize(likely);
    for (;;) {
        bool too_small = false;
        const auto n = lz4 ? unpack_lz4(packed, too_small) : unpack_zstd(packed, too_small);
        if (n) return std::span<const std::byte>(unpacked_).first(*n);
        if (!too_small || unpacked_.size() >= largest_) return {};
        unpacked_.clear();
        unpacked_.resize(std::min(2 * unpacked_.capacity(), largest_));
    }
}

void pack_aedat4(std::span<const std::byte> bytes, Aedat4Compression compression,
                 std::vector<std::byte>& out) {
    switch (compression) {
        case Aedat4Compression::none:
            out.insert(out.end(), bytes.begin(), bytes.end());
            break;
        case Aedat4Compression::lz4:
            pack_lz4(bytes, 0, out);
            break;
        case Aedat4Compression::lz4_high:
            pack_lz4(bytes, 9, out);
            break;
        case Aedat4Compression::zstd:
            pack_zstd(bytes, 3, out);
            break;
        case Aedat4Compression::zstd_high:
            pack_zstd(bytes, 15, out);
            break;
    }
}

}  // namespace eventide
