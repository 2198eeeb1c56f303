// Parser on one side, writer on the other, and the limits between them.
#include "replay/convert.h"

#include "replay/recording_file.h"
#include "src/core/error.h"

#include <algorithm>

namespace eventide {

namespace {

// Images and IMU samples come out after the events of their time; beyond this they would be lost
// anyway.
constexpr SensorDuration kLatestData = std::chrono::milliseconds(500);

template <typename T>
void keep_inside(std::vector<T>& items, const ConvertOptions& options) {
    std::erase_if(items, [&](const T& item) {
        return (options.from && item.t < *options.from) || (options.to && item.t > *options.to);
    });
}

void keep_inside(Batch& batch, const ConvertOptions& options) {
    if (!options.from && !options.to) return;
    keep_inside(batch.events, options);
    keep_inside(batch.images, options);
    keep_inside(batch.imu, options);
    keep_inside(batch.triggers, options);
}

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
    bool reader_gone() const override { return file_.reader_gone(); }
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
    std::optional<SensorTime> last_event;
    const auto pass_on = [&] {
        if (!batch.events.empty()) last_event = batch.events.back().t;
        report.events_read += batch.events.size();
        keep_inside(batch, options);
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
        // By the events that came out, not by the parser's clock: that may run ahead of them, and
        // one wrong stamp moves it. Those up to `to` are all out then, and none is still held.
        const bool past_end = options.to && last_event && *last_event - kLatestData > *options.to;
        enough = past_end || target.reader_gone() || (progress && !progress());
    }
    // Where nobody wanted more, half a record in hand is no damage of the recording's.
    if (!enough) parser->finish(batch);
    pass_on();
    target.finish();
    report.damaged = parser->damaged();
    report.bytes_written = target.bytes_written();
    report.lost = target.lost();
    report.reader_gone = target.reader_gone();
    return report;
}

}  // namespace eventide
