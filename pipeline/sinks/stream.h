// Frames as bytes into standard output, a named pipe or a file: Y4M, or raw numbers.
#pragma once

#include "pipeline/sink.h"
#include "pipeline/sinks/picture.h"

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace eventide {

enum class StreamFormat {
    y4m,       ///< YUV4MPEG2, C420jpeg, full range: what every reader takes
    y4m_mono,  ///< YUV4MPEG2, Cmono: two thirds of the bytes; GStreamer 1.22 refuses it
    gray8,     ///< one byte a pixel, 255 white
    gray16,    ///< 16 bits, little endian, 65535 white
    grayf32    ///< float, little endian, 1 white, not clamped; sigma in units of intensity
};

std::string_view name_of(StreamFormat format);

struct StreamSettings {
    std::string path = {};  ///< "-" is standard output
    StreamFormat format = StreamFormat::y4m;
    bool overwrite = false;
    /// Y4M: none, side; overlay in y4m (colour). Raw: none, side, separate (after each intensity
    /// its sigma, the same size) and alpha (the two interleaved: intensity, then 1 - sigma /
    /// sigma_white, ffmpeg's ya8 and ya16le). In grayf32 with side and separate sigma stays as it
    /// is.
    Uncertainty uncertainty = Uncertainty::automatic;
    float sigma_white = kSigmaWhite;
    double fps = 30;  ///< nominal, > 0, for the header of Y4M, which has no other times
    /// Asked while a named pipe waits for its reader: true gives up. May be empty.
    std::function<bool()> give_up = {};
};

/// SIGPIPE must be ignored by the program. When the reader goes away, wants_more() is false from
/// then on and what is written goes nowhere: that is no error.
class StreamSink : public Sink {
public:
    /// Opens the target; a named pipe waits for its reader. Throws Error (usage) for a combination
    /// that does not exist and for an existing file without overwrite, (failed) when it cannot
    /// open.
    explicit StreamSink(StreamSettings settings);
    ~StreamSink() override;
    StreamSink(const StreamSink&) = delete;
    StreamSink& operator=(const StreamSink&) = delete;

    void write(const Frame& frame) override;
    void close() override;
    bool wants_more() const override { return !reader_gone_; }

private:
    void append_y4m(const Frame& frame);
    void append_raw(const Frame& frame);
    void send();

    StreamSettings settings_;
    int file_ = -1;
    bool owned_ = false;  // standard output is not ours to close
    bool reader_gone_ = false;
    bool begun_ = false;
    cv::Mat picture_;
    std::vector<std::byte> bytes_;  // of one frame: one write, so that readers see whole frames
};

}  // namespace eventide
