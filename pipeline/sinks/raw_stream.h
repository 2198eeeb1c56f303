// Frames as bytes into standard output, a named pipe or a file: Y4M, or raw numbers.
#pragma once

#include "pipeline/frame_clock.h"
#include "pipeline/sink.h"
#include "pipeline/sinks/draw_frame.h"
#include "src/io/output_file.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
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
bool is_y4m(StreamFormat format);

/// What a stream of constant rate does where frames were skipped.
enum class Overload {
    automatic,  ///< skip where frames are stamped, else repeat
    repeat,     ///< the frame before again, once the reader is ready to take it: the stream keeps
                ///< its pace, but where its reader is slower
    skip        ///< nothing: the stream is shorter than the time it shows
};

/// What stands before each frame of a stamped raw stream: 16 bytes, little endian.
struct FrameStamp {
    static constexpr std::size_t kBytes = 16;
    static constexpr std::uint8_t kGap = 1;     ///< as Frame::gap_before
    static constexpr std::uint8_t kRepeat = 2;  ///< the frame before again, with its time

    std::uint8_t flags = 0;
    std::uint32_t index = 0;  ///< the frame clock's number, its lower 32 bits
    std::int64_t t_us = 0;    ///< of the sensor

    /// "EVF", flags, index, t_us, at the beginning of `bytes`.
    void write_to(std::span<std::byte> bytes) const;
};

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
    double fps = 30;      ///< nominal, > 0, for the header of Y4M
    FrameRate rate = {};  ///< the same as a fraction, where there is one
    /// Raw formats: a FrameStamp before each frame. Y4M has the sensor's microseconds in each frame
    /// header anyway (XT=).
    bool stamp = false;
    /// `repeat` only where frames come at a constant rate, else their numbers say nothing.
    Overload overload = Overload::skip;
    /// The source is live: a pipe then holds no more than about a frame, so that a slow reader gets
    /// new ones.
    bool live = false;
    /// Asked while a named pipe waits for its reader: true gives up. May be empty.
    std::function<bool()> give_up = {};
    std::function<void(const std::string&, PipeReader)> unread = {};  ///< as OutputOptions has it
    /// Told at close() by how many frames the stream is shorter than the time it shows, where its
    /// reader was slower. May be empty.
    std::function<void(std::uint64_t)> shorter_by = {};
};

/// SIGPIPE must be ignored by the program. When the reader goes away, what is written goes nowhere,
/// which is no error.
class StreamSink : public Sink {
public:
    /// Opens the target; a named pipe waits for its reader. Throws Error (usage) for a combination
    /// that does not exist and for an existing file without overwrite, (failed) when it cannot
    /// open.
    explicit StreamSink(StreamSettings settings);

    void write(const Frame& frame) override;
    void close() override;
    bool is_watched() const override { return file_ && file_->is_read(); }

private:
    bool repeats() const;
    void repeat_before(std::uint64_t index);
    void append_y4m(const Frame& frame);
    void append_raw(const Frame& frame);

    StreamSettings settings_;
    std::optional<OutputFile> file_;  // until close()
    bool begun_ = false;
    cv::Mat image_;
    std::vector<std::byte> bytes_;  // of one frame: one write, so that readers see whole frames
    FrameStamp stamp_;              // of that frame
    std::uint64_t index_ = 0;       // of that frame
    std::uint64_t owed_ = 0;        // frames to be repeated that the reader was not ready to take
};

}  // namespace eventide
