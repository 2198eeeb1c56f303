// Frames as bytes into standard output, a named pipe or a file.
#include "pipeline/sinks/stream.h"

#include "pipeline/sinks/descriptor.h"
#include "pipeline/sinks/raw_pixels.h"
#include "pipeline/sinks/yuv.h"
#include "src/core/error.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numeric>
#include <utility>

namespace eventide {

namespace {

bool is_y4m(StreamFormat format) {
    return format == StreamFormat::y4m || format == StreamFormat::y4m_mono;
}

bool supports(StreamFormat format, Uncertainty how) {
    switch (how) {
        case Uncertainty::automatic:
        case Uncertainty::none:
        case Uncertainty::side:
            return true;
        case Uncertainty::overlay:
            return format == StreamFormat::y4m;
        case Uncertainty::separate:
        case Uncertainty::alpha:
            return !is_y4m(format);
    }
    return false;
}

/// A frame rate as the fraction of integers Y4M wants; thousandths are exact.
std::string rate_of(double fps) {
    const auto thousandths = std::uint64_t(std::llround(fps * 1000));
    const std::uint64_t common = std::gcd(thousandths, std::uint64_t(1000));
    return std::to_string(thousandths / common) + ":" + std::to_string(1000 / common);
}

void append_text(std::vector<std::byte>& bytes, std::string_view text) {
    for (const char c : text) bytes.push_back(std::byte(c));
}

std::string header_of(const cv::Mat& picture, StreamFormat format, double fps) {
    const bool mono = format == StreamFormat::y4m_mono;
    // 4:2:0 readers disagree about odd sizes, so there are none.
    const int width = mono ? picture.cols : even(picture.cols);
    const int height = mono ? picture.rows : even(picture.rows);
    return "YUV4MPEG2 W" + std::to_string(width) + " H" + std::to_string(height) + " F" +
           rate_of(fps) + " Ip A1:1 " + (mono ? "Cmono" : "C420jpeg") + " XCOLORRANGE=FULL\n";
}

}  // namespace

std::string_view name_of(StreamFormat format) {
    constexpr std::array<std::string_view, 5> kNames{"y4m", "y4m-mono", "gray8", "gray16",
                                                     "grayf32"};
    return kNames[std::size_t(format)];
}

StreamSink::StreamSink(StreamSettings settings) : settings_{std::move(settings)} {
    if (!supports(settings_.format, settings_.uncertainty))
        throw Error(ErrorKind::usage,
                    settings_.path + ": " + std::string{name_of(settings_.format)} +
                        " cannot carry --uncertainty " +
                        std::string{name_of(settings_.uncertainty)} +
                        (is_y4m(settings_.format) ? "; expected none, side or (y4m) overlay"
                                                  : "; expected none, side, separate or alpha"));
    owned_ = settings_.path != "-";
    file_ = owned_ ? open_for_writing(settings_.path, settings_.overwrite, settings_.give_up)
                   : kStandardOutput;
    reader_gone_ = file_ < 0;
}

StreamSink::~StreamSink() {
    if (owned_ && file_ >= 0) close_descriptor(file_);
}

void StreamSink::write(const Frame& frame) {
    if (reader_gone_) return;
    bytes_.clear();
    if (is_y4m(settings_.format))
        append_y4m(frame);
    else
        append_raw(frame);
    send();
}

void StreamSink::append_y4m(const Frame& frame) {
    draw(frame, settings_.uncertainty, settings_.sigma_white, picture_);
    if (!std::exchange(begun_, true))
        append_text(bytes_, header_of(picture_, settings_.format, settings_.fps));
    append_text(bytes_, "FRAME\n");
    const std::size_t start = bytes_.size();
    const auto width = std::size_t(even(picture_.cols)), height = std::size_t(even(picture_.rows));
    if (settings_.format == StreamFormat::y4m_mono) {
        const auto* pixels = reinterpret_cast<const std::byte*>(picture_.data);
        bytes_.insert(bytes_.end(), pixels, pixels + picture_.total());
        return;
    }
    bytes_.resize(start + width * height * 3 / 2);
    auto* luma = reinterpret_cast<std::uint8_t*>(bytes_.data() + start);
    const auto half = std::ptrdiff_t(width / 2);
    std::uint8_t* chroma = luma + width * height;
    to_yuv420(picture_, YuvRange::full,
              {Plane{luma, std::ptrdiff_t(width)}, Plane{chroma, half},
               Plane{chroma + width * height / 4, half}});
}

void StreamSink::append_raw(const Frame& frame) {
    const RawLayout layout{settings_.uncertainty, settings_.sigma_white};
    switch (settings_.format) {
        case StreamFormat::gray8:
            return append_pixels<std::uint8_t>(frame, layout, bytes_);
        case StreamFormat::gray16:
            return append_pixels<std::uint16_t>(frame, layout, bytes_);
        default:
            return append_pixels<float>(frame, layout, bytes_);
    }
}

void StreamSink::send() {
    switch (write_all(file_, bytes_)) {
        case WriteResult::written:
            return;
        case WriteResult::reader_gone:
            reader_gone_ = true;
            return;
        case WriteResult::failed:
            throw Error(ErrorKind::failed, (owned_ ? settings_.path : "standard output") +
                                               ": cannot be written: " + last_system_error());
    }
}

void StreamSink::close() {
    if (owned_ && file_ >= 0) close_descriptor(std::exchange(file_, -1));
    reader_gone_ = true;
}

}  // namespace eventide
