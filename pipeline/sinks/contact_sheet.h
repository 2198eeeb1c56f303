// One image of a whole run: rows of events, intensity, sigma and truth.
#pragma once

#include "pipeline/sink.h"
#include "pipeline/sinks/draw_frame.h"
#include "src/core/sensor_time.h"
#include "src/io/output_file.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace eventide {

struct ContactSheetSettings {
    std::filesystem::path path = {};  ///< .png or whatever else OpenCV writes
    bool overwrite = false;
    float sigma_white = kSigmaWhite;
    int rows = 4;  ///< frames on the sheet, >= 1
    /// Draws the sensor's reference image for a frame of this time and event window, CV_8UC1 or
    /// CV_8UC3 (BGR), or leaves the image empty where there is none; asked once frames have come to
    /// kTruthDelay after it, as images come later than they were taken. May be empty.
    std::function<void(SensorTime, const Window&, cv::Mat&)> draw_truth = {};
    std::string truth_caption = "truth";  ///< what those images are: a sensor's own are not truth
    ShownPart part = {};                  ///< that frames show
    /// Asked while a pipe waits for its reader: true gives up. May be empty.
    std::function<bool()> give_up = {};
    std::function<void(const std::string&, PipeReader)> unread = {};  ///< as OutputOptions has it
};

/// An exposure and a read-out, and an image more, which may be the nearer one.
constexpr SensorDuration kTruthDelay{500'000};

/// Columns are left out where no frame has anything for them: events need Frame::event_preview.
///
/// Spreads its rows evenly over the run, whose length it does not know: it keeps every 2^n-th frame
/// and forgets every other one when there are too many. Written at close.
class ContactSheetSink : public Sink {
public:
    /// Throws Error (usage) for an existing file without overwrite.
    explicit ContactSheetSink(ContactSheetSettings settings);

    void write(const Frame& frame) override;
    void close() override;

private:
    /// One frame's images, all of one size, CV_8UC3; an empty one where there is nothing to show.
    struct Row {
        SensorTime t{};
        Window window{};
        bool waits_for_truth = false;
        cv::Mat events, intensity, sigma, truth;
    };
    Row row_of(const Frame& frame) const;
    void draw_truth_until(SensorTime t);
    void drop_every_other();
    cv::Mat lay_out(const std::vector<Row>& rows) const;

    ContactSheetSettings settings_;
    std::vector<Row> kept_;
    std::uint64_t frames_ = 0, stride_ = 1;
    SensorTime first_{};
    bool closed_ = false;
};

}  // namespace eventide
