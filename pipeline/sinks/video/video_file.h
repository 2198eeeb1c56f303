// One stream of video in one file, through libav.
#pragma once

#include "pipeline/sinks/video/video_kind.h"
#include "src/io/output_file.h"

#include <opencv2/core.hpp>

#include <cstdint>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

struct AVCodecContext;
struct AVFormatContext;
struct AVFrame;
struct AVIOContext;
struct AVPacket;
struct AVStream;

namespace eventide {

struct EncoderSettings {
    std::string preset;
    int crf = 18;
    double fps = 30;  ///< nominal, for the last frame's length
    OutputOptions output = {.appears = Appears::growing};
};

/// Times are rounded to what the kind of file knows; a frame that would fall on the one before
/// follows it, and a pause that the kind of file cannot hold is shortened. Throws Error (failed)
/// naming the file when libav refuses; of kind usage for a preset x264 does not have, a rate that
/// is too high, or an extension that is not a kind of video.
class VideoFile {
public:
    VideoFile(std::filesystem::path path, EncoderSettings settings);
    ~VideoFile();

    /// CV_8UC1 or CV_8UC3 (BGR), the same size and type each time; `t_us` must not fall.
    void write(const cv::Mat& image, std::int64_t t_us);

    /// Drains the encoder and ends the file; without a frame none is left behind. After a write
    /// that failed it only closes.
    void finish();

    bool is_read() const { return file_->is_read(); }  ///< as OutputFile has it

private:
    void open_encoder(const cv::Mat& image);
    void fill_frame(const cv::Mat& image);
    std::int64_t tick_of(std::int64_t t_us);
    void encode(const AVFrame* frame);
    void check(int result, const char* doing);

    // What libav calls to write; `self` is a VideoFile.
    static int put(void* self, const std::uint8_t* bytes, int size);
    static std::int64_t seek(void* self, std::int64_t offset, int from);
    void put_here(std::span<const std::byte> bytes);

    struct Free {
        void operator()(AVCodecContext* p) const;
        void operator()(AVFormatContext* p) const;
        void operator()(AVFrame* p) const;
        void operator()(AVIOContext* p) const;
        void operator()(AVPacket* p) const;
    };
    std::filesystem::path path_;
    const VideoKind& kind_;
    EncoderSettings settings_;
    std::unique_ptr<OutputFile> file_;
    std::int64_t position_ = 0, size_ = 0;  // bytes; libav goes back to mend what it wrote
    std::exception_ptr failure_;            // of the file, on its way through libav
    std::unique_ptr<AVIOContext, Free> bytes_;
    std::unique_ptr<AVFormatContext, Free> container_;
    std::unique_ptr<AVCodecContext, Free> encoder_;
    std::unique_ptr<AVFrame, Free> frame_;
    std::unique_ptr<AVPacket, Free> packet_;
    AVStream* stream_ = nullptr;  // the container's
    int width_ = 0, height_ = 0, type_ = -1;
    std::optional<std::int64_t> last_tick_;  // of the frame before
    std::int64_t cut_ticks_ = 0;             // of pauses, so far
    bool header_written_ = false, trailer_due_ = false, finished_ = false;
    bool is_given_up_ = false;  // nothing more goes into the file
};

}  // namespace eventide
