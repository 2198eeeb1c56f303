// One stream of video in one file, through libav.
#include "pipeline/sinks/video/video_file.h"

#include "pipeline/sinks/video/libav.h"
#include "pipeline/sinks/video/video.h"
#include "pipeline/sinks/video/yuv.h"
#include "src/core/error.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace eventide {

namespace {

constexpr AVRational kMicroseconds{1, 1'000'000};

/// Frames per group of images, and so per MP4 fragment: what a killed run can lose.
constexpr int kKeyInterval = 30;

constexpr int kJpegQuality = 3;  // 1 best to 31: hard to tell from the original

constexpr int kBufferBytes = 32768;  // as libav's own files have

std::string words_of(int error) {
    char text[AV_ERROR_MAX_STRING_SIZE]{};
    libav().av_strerror(error, text, sizeof text);
    return text;
}

bool is_mp4(const AVFormatContext& container) {
    return std::string_view{container.oformat->name} == "mp4";
}

bool is_h264(const VideoKind& kind) {
    return std::string_view{kind.encoder} == "libx264";
}

/// x264 itself prints to the terminal about these.
void refuse_wrong(const EncoderSettings& settings, const VideoKind& kind,
                  const std::filesystem::path& path) {
    if (settings.fps > kind.most_fps) {
        char text[96];
        std::snprintf(text, sizeof text,
                      ": expected at most %g frames per second of video, found %g", kind.most_fps,
                      settings.fps);
        throw Error(ErrorKind::usage,
                    path.string() + text +
                        "; a lower --fps does it, and --slow N shows N times as many moments");
    }
    if (!is_h264(kind)) return;
    constexpr std::array<std::string_view, 9> kPresets{"ultrafast", "superfast", "veryfast",
                                                       "faster",    "fast",      "medium",
                                                       "slow",      "slower",    "veryslow"};
    if (std::find(kPresets.begin(), kPresets.end(), settings.preset) == kPresets.end()) {
        std::string expected;
        for (const std::string_view preset : kPresets) expected += " " + std::string{preset};
        throw Error(ErrorKind::usage, path.string() + ": expected one of x264's presets" +
                                          expected + ", found '" + settings.preset + "'");
    }
    if (settings.crf < 0 || settings.crf > 51)
        throw Error(ErrorKind::usage, path.string() + ": expected a crf from 0 to 51, found " +
                                          std::to_string(settings.crf));
}

}  // namespace

std::string video_library() {
    return "libavcodec " AV_STRINGIFY(LIBAVCODEC_VERSION);
}

bool encodes_h264() {
    return libav().avcodec_find_encoder_by_name("libx264") != nullptr;
}

void VideoFile::Free::operator()(AVCodecContext* p) const {
    libav().avcodec_free_context(&p);
}
void VideoFile::Free::operator()(AVFormatContext* p) const {
    libav().avformat_free_context(p);
}
void VideoFile::Free::operator()(AVIOContext* p) const {
    libav().av_freep(&p->buffer);
    libav().avio_context_free(&p);
}
void VideoFile::Free::operator()(AVFrame* p) const {
    libav().av_frame_free(&p);
}
void VideoFile::Free::operator()(AVPacket* p) const {
    libav().av_packet_free(&p);
}

/// libav hands our own errors on as numbers only; they come out here, with their words.
void VideoFile::check(int result, const char* doing) {
    if (failure_) std::rethrow_exception(failure_);
    if (result < 0)
        throw Error(ErrorKind::failed,
                    path_.string() + ": " + doing + " failed: " + words_of(result));
}

