#include "pipeline/sinks/http/metrics.h"

#include <cstdio>
#include <string_view>

namespace eventide {

namespace {

class Text {
public:
    void counter(std::string_view name, std::string_view help, std::uint64_t value) {
        head(name, help, "counter");
        line(name, "", double(value));
    }
    void gauge(std::string_view name, std::string_view help, double value) {
        head(name, help, "gauge");
        line(name, "", value);
    }
    void summary(std::string_view name, std::string_view help, const LatencySummary& s) {
        head(name, help, "summary");
        line(name, "{quantile=\"0.5\"}", seconds(s.p50));
        line(name, "{quantile=\"0.9\"}", seconds(s.p90));
        line(name, "{quantile=\"0.99\"}", seconds(s.p99));
        line(std::string{name} + "_sum", "", seconds(s.total));
        line(std::string{name} + "_count", "", double(s.count));
    }
    void head(std::string_view name, std::string_view help, std::string_view type) {
        text_ += "# HELP eventide_" + std::string{name} + " " + std::string{help} +
                 "\n# TYPE eventide_" + std::string{name} + " " + std::string{type} + "\n";
    }
    void line(std::string_view name, std::string_view labels, double value) {
        char number[32];
        std::snprintf(number, sizeof number, "%.17g", value);
        text_ += "eventide_" + std::string{name} + std::string{labels} + " " + number + "\n";
    }
    std::string take() { return std::move(text_); }

private:
    static double seconds(std::chrono::nanoseconds d) {
        return std::chrono::duration<double>(d).count();
    }
    std::string text_;
};

void add_camera(Text& text, const CameraCounters& camera) {
    for (std::size_t i = 0; i < kCameraCounts; ++i) {
        const CameraCountWords& words = words_of(CameraCount(i));
        text.counter("camera_" + std::string{words.name} + "_total", words.help,
                     camera[CameraCount(i)]);
    }
}

void add_line(Text& text, const Snapshot& now) {
    text.counter("packets_total", "Packets read from the source.", now.packets);
    text.counter("bytes_total", "Bytes read from the source.", now.bytes);
    if (now.camera) add_camera(text, *now.camera);
    text.counter("lost_packets_total", "Packets that no buffer was free for.", now.lost_packets);
    text.counter("lost_bytes_total", "Bytes of lost packets.", now.lost_bytes);
    text.counter("gaps_total", "Places where bytes are missing.", now.gaps);
    text.counter("events_total", "Events parsed.", now.events);
    text.counter("filtered_events_total", "Events left out by filters.", now.filtered_events);
    text.counter("images_total", "Images of the camera.", now.images);
    text.counter("imu_samples_total", "Inertial samples.", now.imu);
    text.counter("triggers_total", "Triggers.", now.triggers);
    text.head("damaged_total", "Places in the stream that made no sense, by reason.", "counter");
    for (std::size_t i = 0; i < kDamageReasons; ++i)
        text.line("damaged_total", "{reason=\"" + std::string{name_of(DamageReason(i))} + "\"}",
                  double(now.damaged[DamageReason(i)]));
    text.counter("time_resets_total", "Times the source's clock began anew.",
                 now.slicing.time_resets);
    text.counter("late_events_total", "Events that came after their window was cut.",
                 now.slicing.late);
    text.gauge("flicker_hertz", "Light that flickers now; 0: none does.", now.flicker.hz);
    text.counter("flicker_events_total", "Events left out as flicker added them.",
                 now.flicker.left_out);
    text.counter("event_windows_total", "Event windows cut.", now.event_windows);
    text.counter("silent_windows_total", "Of those, without events.", now.silent_windows);
    text.counter("merged_windows_total", "Event windows that became one with the one before.",
                 now.merged_windows);
    text.counter("state_resets_total", "Times the network's state was reset.", now.state_resets);
    text.counter("frames_total", "Frames written.", now.frames);
    text.counter("skipped_frames_total",
                 "Frames not rendered: too late, left out by a halved rate, or watched by no sink.",
                 now.skipped_frames);
    text.counter("used_images_total", "Images of the camera that corrected frames.",
                 now.used_images);
    text.counter("dropped_images_total",
                 "Images of the camera that came too late or were too many.", now.dropped_images);
    text.gauge("newest_frame_seconds", "Sensor time of the newest frame.",
               now.frames > 0 ? double(to_us(now.newest_frame)) / 1e6 : 0);
    text.summary("latency_seconds", "From the last packet a frame saw to the frame written.",
                 now.latency);
    text.summary("bin_seconds", "Work per event window: binning.", now.bin);
    text.summary("encode_seconds", "Work per event window: encoding.", now.encode);
    text.summary("take_seconds", "Work per event window: following the camera's images.", now.take);
    text.summary("render_seconds", "Work per frame: rendering.", now.render);
    text.summary("write_seconds", "Work per frame: writing to the sinks.", now.write);
}

}  // namespace

std::string metrics_text(const Snapshot& now, const HttpCounters& http) {
    Text text;
    add_line(text, now);
    text.gauge("http_viewers", "Connections that are sent frames.", double(http.viewers));
    text.gauge("http_listeners", "Connections that are sent statistics.", double(http.listeners));
    text.counter("http_requests_total", "Requests.", http.requests);
    text.counter("http_refused_total", "Requests refused: host, origin, token, too many.",
                 http.refused);
    text.counter("http_frames_copied_total", "Frames copied for viewers.", http.copied);
    return text.take();
}

}  // namespace eventide
