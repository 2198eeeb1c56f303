// One H.264 stream in one file, through libav.
#include "pipeline/sinks/video_file.h"

#include "pipeline/sinks/yuv.h"
#include "src/core/error.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
}

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

namespace eventide {

namespace {

constexpr AVRational kMicroseconds{1, 1'000'000};

/// Frames per group of pictures, and so per MP4 fragment: what a killed run can lose.
constexpr int kKeyInterval = 30;

std::string words_of(int error) {
    char text[AV_ERROR_MAX_STRING_SIZE]{};
    av_strerror(error, text, sizeof text);
    return text;
}

bool is_mp4(const AVFormatContext& container) {
    return std::string_view{container.oformat->name} == "mp4";
}

/// x264 itself prints to the terminal about these.
void refuse_wrong(const EncoderSettings& settings, const std::filesystem::path& path) {
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

void VideoFile::Free::operator()(AVCodecContext* p) const {
    avcodec_free_context(&p);
}
void VideoFile::Free::operator()(AVFormatContext* p) const {
    avio_closep(&p->pb);
    avformat_free_context(p);
}
void VideoFile::Free::operator()(AVFrame* p) const {
    av_frame_free(&p);
}
void VideoFile::Free::operator()(AVPacket* p) const {
    av_packet_free(&p);
}

void VideoFile::check(int result, const char* doing) const {
    if (result < 0)
        throw Error(ErrorKind::failed,
                    path_.string() + ": " + doing + " failed: " + words_of(result));
}

VideoFile::VideoFile(std::filesystem::path path, EncoderSettings settings)
    : path_{std::move(path)}, settings_{std::move(settings)} {
    const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
    if (codec == nullptr)
        throw Error(ErrorKind::failed, path_.string() +
                                           ": this libavcodec has no libx264, which "
                                           "eventide's videos need");
    refuse_wrong(settings_, path_);
    const AVOutputFormat* format = av_guess_format(nullptr, path_.c_str(), nullptr);
    if (format == nullptr || !(path_.extension() == ".mp4" || path_.extension() == ".mkv"))
        throw Error(ErrorKind::usage,
                    path_.string() + ": expected a video file ending in .mp4 or .mkv");
    AVFormatContext* container = nullptr;
    check(avformat_alloc_output_context2(&container, format, nullptr, path_.c_str()),
          "preparing it");
    container_.reset(container);
    encoder_.reset(avcodec_alloc_context3(codec));
    frame_.reset(av_frame_alloc());
    packet_.reset(av_packet_alloc());
    // What goes wrong comes back as a result; x264's own talk is not for the terminal.
    encoder_->log_level_offset = AV_LOG_MAX_OFFSET;
    check(av_opt_set(encoder_->priv_data, "preset", settings_.preset.c_str(), 0),
          "choosing x264's preset");
    check(avio_open(&container_->pb, path_.c_str(), AVIO_FLAG_WRITE), "creating it");
}

VideoFile::~VideoFile() = default;

void VideoFile::open_encoder(const cv::Mat& picture) {
    type_ = picture.type();
    width_ = picture.cols;
    height_ = picture.rows;
    encoder_->width = even(width_);
    encoder_->height = even(height_);
    encoder_->pix_fmt = AV_PIX_FMT_YUV420P;
    encoder_->color_range = AVCOL_RANGE_MPEG;
    encoder_->colorspace = AVCOL_SPC_BT709;
    encoder_->color_primaries = AVCOL_PRI_BT709;
    encoder_->color_trc = AVCOL_TRC_BT709;
    encoder_->time_base = kMicroseconds;
    encoder_->framerate = av_d2q(settings_.fps, 1'000'000);
    encoder_->gop_size = kKeyInterval;
    // Frames leave in the order of their times: exact stamps without an edit list.
    encoder_->max_b_frames = 0;
    if (container_->oformat->flags & AVFMT_GLOBALHEADER)
        encoder_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    av_opt_set_double(encoder_->priv_data, "crf", settings_.crf, 0);
    // A long look ahead would keep that many frames out of the file.
    av_opt_set_int(encoder_->priv_data, "rc-lookahead", 10, 0);
    if (avcodec_open2(encoder_.get(), encoder_->codec, nullptr) < 0)
        throw Error(ErrorKind::failed, path_.string() + ": x264 refuses pictures of " +
                                           std::to_string(width_) + "x" + std::to_string(height_));

    stream_ = avformat_new_stream(container_.get(), nullptr);
    stream_->time_base = kMicroseconds;
    stream_->avg_frame_rate = encoder_->framerate;
    check(avcodec_parameters_from_context(stream_->codecpar, encoder_.get()), "describing it");
    AVDictionary* options = nullptr;
    if (is_mp4(*container_)) {
        av_dict_set(&options, "movflags", "frag_keyframe+empty_moov+default_base_moof", 0);
        av_dict_set_int(&options, "video_track_timescale", kMicroseconds.den, 0);
    }
    container_->flags |= AVFMT_FLAG_FLUSH_PACKETS;
    const int result = avformat_write_header(container_.get(), &options);
    av_dict_free(&options);
    check(result, "writing its header");

    frame_->format = encoder_->pix_fmt;
    frame_->width = encoder_->width;
    frame_->height = encoder_->height;
    check(av_frame_get_buffer(frame_.get(), 0), "making a buffer");
}

void VideoFile::write(const cv::Mat& picture, std::int64_t t_us) {
    if (stream_ == nullptr) open_encoder(picture);
    if (picture.cols != width_ || picture.rows != height_ || picture.type() != type_)
        throw Error(ErrorKind::failed, path_.string() + ": expected frames of " +
                                           std::to_string(width_) + "x" + std::to_string(height_) +
                                           ", found one of " + std::to_string(picture.cols) + "x" +
                                           std::to_string(picture.rows));
    // The encoder may still read the buffer of the frame before.
    check(av_frame_make_writable(frame_.get()), "making a buffer");
    to_yuv420(
        picture, YuvRange::limited,
        {Plane{frame_->data[0], frame_->linesize[0]}, Plane{frame_->data[1], frame_->linesize[1]},
         Plane{frame_->data[2], frame_->linesize[2]}});
    frame_->pts = t_us;
    encode(frame_.get());
}

void VideoFile::encode(const AVFrame* frame) {
    check(avcodec_send_frame(encoder_.get(), frame), "encoding");
    for (;;) {
        const int result = avcodec_receive_packet(encoder_.get(), packet_.get());
        if (result == AVERROR(EAGAIN) || result == AVERROR_EOF) return;
        check(result, "encoding");
        packet_->stream_index = stream_->index;
        packet_->duration = std::llround(1e6 / settings_.fps);
        av_packet_rescale_ts(packet_.get(), kMicroseconds, stream_->time_base);
        check(av_write_frame(container_.get(), packet_.get()), "writing");
        av_packet_unref(packet_.get());
    }
}

void VideoFile::finish() {
    if (std::exchange(finished_, true)) return;
    if (stream_ == nullptr) {
        avio_closep(&container_->pb);
        if (std::filesystem::is_regular_file(path_)) std::filesystem::remove(path_);
        return;
    }
    encode(nullptr);
    check(av_write_trailer(container_.get()), "ending it");
    check(avio_closep(&container_->pb), "closing it");
}

}  // namespace eventide