VideoFile::VideoFile(std::filesystem::path path, EncoderSettings settings)
    : path_{std::move(path)}, kind_{video_kind_of(path_)}, settings_{std::move(settings)} {
    const AVCodec* codec = libav().avcodec_find_encoder_by_name(kind_.encoder);
    const AVOutputFormat* format = libav().av_guess_format(nullptr, path_.c_str(), nullptr);
    if (codec == nullptr || format == nullptr)
        throw Error(ErrorKind::failed, path_.string() + ": expected libav to have " +
                                           kind_.encoder + " and " + kind_.extension +
                                           ", found one without");
    refuse_wrong(settings_, kind_, path_);
    AVFormatContext* container = nullptr;
    check(libav().avformat_alloc_output_context2(&container, format, nullptr, path_.c_str()),
          "preparing it");
    container_.reset(container);
    encoder_.reset(libav().avcodec_alloc_context3(codec));
    frame_.reset(libav().av_frame_alloc());
    packet_.reset(libav().av_packet_alloc());
    // What goes wrong comes back as a result; x264's own talk is not for the terminal.
    encoder_->log_level_offset = AV_LOG_MAX_OFFSET;
    if (is_h264(kind_))
        check(libav().av_opt_set(encoder_->priv_data, "preset", settings_.preset.c_str(), 0),
              "choosing x264's preset");
    file_ = std::make_unique<OutputFile>(path_, settings_.output);
    const auto buffer = static_cast<unsigned char*>(libav().av_malloc(kBufferBytes));
    bytes_.reset(libav().avio_alloc_context(buffer, kBufferBytes, 1, this, nullptr,
#if LIBAVFORMAT_VERSION_MAJOR >= 61
                                            put,
#else
                                    [](void* self, std::uint8_t* bytes, int size) {
                                        return put(self, bytes, size);
                                    },
#endif
                                            file_->is_seekable() ? seek : nullptr));
    container_->pb = bytes_.get();
    container_->flags |= AVFMT_FLAG_CUSTOM_IO;
}

/// What a muxer holds (GIF's the last image) it lets go of with its trailer alone, so where none
/// was written one comes now, for nobody.
VideoFile::~VideoFile() {
    if (!trailer_due_) return;
    is_given_up_ = true;
    libav().av_write_trailer(container_.get());
}

int VideoFile::put(void* self, const std::uint8_t* bytes, int size) {
    auto& file = *static_cast<VideoFile*>(self);
    if (file.is_given_up_) return AVERROR(EIO);
    try {
        file.put_here(std::as_bytes(std::span{bytes, std::size_t(size)}));
        return size;
    } catch (...) {  // not through C
        file.failure_ = std::current_exception();
        return AVERROR(EIO);
    }
}

std::int64_t VideoFile::seek(void* self, std::int64_t offset, int from) {
    auto& file = *static_cast<VideoFile*>(self);
    if ((from & AVSEEK_SIZE) != 0) return file.size_;
    const std::int64_t origin =
        from == SEEK_CUR ? file.position_ : (from == SEEK_END ? file.size_ : 0);
    if (origin + offset < 0 || origin + offset > file.size_) return AVERROR(EINVAL);
    return file.position_ = origin + offset;
}

void VideoFile::put_here(std::span<const std::byte> bytes) {
    const std::size_t over = std::min(bytes.size(), std::size_t(size_ - position_));
    if (over > 0) file_->write_at(std::uint64_t(position_), bytes.first(over));
    file_->write(bytes.subspan(over));
    position_ += std::int64_t(bytes.size());
    size_ = std::max(size_, position_);
}

void VideoFile::open_encoder(const cv::Mat& image) {
    type_ = image.type();
    width_ = image.cols;
    height_ = image.rows;
    encoder_->pix_fmt = libav().av_get_pix_fmt(kind_.pixels);
    const bool grey = encoder_->pix_fmt == AV_PIX_FMT_GRAY8;
    encoder_->width = grey ? width_ : even(width_);
    encoder_->height = grey ? height_ : even(height_);
    encoder_->color_range = kind_.as_jpeg ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
    encoder_->colorspace = kind_.as_jpeg ? AVCOL_SPC_BT470BG : AVCOL_SPC_BT709;
    encoder_->color_primaries = AVCOL_PRI_BT709;
    encoder_->color_trc = AVCOL_TRC_BT709;
    encoder_->framerate = libav().av_d2q(settings_.fps, 1'000'000);
    encoder_->time_base = kind_.ticks_per_second > 0 ? AVRational{1, kind_.ticks_per_second}
                                                     : av_inv_q(encoder_->framerate);
    encoder_->gop_size = kKeyInterval;
    // Frames leave in the order of their times: exact stamps without an edit list.
    encoder_->max_b_frames = 0;
    if (container_->oformat->flags & AVFMT_GLOBALHEADER)
        encoder_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    if (is_h264(kind_)) {
        libav().av_opt_set_double(encoder_->priv_data, "crf", settings_.crf, 0);
        // A long look ahead would keep that many frames out of the file.
        libav().av_opt_set_int(encoder_->priv_data, "rc-lookahead", 10, 0);
    }
    encoder_->flags |= AV_CODEC_FLAG_QSCALE;  // Motion JPEG; the others pass it over
    encoder_->global_quality = kJpegQuality * FF_QP2LAMBDA;
    if (libav().avcodec_open2(encoder_.get(), encoder_->codec, nullptr) < 0)
        throw Error(ErrorKind::failed, path_.string() + ": " + kind_.encoder +
                                           " refuses frames of " + std::to_string(width_) + "x" +
                                           std::to_string(height_));

    stream_ = libav().avformat_new_stream(container_.get(), nullptr);
    stream_->time_base = encoder_->time_base;
    stream_->avg_frame_rate = encoder_->framerate;
    check(libav().avcodec_parameters_from_context(stream_->codecpar, encoder_.get()),
          "describing it");
    AVDictionary* options = nullptr;
    if (is_mp4(*container_)) {
        libav().av_dict_set(&options, "movflags", "frag_keyframe+empty_moov+default_base_moof", 0);
        libav().av_dict_set_int(&options, "video_track_timescale", kMicroseconds.den, 0);
    }
    container_->flags |= AVFMT_FLAG_FLUSH_PACKETS;
    const int result = libav().avformat_write_header(container_.get(), &options);
    libav().av_dict_free(&options);
    check(result, "writing its header");
    header_written_ = trailer_due_ = true;

    frame_->format = encoder_->pix_fmt;
    frame_->width = encoder_->width;
    frame_->height = encoder_->height;
    check(libav().av_frame_get_buffer(frame_.get(), 0), "making a buffer");
}

