// Frames as bytes into standard output, a named pipe or a file.
#include "pipeline/sinks/raw_stream.h"

#include "pipeline/sinks/raw_pixels.h"
#include "pipeline/sinks/video/yuv.h"
#include "src/core/byte_order.h"
#include "src/core/error.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <numeric>
#include <utility>

namespace eventide {

namespace {

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

/// A frame rate as the fraction of integers Y4M wants, of 31 bits as its readers have them;
/// thousandths are exact, and slow rates to a second.
std::string rate_of(const StreamSettings& settings) {
    constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
    const FrameRate& rate = settings.rate;
    if (rate.is_set() && rate.frames <= kMost && rate.seconds <= kMost)
        return std::to_string(rate.frames) + ":" + std::to_string(rate.seconds);
    const double fps = settings.fps;
    if (fps < .1) return "1:" + std::to_string(std::llround(1 / fps));
    const auto thousandths = std::uint64_t(std::llround(fps * 1000));
    const std::uint64_t common = std::gcd(thousandths, std::uint64_t(1000));
    return std::to_string(thousandths / common) + ":" + std::to_string(1000 / common);
}

void append_text(std::vector<std::byte>& bytes, std::string_view text) {
    for (const char c : text) bytes.push_back(std::byte(c));
}

std::string header_of(const cv::Mat& image, const StreamSettings& settings) {
    const bool mono = settings.format == StreamFormat::y4m_mono;
    // 4:2:0 readers disagree about odd sizes, so there are none.
    const int width = mono ? image.cols : even(image.cols);
    const int height = mono ? image.rows : even(image.rows);
    return "YUV4MPEG2 W" + std::to_string(width) + " H" + std::to_string(height) + " F" +
           rate_of(settings) + " Ip A1:1 " + (mono ? "Cmono" : "C420jpeg") + " XCOLORRANGE=FULL\n";
}

}  // namespace

bool is_y4m(StreamFormat format) {
    return format == StreamFormat::y4m || format == StreamFormat::y4m_mono;
}

std::string_view name_of(StreamFormat format) {
    switch (format) {
        case StreamFormat::y4m_mono:
            return "y4m-mono";
        case StreamFormat::gray8:
            return "gray8";
        case StreamFormat::gray16:
            return "gray16";
        case StreamFormat::grayf32:
            return "grayf32";
        case StreamFormat::y4m:
            break;
    }
    return "y4m";
}

void FrameStamp::write_to(std::span<std::byte> bytes) const {
    constexpr std::string_view kMagic = "EVF";
    for (std::size_t i = 0; i < kMagic.size(); ++i) bytes[i] = std::byte(kMagic[i]);
    bytes[3] = std::byte(flags);
    std::ranges::copy(little_bytes(index), bytes.begin() + 4);
    std::ranges::copy(little_bytes(t_us), bytes.begin() + 8);
}

StreamSink::StreamSink(StreamSettings settings) : settings_{std::move(settings)} {
    if (!supports(settings_.format, settings_.uncertainty))
        throw Error(ErrorKind::usage,
                    settings_.path + ": " + std::string{name_of(settings_.format)} +
                        " cannot carry --uncertainty " +
                        std::string{name_of(settings_.uncertainty)} +
                        (is_y4m(settings_.format) ? "; expected none, side or (y4m) overlay"
                                                  : "; expected none, side, separate or alpha"));
    settings_.stamp = settings_.stamp && !is_y4m(settings_.format);  // its frames have headers
    file_.emplace(settings_.path, OutputOptions{.overwrite = settings_.overwrite,
                                                .appears = Appears::growing,
                                                .give_up = settings_.give_up,
                                                .unread = settings_.unread});
}

void StreamSink::write(const Frame& frame) {
    if (begun_ && repeats()) repeat_before(frame.index);
    if (!is_watched()) return;
    index_ = frame.index;
    bytes_.clear();
    if (is_y4m(settings_.format))
        append_y4m(frame);
    else
        append_raw(frame);
    if (!begun_ && settings_.live) file_->hold_at_most(bytes_.size());
    file_->write(bytes_);
    begun_ = true;
}

bool StreamSink::repeats() const {
    return settings_.overload == Overload::repeat ||
           (settings_.overload == Overload::automatic && !settings_.stamp);
}

/// What was skipped before frame `index`. A reader that is behind would fall back further with
/// every frame that is repeated for it, so it gets them when it has caught up.
void StreamSink::repeat_before(std::uint64_t index) {
    owed_ += index > index_ ? index - index_ - 1 : 0;
    for (; owed_ > 0 && is_watched() && file_->takes_at_once(); --owed_) {
        stamp_.index = std::uint32_t(index - owed_);
        stamp_.flags = FrameStamp::kRepeat;
        if (settings_.stamp) stamp_.write_to(bytes_);
        file_->write(bytes_);
    }
    // The stamps tell what is missing.
    if (settings_.stamp) owed_ = 0;
}

void StreamSink::append_y4m(const Frame& frame) {
    draw(frame, settings_.uncertainty, settings_.sigma_white, image_);
    if (!begun_) {
        append_text(bytes_, header_of(image_, settings_));
        file_->write(bytes_);  // apart, so that a frame that is repeated is a frame alone
        bytes_.clear();
    }
    // A tag of our own, which readers pass over: the stream's rate says nothing of sensor time.
    append_text(bytes_, "FRAME XT=" + std::to_string(to_us(frame.t)) + "\n");
    const std::size_t start = bytes_.size();
    const auto width = std::size_t(even(image_.cols)), height = std::size_t(even(image_.rows));
    if (settings_.format == StreamFormat::y4m_mono) {
        const auto* pixels = reinterpret_cast<const std::byte*>(image_.data);
        bytes_.insert(bytes_.end(), pixels, pixels + image_.total());
        return;
    }
    bytes_.resize(start + width * height * 3 / 2);
    auto* luma = reinterpret_cast<std::uint8_t*>(bytes_.data() + start);
    const auto half = std::ptrdiff_t(width / 2);
    std::uint8_t* chroma = luma + width * height;
    to_yuv420(image_, YuvCoding::jpeg,
              {Plane{luma, std::ptrdiff_t(width)}, Plane{chroma, half},
               Plane{chroma + width * height / 4, half}});
}

void StreamSink::append_raw(const Frame& frame) {
    const RawLayout layout{settings_.uncertainty, settings_.sigma_white};
    if (settings_.stamp) {
        stamp_ = {frame.gap_before ? FrameStamp::kGap : std::uint8_t(0), std::uint32_t(frame.index),
                  to_us(frame.t)};
        bytes_.resize(FrameStamp::kBytes);
        stamp_.write_to(bytes_);
    }
    switch (settings_.format) {
        case StreamFormat::gray8:
            return append_pixels<std::uint8_t>(frame, layout, bytes_);
        case StreamFormat::gray16:
            return append_pixels<std::uint16_t>(frame, layout, bytes_);
        default:
            return append_pixels<float>(frame, layout, bytes_);
    }
}

void StreamSink::close() {
    // A reader that went away was told of; it was not too slow.
    if (const std::uint64_t owed = std::exchange(owed_, 0);
        owed > 0 && is_watched() && settings_.shorter_by)
        settings_.shorter_by(owed);
    if (file_) file_->close();
    file_.reset();
}

}  // namespace eventide
