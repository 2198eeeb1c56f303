// A recording as a folder in the manner of the Event Camera Dataset.
#include "apps/cli/commands/ecd_writer.h"

#include "src/codec/text/text.h"
#include "src/core/duration_text.h"
#include "src/core/error.h"
#include "src/core/whole_sensor.h"
#include "src/io/image_codecs.h"

#include <span>
#include <vector>

namespace eventide::app {

namespace fs = std::filesystem;

RunFolderFiles EcdWriter::files() {
    return {{{"images", "frame_", 8, ".png"}},
            {"events.txt", "images.txt", "exposure.txt"},
            "images.txt",
            {"exposure.txt"}};
}

EcdWriter::EcdWriter(const fs::path& folder, bool overwrite, int width, int height)
    : width_{width}, height_{height}, folder_{folder, overwrite, files()} {}

void EcdWriter::begin() {
    if (events_) return;
    folder_.begin();
    const OutputOptions growing{.appears = Appears::growing};
    list_.emplace(folder_.path() / "images.txt", growing);
    exposures_.emplace(folder_.path() / "exposure.txt", growing);
    StreamHeader header;
    header.format = "text";
    header.width = width_;
    header.height = height_;
    events_ = std::make_unique<RecordingFile>((folder_.path() / "events.txt").string(), false,
                                              std::make_unique<TextWriter>(TextSize::in_a_comment),
                                              header);
}

void EcdWriter::write(const Batch& batch) {
    if (batch.events.empty() && batch.images.empty()) return;
    begin();
    Batch events;
    events.events = batch.events;
    if (!events.empty()) events_->write(events);
    for (const ReferenceImage& image : batch.images) write(image);
}

void EcdWriter::write(const ReferenceImage& image) {
    std::vector<unsigned char> png;
    const fs::path file = folder_.next(0);
    if (!encode_image(".png", covering_sensor(image), png))
        throw Error(ErrorKind::failed, file.string() + ": cannot be encoded");
    // Before the image: what is in the folder is in the list, also after a crash.
    const std::string line = seconds_text(image.t) + " images/" + file.filename().string() + "\n";
    const std::string exposure =
        seconds_text(image.exposure_begin) + " " + seconds_text(image.exposure_end) + "\n";
    exposures_->write(exposure);
    list_->write(line);
    write_file(file, std::as_bytes(std::span{png}), false);
    image_bytes_ += line.size() + exposure.size() + png.size();
}

/// In 8 bits, as the dataset's images are, on black where the image is of a part of the sensor: the
/// folder has no place for where that part lies.
cv::Mat EcdWriter::covering_sensor(const ReferenceImage& image) const {
    if (!covers_sensor(image, width_, height_))
        return covering_sensor(on_whole_sensor(image, width_, height_));
    const cv::Mat wide(height_, width_, CV_MAKETYPE(CV_16U, image.channels),
                       const_cast<std::uint16_t*>(image.pixels.values().data()));
    cv::Mat narrow;
    wide.convertTo(narrow, CV_8U, 1.0 / 257);
    return narrow;
}

void EcdWriter::finish() {
    if (folder_.holds_earlier_run()) return;  // there is nothing to put in its place
    begin();
    events_->finish();
    list_->close();
    exposures_->close();
    folder_.finish();
}

}  // namespace eventide::app
