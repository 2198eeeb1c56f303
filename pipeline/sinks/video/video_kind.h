// The kinds of video file, what differs between them, and their names.
#pragma once

#include <cstdint>
#include <filesystem>

namespace eventide {

struct VideoKind {
    const char* extension;  ///< ".mp4"
    const char* encoder;    ///< libav's name
    const char* pixels;     ///< likewise
    bool as_jpeg;           ///< YuvCoding::jpeg; else ::video
    int ticks_per_second;   ///< what times are rounded to; 0: each frame is one tick
    double most_fps;        ///< of its video time
    bool colour;
    int least_ticks;  ///< that players show a frame for, where frames have times of their own
    std::int64_t most_ticks;  ///< from one frame to the next that the file can hold
};

/// Throws Error (usage) for an extension that is none of ours.
const VideoKind& video_kind_of(const std::filesystem::path& path);

/// Whether the extension is that of a video; the file is not looked at.
bool names_video(const std::filesystem::path& path);

/// Where sigma goes when it has a video of its own: x.mp4 -> x.sigma.mp4.
std::filesystem::path sigma_path(std::filesystem::path path);

}  // namespace eventide
