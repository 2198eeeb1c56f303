// Recordings being written, behind the public face.
#include "library/far_time.h"
#include "library/pushed_images.h"
#include "replay/convert.h"
#include "replay/formats.h"
#include "replay/recording_file.h"
#include "src/core/error.h"
#include "src/core/number_text.h"

#include <eventide/writer.h>

#include <string>

namespace eventide {
namespace {

const Format& format_of(const std::string& path, const WriterOptions& options) {
    const Format* format =
        options.format.empty() ? format_for_writing(path) : find_format(options.format);
    if (format != nullptr && format->is_written()) return *format;
    throw Error(ErrorKind::usage,
                path + ": expected a format that can be written (" + names_of_writable() +
                    "), found " +
                    (options.format.empty() ? "an extension that is of none" : options.format));
}

StreamHeader header_of(const Format& format, const SensorInfo& sensor, const std::string& path) {
    if (sensor.width < 1 || sensor.height < 1 || sensor.width > 65535 || sensor.height > 65535)
        throw Error(ErrorKind::usage, path + ": sensor size: expected 1 to 65535 px, found " +
                                          std::to_string(sensor.width) + "x" +
                                          std::to_string(sensor.height));
    StreamHeader header = eventide::header_of(sensor);
    header.format = format.name;
    return header;
}

OutputOptions output_options(const WriterOptions& options) {
    OutputOptions output{.overwrite = options.overwrite};
    if (options.while_waiting)
        output.give_up = [wait = options.while_waiting] {
            wait();
            return false;
        };
    return output;
}

}  // namespace

class EventWriter::Impl {
public:
    Impl(const std::string& path, const SensorInfo& sensor, const WriterOptions& options)
        : path_(path),
          format_(format_of(path, options)),
          width_(sensor.width),
          height_(sensor.height),
          file_(path, output_options(options), format_, header_of(format_, sensor, path)) {}

    void write(std::span<const Event> events) {
        held_.clear();
        held_.events.assign(events.begin(), events.end());
        write_held();
    }

    void write(const Batch& batch) {
        held_ = batch;
        const DataCounts left_out = remove_not_held(held_, format_.holds);
        write_held();
        not_held_ += left_out.events + left_out.images + left_out.imu + left_out.triggers;
    }

    void finish() {
        refuse_after_failure();
        if (!finished_) file_.finish();
        finished_ = true;
    }

    std::uint64_t not_held() const { return not_held_; }

private:
    /// A part of what failed may be in the file.
    void refuse_after_failure() const {
        if (failed_)
            throw Error(ErrorKind::usage, path_ +
                                              ": expected a recording that could be written so "
                                              "far, found one of which a write failed: nothing of "
                                              "it is kept");
    }

    void write_held() {
        refuse_after_failure();
        if (finished_)
            throw Error(ErrorKind::usage, path_ +
                                              ": expected a recording that is being written, "
                                              "found one after finish()");
        refuse_others();
        refuse_steps_back();
        failed_ = true;
        if (!held_.empty()) file_.write(held_);
        failed_ = false;
        if (!held_.events.empty()) newest_ = held_.events.back().t;
    }

    /// Readers would leave out what lies outside of the sensor or of all time.
    void refuse_others() const {
        for (const ReferenceImage& image : held_.images) {
            check_image(image);
            for (const SensorTime t : {image.t, image.exposure_begin, image.exposure_end})
                refuse_far(t, path_.c_str());
        }
        for (const ImuSample& sample : held_.imu) refuse_far(sample.t, path_.c_str());
        for (const Trigger& trigger : held_.triggers) refuse_far(trigger.t, path_.c_str());
        for (const Event& event : held_.events) {
            refuse_far(event.t, path_.c_str());
            if (event.x >= width_ || event.y >= height_)
                throw Error(ErrorKind::usage, path_ + ": expected events within " +
                                                  size_text(width_, height_) +
                                                  " px, found one at " + std::to_string(event.x) +
                                                  "," + std::to_string(event.y));
        }
    }

    /// Readers would leave out what comes before the newest event, and all until then.
    void refuse_steps_back() const {
        SensorTime newest = newest_;
        for (const Event& event : held_.events) {
            if (event.t < newest)
                throw Error(ErrorKind::usage,
                            path_ + ": expected events in order of time, found one at " +
                                std::to_string(to_us(event.t)) + " us after one at " +
                                std::to_string(to_us(newest)) + " us");
            newest = event.t;
        }
    }

    const std::string path_;
    const Format& format_;
    const int width_, height_;
    RecordingFile file_;
    Batch held_;
    SensorTime newest_ = SensorTime::min();  // of the events written
    std::uint64_t not_held_ = 0;
    bool finished_ = false, failed_ = false;
};

EventWriter::EventWriter(const std::string& path, const SensorInfo& sensor,
                         const WriterOptions& options)
    : impl_(std::make_unique<Impl>(path, sensor, options)) {}
EventWriter::~EventWriter() = default;
EventWriter::EventWriter(EventWriter&&) noexcept = default;
EventWriter& EventWriter::operator=(EventWriter&&) noexcept = default;

void EventWriter::write(std::span<const Event> events) {
    impl_->write(events);
}
void EventWriter::write(const Batch& batch) {
    impl_->write(batch);
}
void EventWriter::finish() {
    impl_->finish();
}
std::uint64_t EventWriter::not_held() const noexcept {
    return impl_->not_held();
}

}  // namespace eventide
