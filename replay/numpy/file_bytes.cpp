// Stored bytes by position, deflated ones by inflating up to it.
#include "replay/numpy/file_bytes.h"

#include <algorithm>

namespace eventide {

namespace {

constexpr std::size_t kBlock = std::size_t{1} << 16;

}  // namespace

bool StoredBytes::read_at(std::uint64_t offset, std::span<std::byte> into) {
    if (offset > size_ || into.size() > size_ - offset) return false;
    return file_.read_at(begin_ + offset, into) == into.size();
}

DeflatedBytes::DeflatedBytes(const ByteFile& file, std::uint64_t begin, std::uint64_t packed_size,
                             std::uint64_t size)
    : file_(file), begin_(begin), packed_size_(packed_size), size_(size), packed_(kBlock) {
    if (inflateInit2(&stream_, -MAX_WBITS) != Z_OK) broken_at_ = 0;
}

DeflatedBytes::~DeflatedBytes() {
    inflateEnd(&stream_);
}

void DeflatedBytes::begin_anew() {
    inflateReset(&stream_);
    stream_.avail_in = 0;
    taken_ = position_ = 0;
}

bool DeflatedBytes::read_at(std::uint64_t offset, std::span<std::byte> into) {
    if (offset > size_ || into.size() > size_ - offset) return false;
    // Not once more to where it ended the last time.
    if (broken_at_ && offset + into.size() > *broken_at_) return false;
    if (offset < position_) begin_anew();
    passed_over_.resize(kBlock);
    while (position_ < offset) {
        const auto n = std::size_t(std::min<std::uint64_t>(kBlock, offset - position_));
        if (!inflate_into(std::span(passed_over_).first(n))) return false;
    }
    return inflate_into(into);
}

bool DeflatedBytes::inflate_into(std::span<std::byte> into) {
    stream_.next_out = reinterpret_cast<Bytef*>(into.data());
    stream_.avail_out = uInt(into.size());
    while (stream_.avail_out > 0) {
        if (stream_.avail_in == 0) {
            const auto n = std::size_t(std::min<std::uint64_t>(kBlock, packed_size_ - taken_));
            const std::size_t got = file_.read_at(begin_ + taken_, std::span(packed_).first(n));
            stream_.next_in = reinterpret_cast<Bytef*>(packed_.data());
            stream_.avail_in = uInt(got);
            taken_ += got;
        }
        const uInt before = stream_.avail_out, in_before = stream_.avail_in;
        const int status = inflate(&stream_, Z_NO_FLUSH);
        position_ += before - stream_.avail_out;
        const bool stuck = stream_.avail_out == before && stream_.avail_in == in_before;
        if ((status != Z_OK && status != Z_STREAM_END) || stuck ||
            (status == Z_STREAM_END && stream_.avail_out > 0)) {
            broken_at_ = position_;
            return false;
        }
    }
    return true;
}

}  // namespace eventide
