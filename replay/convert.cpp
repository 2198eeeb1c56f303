// Parser on one side, writer on the other, and the limits between them.
#include "replay/convert.h"

#include "replay/recording_file.h"
#include "src/codec/batch_parts.h"
#include "src/core/error.h"

#include <algorithm>

namespace eventide {

namespace {

// Images and IMU samples come out after the events of their time; beyond this they would be lost
// anyway.
constexpr SensorDuration kLatestData = std::chrono::milliseconds(500);

/// The part between two times of the clock that the stream begins with. After a clock reset all
/// that follows lies behind `from`, once that was reached, and nothing before a `to` that was; as
/// in the slicer of a run.
class StreamPart {
public:
    StreamPart(std::optional<SensorTime> from, std::optional<SensorTime> to)
        : from_{from}, to_{to} {}

    /// Leaves in `batch` what lies in the part. Call once per batch, in order.
    void keep(Batch& batch) {
        if (!from_ && !to_) return;
        const bool was_anew = is_anew_;
        SensorTime last = newest_, first = newest_;
        std::erase_if(batch.events, [&](const Event& event) {
            if (event.t < newest_) {
                last = newest_;
                first = event.t;
                begin_anew();
            }
            newest_ = event.t;
            return !holds(event.t, is_anew_);
        });
        const auto keep_inside = [&](auto& items) {
            std::erase_if(items, [&](const auto& item) {
                const bool before = first < last && !is_of_new_clock(item.t, last, first);
                return !holds(item.t, before ? was_anew : is_anew_);
            });
        };
        keep_inside(batch.images);
        keep_inside(batch.imu);
        keep_inside(batch.triggers);
    }

    /// Whether nothing of the part will come any more. By the events that came out, not by the
    /// parser's clock: that may run ahead of them, and one wrong stamp moves it. Those up to `to`
    /// are all out then, and none is still held.
    bool is_over() const {
        if (is_anew_ || !to_ || newest_ == SensorTime::min()) return is_over_;
        return newest_ - kLatestData > *to_;
    }

private:
    void begin_anew() {
        if (from_ && newest_ < *from_) return;
        is_over_ = is_over_ || (!is_anew_ && to_ && newest_ > *to_);
        is_anew_ = true;
    }
    bool holds(SensorTime t, bool is_anew) const {
        if (is_anew) return !is_over_;
        return (!from_ || t >= *from_) && (!to_ || t <= *to_);
    }

    std::optional<SensorTime> from_, to_;
    SensorTime newest_ = SensorTime::min();  // event
    bool is_anew_ = false, is_over_ = false;
};

DataCounts counts_of(const Batch& batch) {
    return {batch.events.size(), batch.images.size(), batch.imu.size(), batch.triggers.size()};
}

/// One file of one format.
class FileTarget final : public ConvertTarget {
public:
    FileTarget(const std::string& path, bool overwrite, const Format& format,
               const StreamHeader& header)
        : format_{format}, file_{path, {.overwrite = overwrite}, format, header} {}
    const FormatHolds& holds() const override { return format_.holds; }
    void write(const Batch& batch) override { file_.write(batch); }
    void finish() override { file_.finish(); }
    PipeReader reader() const override { return file_.reader(); }
    std::uint64_t bytes_written() const override { return file_.bytes_written(); }

private:
    const Format& format_;
    RecordingFile file_;
};

}  // namespace

StreamHeader header_of(const SensorInfo& sensor) {
    StreamHeader header;
    header.width = sensor.width;
    header.height = sensor.height;
    header.sensor_name = sensor.name;
    header.colour_filter = sensor.colour_filter;
    header.serial = sensor.serial;
    return header;
}

ConvertReport convert(Recording& recording, const std::string& path, const Format& format,
                      const ConvertOptions& options, const std::function<bool()>& progress) {
    StreamHeader header = header_of(recording.info());
    header.format = format.name;
    FileTarget target(path, options.overwrite, format, header);
    return convert(recording, target, options, progress);
}

ConvertReport convert(Recording& recording, ConvertTarget& target, const ConvertOptions& options,
                      const std::function<bool()>& progress) {
    ConvertReport report;
    if (options.from) recording.seek(*options.from);
    const auto parser = recording.make_parser();
    Batch batch;
    report.data = WrittenData{target.holds(), options.colours};
    StreamPart part{options.from, options.to};
    const auto pass_on = [&] {
        report.events_read += batch.events.size();
        part.keep(batch);
        if (options.filter) options.filter(batch);
        report.data.fit(batch);
        report.written += counts_of(batch);
        if (!batch.empty()) target.write(batch);
        batch.clear();
    };
    RawPacket packet;
    bool enough = false;
    while (!enough && recording.read(packet) == ReadStatus::data) {
        parser->parse(packet.bytes, batch);
        pass_on();
        enough =
            part.is_over() || target.reader() != PipeReader::takes || (progress && !progress());
    }
    // Where nobody wanted more, half a record in hand is no damage of the recording's.
    if (!enough) parser->finish(batch);
    pass_on();
    target.finish();
    report.damaged = parser->damaged();
    report.bytes_written = target.bytes_written();
    report.lost = target.lost();
    report.reader = target.reader();
    return report;
}

}  // namespace eventide
