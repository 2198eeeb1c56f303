// Frames as video: H.264 in MP4 or Matroska, each with its own exact time; Motion JPEG; GIF.
#pragma once

#include "pipeline/sink.h"
#include "pipeline/sinks/draw_frame.h"
#include "src/io/output_file.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace eventide {

class VideoFile;

struct VideoSettings {
    std::filesystem::path path = {};  ///< .mp4, .mkv, .avi or .gif
    bool overwrite = false;           ///< an existing file that is not empty is refused without
    /// separate writes a second file, x.sigma.mp4; alpha is refused, H.264 has none.
    Uncertainty uncertainty = Uncertainty::automatic;
    float sigma_white = kSigmaWhite;
    std::string preset = "veryfast";  ///< x264's
    int crf = 18;                     ///< 0 lossless to 51 worst; 18 looks lossless
    double fps = 30;      ///< nominal, > 0: for the last frame's length and players' displays
    double slow = 1;      ///< the video is so many times as long as what it shows
    bool events = false;  ///< left of the intensity, where frames have Frame::event_preview; in GIF
                          ///< grey: ON light, OFF dark
    ShownPart part = {};  ///< that frames show
    /// Asked while a pipe waits for its reader: true gives up. May be empty.
    std::function<bool()> give_up = {};
    std::function<void(const std::string&, PipeReader)> unread = {};  ///< as OutputOptions has it
};

/// "libavcodec 59.37.100", which encodes them; "no FFmpeg" in a build without EVENTIDE_VIDEO.
std::string video_library();

/// Whether that has an encoder for H.264. Throws Error (failed) where it is not installed.
bool encodes_h264();

/// Time stamps are the frames' sensor times minus the first one's, times `slow`, in microseconds
/// (time base 1/10^6; Matroska rounds them to 1 ms). Should sensor time go back, the frame follows
/// the one before after 1/fps, and so do the next ones. A pause is shortened to 35 min in MP4,
/// 60,000 frames in Motion JPEG and 10 min in GIF, which cannot hold a longer one.
///
/// MP4 is written in fragments of 30 frames, so that a killed run leaves a file that plays
/// up to the last fragment. H.264 with 4:2:0 chroma needs even sizes: an odd row or column is added
/// by repeating the last.
class VideoSink : public Sink {
public:
    /// Creates the file. Throws Error (usage) for what the sink cannot do, (failed) when the file
    /// or the encoder cannot be opened.
    explicit VideoSink(VideoSettings settings);
    ~VideoSink() override;

    void write(const Frame& frame) override;
    /// A file without a frame would not be a video: it is not left behind.
    void close() override;
    bool is_watched() const override;

private:
    std::int64_t microseconds_to_show(SensorTime t);

    VideoSettings settings_;
    cv::Mat image_;
    std::unique_ptr<VideoFile> intensity_, sigma_;
    SensorTime origin_{};  // shown at begin_us_
    std::int64_t begin_us_ = 0;
    std::optional<SensorTime> last_;  // of the frame before
};

}  // namespace eventide
