// Recordings behind the public face.
#include "drivers/devices.h"
#include "library/later_part.h"
#include "library/source_filters.h"
#include "replay/formats.h"
#include "replay/summary.h"
#include "src/core/batch_pieces.h"
#include "src/core/error.h"

#include <eventide/reader.h>

#include <string>

namespace eventide {
namespace {

OpenOptions open_options(const ReaderOptions& options) {
    if ((options.width == 0) != (options.height == 0) || options.width < 0 || options.height < 0)
        throw Error(ErrorKind::usage,
                    "reader: expected width and height of the sensor, both or neither, found " +
                        std::to_string(options.width) + "x" + std::to_string(options.height));
    OpenOptions open;
    open.format = options.format;
    open.stream = options.stream;
    open.width = options.width;
    open.height = options.height;
    open.while_waiting = options.while_waiting;
    return open;
}

void refuse_camera(const std::string& path) {
    if (!names_device_alone(path)) return;
    throw Error(ErrorKind::usage,
                "'" + path +
                    "': expected a recording, found the name of a camera, which EventCamera opens "
                    "(in C eventide_camera_open(), in Python open_camera())");
}

std::unique_ptr<Recording> open(const std::string& path, const OpenOptions& options) {
    if (path.empty())
        throw Error(ErrorKind::input, "reader: expected the name of a recording, found none");
    refuse_camera(path);
    return open_recording(path, options);
}

}  // namespace

class EventReader::Impl {
public:
    Impl(const std::string& path, const ReaderOptions& options)
        : path_(path),
          options_(open_options(options)),
          recording_(open(path, options_)),
          can_go_back_(path != "-" && recording_->size_bytes() > 0),
          parser_(recording_->make_parser()),
          filters_(recording_->info()) {
        if (!options.warn) return;
        for (const std::string& remark : recording_->remarks())
            options.warn(std::string{path}.append(": ").append(remark));
    }

    const Recording& recording() const { return *recording_; }
    const Parser& parser() const { return *parser_; }
    SourceFilters& filters() { return filters_; }

    bool read(Batch& batch) {
        bool more = pieces_.next(batch);
        if (!more && !ended_) {
            ended_ = recording_->read(packet_) != ReadStatus::data;
            ended_ ? parser_->finish(parsed_) : parser_->parse(packet_.bytes, parsed_);
            pieces_.put(parsed_);
            more = pieces_.next(batch) || !ended_;
        }
        if (!more) return false;
        filters_.process(batch);
        later_.take(batch);
        return true;
    }

    /// What cannot go back stays where it is, and its parser with it.
    void seek(SensorTime t) {
        if (!can_go_back_) return;
        if (filters_.wants_first())
            if (const auto first = first_event_time(*open_recording(path_, options_)))
                filters_.count_from(*first);
        filters_.restart();
        recording_->seek(t);
        damaged_before_ += parser_->damaged().total();
        parser_ = recording_->make_parser();
        ended_ = false;
        pieces_ = {};
        later_.begin(t);
    }

    void stop() noexcept {
        if (!can_go_back_) recording_->stop();
    }

    std::uint64_t damaged() const { return damaged_before_ + parser_->damaged().total(); }

    std::optional<Window> span() const {
        if (!can_go_back_)
            throw Error(ErrorKind::usage, "span of '" + path_ +
                                              "': expected a file that can be read twice, found " +
                                              (path_ == "-" ? "standard input" : "a pipe"));
        const auto again = open_recording(path_, options_);
        const Summary summary = summarize(*again, [this] {
            if (options_.while_waiting) options_.while_waiting();
            return true;
        });
        if (!summary.first) return std::nullopt;
        return Window{*summary.first, *summary.last};
    }

private:
    const std::string path_;
    const OpenOptions options_;
    const std::unique_ptr<Recording> recording_;
    const bool can_go_back_;  // a pipe does not tell its size
    std::unique_ptr<Parser> parser_;
    SourceFilters filters_;
    LaterPart later_;
    RawPacket packet_;
    Batch parsed_;
    BatchPieces pieces_;
    std::uint64_t damaged_before_ = 0;  // by parsers before a seek
    bool ended_ = false;
};

EventReader::EventReader(const std::string& path, const ReaderOptions& options)
    : impl_(std::make_unique<Impl>(path, options)) {}
EventReader::~EventReader() = default;
EventReader::EventReader(EventReader&&) noexcept = default;
EventReader& EventReader::operator=(EventReader&&) noexcept = default;

const SensorInfo& EventReader::info() const noexcept {
    return impl_->filters().info();
}
int EventReader::width() const noexcept {
    return info().width;
}
int EventReader::height() const noexcept {
    return info().height;
}
std::vector<std::string> EventReader::remarks() const {
    return impl_->recording().remarks();
}
void EventReader::add_filter(const std::string& filter) {
    impl_->filters().add(filter);
}
bool EventReader::read(Batch& batch) {
    return impl_->read(batch);
}
void EventReader::seek(SensorTime t) {
    impl_->seek(t);
}
std::optional<SensorTime> EventReader::clock() const {
    return impl_->parser().clock();
}
void EventReader::stop() noexcept {
    impl_->stop();
}
std::uint64_t EventReader::damaged() const noexcept {
    return impl_->damaged();
}
std::optional<Window> EventReader::span() const {
    return impl_->span();
}

}  // namespace eventide