void VideoFile::write(const cv::Mat& image, std::int64_t t_us) {
    if (!header_written_) open_encoder(image);
    if (image.cols != width_ || image.rows != height_ || image.type() != type_)
        throw Error(ErrorKind::failed, path_.string() + ": expected frames of " +
                                           std::to_string(width_) + "x" + std::to_string(height_) +
                                           ", found one of " + std::to_string(image.cols) + "x" +
                                           std::to_string(image.rows));
    // The encoder may still read the buffer of the frame before.
    check(libav().av_frame_make_writable(frame_.get()), "making a buffer");
    fill_frame(image);
    frame_->pts = tick_of(t_us);
    encode(frame_.get());
}

/// A pause that is too long for the file takes with it what is too much of it.
std::int64_t VideoFile::tick_of(std::int64_t t_us) {
    const std::int64_t tick =
        libav().av_rescale_q(t_us, kMicroseconds, encoder_->time_base) - cut_ticks_;
    if (!last_tick_) return *(last_tick_ = tick);
    const std::int64_t after = std::max<std::int64_t>(tick - *last_tick_, kind_.least_ticks);
    const std::int64_t held = std::min(after, kind_.most_ticks);
    cut_ticks_ += after - held;
    return *last_tick_ += held;
}

void VideoFile::fill_frame(const cv::Mat& image) {
    if (encoder_->pix_fmt == AV_PIX_FMT_GRAY8)
        return image.copyTo(cv::Mat(image.rows, image.cols, CV_8UC1, frame_->data[0],
                                    std::size_t(frame_->linesize[0])));
    to_yuv420(
        image, kind_.as_jpeg ? YuvCoding::jpeg : YuvCoding::video,
        {Plane{frame_->data[0], frame_->linesize[0]}, Plane{frame_->data[1], frame_->linesize[1]},
         Plane{frame_->data[2], frame_->linesize[2]}});
}

void VideoFile::encode(const AVFrame* frame) {
    check(libav().avcodec_send_frame(encoder_.get(), frame), "encoding");
    for (;;) {
        const int result = libav().avcodec_receive_packet(encoder_.get(), packet_.get());
        if (result == AVERROR(EAGAIN) || result == AVERROR_EOF) return;
        check(result, "encoding");
        packet_->stream_index = stream_->index;
        packet_->duration = libav().av_rescale_q(std::llround(1e6 / settings_.fps), kMicroseconds,
                                                 encoder_->time_base);
        libav().av_packet_rescale_ts(packet_.get(), encoder_->time_base, stream_->time_base);
        check(libav().av_write_frame(container_.get(), packet_.get()), "writing");
        libav().av_packet_unref(packet_.get());
    }
}

void VideoFile::finish() {
    if (std::exchange(finished_, true)) return;
    if (header_written_ && !failure_) {
        encode(nullptr);
        trailer_due_ = false;
        check(libav().av_write_trailer(container_.get()), "ending it");
        libav().avio_flush(bytes_.get());
        check(0, "closing it");
    }
    file_->close();
}

}  // namespace eventide
