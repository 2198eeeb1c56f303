// Frames as PNG and sigma as float TIFF in a folder, with their times beside them.
#pragma once

#include "pipeline/sink.h"
#include "pipeline/sinks/draw_frame.h"
#include "pipeline/sinks/run_folder.h"
#include "src/io/output_file.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace eventide {

struct FolderSettings {
    std::filesystem::path path = {};
    bool overwrite = false;  ///< replaces an earlier run, and only that (RunFolder)
    /// none leaves out the TIFFs; side, alpha and overlay change the PNGs and keep the TIFFs.
    Uncertainty uncertainty = Uncertainty::automatic;
    float sigma_white = kSigmaWhite;
    bool events = false;  ///< writes the frames' event previews; other sinks may want them, too
    /// Packets lost until now, for the column `lost`; may be empty. Any thread.
    std::function<std::uint64_t()> lost = {};
    /// A JSON object for run.json, asked for once, at close; may be empty.
    std::function<std::string()> run_json = {};
};

/// Writes
///   frames/frame_%010d.png        8 bit; numbered by this sink from 0, without holes
///   uncertainty/unc_%010d.tiff    sigma, float32, in units of intensity, exact
///   events/events_%010d.png       where asked for, of frames with an event preview
///   timestamps.txt                seconds of each frame, one a line, as E2VID writes it
///   timestamps.csv                frame, index, t_us, window_begin_us, window_end_us, events,
///   lost;
///                                 a jump of `index` is a skipped frame
///   run.json                      what of this is ours; whole at close
/// What is written is complete after each frame: a killed run loses at most the frame in work, and
/// every image is whole.
class FolderSink : public Sink {
public:
    /// Makes the folder; an earlier run in it goes with the first frame. Throws Error as RunFolder
    /// does.
    explicit FolderSink(FolderSettings settings);

    /// What it writes.
    static RunFolderFiles files();

    void write(const Frame& frame) override;
    void close() override;

private:
    void begin();
    void write_times(const Frame& frame);

    FolderSettings settings_;
    RunFolder folder_;
    std::optional<OutputFile> seconds_, table_;  // from the first frame on
    cv::Mat image_;
    std::uint64_t frames_ = 0;
    bool closed_ = false;
};

}  // namespace eventide
