// Frames into a virtual camera (v4l2loopback), for programs that open cameras.
#pragma once

#include "pipeline/sink.h"
#include "pipeline/sinks/draw_frame.h"
#include "pipeline/video_node.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

namespace eventide {

/// GREY is what a reconstruction is; YUYV is what most webcam programs accept; YU12 what encoders
/// like.
enum class V4l2PixelFormat { grey, yuyv, yu12 };

struct V4l2OutputSettings {
    std::filesystem::path node = {};  ///< "/dev/video10"
    std::optional<V4l2PixelFormat> format =
        {};  ///< empty: the first the device takes of YUYV, GREY, YU12
    Uncertainty uncertainty = Uncertainty::none;  ///< none or side
    float sigma_white = kSigmaWhite;
};

/// The size is fixed by the first frame; YUYV and YU12 need even sides, so an odd last column or
/// row is left out. Their black is 16 and their white 235: the default of V4L2 for YUV, which
/// readers undo.
///
/// The device keeps the newest frame for readers that are slow or absent: writing never waits. A
/// frame the device will not take at once is skipped and counted.
class V4l2OutputSink : public Sink {
public:
    /// Throws Error: usage for an uncertainty it cannot show, device for a node that is missing, no
    /// output device, or in use.
    explicit V4l2OutputSink(V4l2OutputSettings settings);

    /// Throws Error (device) when the device takes none of the formats or goes away, (failed) when
    /// the frames' size changes.
    void write(const Frame& frame) override;

    std::uint64_t skipped() const { return skipped_; }

private:
    void fix_format(int width, int height);
    bool try_format(V4l2PixelFormat format, int width, int height);
    void pack(const cv::Mat& image);
    [[noreturn]] void fail(const char* what, int error) const;

    V4l2OutputSettings settings_;
    FileDescriptor file_;
    int width_ = 0, height_ = 0;  // 0 until the first frame
    V4l2PixelFormat format_ = V4l2PixelFormat::grey;
    std::array<std::uint8_t, 256> luma_{};  // [grey]
    cv::Mat image_;
    std::vector<std::uint8_t> bytes_;  // one frame as the device takes it
    std::uint64_t skipped_ = 0;
};

}  // namespace eventide
