// One H.264 stream in one file, through libav.
#pragma once

#include <opencv2/core.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

struct AVCodecContext;
struct AVFormatContext;
struct AVFrame;
struct AVPacket;
struct AVStream;

namespace eventide {

struct EncoderSettings {
    std::string preset;
    int crf = 18;
    double fps = 30;  ///< nominal, for the last frame's length
};

/// Throws Error (failed) naming the file when libav refuses; of kind usage for a preset x264 does
/// not have or an extension that is not a container.
class VideoFile {
public:
    VideoFile(std::filesystem::path path, EncoderSettings settings);
    ~VideoFile();

    /// CV_8UC1 or CV_8UC3 (BGR), the same size and type each time; `t_us` must grow.
    void write(const cv::Mat& picture, std::int64_t t_us);

    /// Drains the encoder and ends the file; removes it when it has no frame.
    void finish();

private:
    void open_encoder(const cv::Mat& picture);
    void encode(const AVFrame* frame);
    void check(int result, const char* doing) const;

    struct Free {
        void operator()(AVCodecContext* p) const;
        void operator()(AVFormatContext* p) const;
        void operator()(AVFrame* p) const;
        void operator()(AVPacket* p) const;
    };
    std::filesystem::path path_;
    EncoderSettings settings_;
    std::unique_ptr<AVFormatContext, Free> container_;
    std::unique_ptr<AVCodecContext, Free> encoder_;
    std::unique_ptr<AVFrame, Free> frame_;
    std::unique_ptr<AVPacket, Free> packet_;
    AVStream* stream_ = nullptr;  // the container's
    int width_ = 0, height_ = 0, type_ = -1;
    bool finished_ = false;
};

}  // namespace eventide
