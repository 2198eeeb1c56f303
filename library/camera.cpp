// Cameras behind the public face.
#include "drivers/devices.h"
#include "drivers/simulated/simulated_camera.h"
#include "library/source_filters.h"
#include "pipeline/event_windows.h"
#include "src/core/error.h"

#include <eventide/camera.h>

#include <atomic>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

namespace eventide {
namespace {

std::unique_ptr<Camera> open(const std::string& name, const CameraSettings& settings) {
    if (names_simulation(name)) {
        if (!settings.file.empty())
            throw Error(ErrorKind::usage, "camera settings '" + settings.file.string() +
                                              "': expected a camera that has settings, found " +
                                              name);
        return open_simulation(name);
    }
    std::error_code none;
    if (!names_camera(name) && std::filesystem::exists(name, none))
        throw Error(ErrorKind::usage,
                    "'" + name +
                        "': expected the name of a camera, found a file, which EventReader opens "
                        "(in C eventide_recording_open(), in Python open())");
    const auto give_up = [&] {
        if (settings.while_waiting) settings.while_waiting();
        return false;
    };
    return open_camera(name, {settings.file, settings.reconnect, give_up, settings.warn});
}

}  // namespace

class EventCamera::Impl {
public:
    Impl(const std::string& name, const CameraSettings& settings)
        : camera_(open(name, settings)),
          parser_(camera_->make_parser()),
          filters_(camera_->info()) {}

    void stop() noexcept {
        stopped_ = true;
        camera_->stop();
    }
    bool is_live() const { return camera_->is_live(); }
    const Parser& parser() const { return *parser_; }
    SourceFilters& filters() { return filters_; }
    bool gap_before() const { return gap_before_; }

    bool read(Batch& batch) {
        batch.clear();
        gap_before_ = packet_.gap_before = packet_.reopened = false;
        const ReadStatus status = camera_->read(packet_);
        if (status == ReadStatus::end) return read_rest(batch);
        now_ = std::chrono::steady_clock::now();
        if (status == ReadStatus::timeout) return true;
        now_ = packet_.arrived;
        gap_before_ = packet_.gap_before;
        parse_packet(packet_, camera_->is_live(), *parser_, batch);
        filters_.process(batch);
        note_clock();
        return true;
    }

    /// In a camera's silence the host's clock goes on for it, less a margin for what is on its way.
    std::optional<SensorTime> clock() const {
        if (!clock_ || !camera_->is_live()) return clock_;
        const SensorDuration margin = EventWindows::Settings{}.silence_margin;
        const auto silent = std::chrono::duration_cast<SensorDuration>(now_ - clock_arrived_);
        return silent > margin ? *clock_ + silent - margin : *clock_;
    }

private:
    bool read_rest(Batch& batch) {
        // Where the end was asked for, half a record in hand is no damage.
        if (!std::exchange(ended_, true) && !stopped_) parser_->finish(batch);
        const bool empty = batch.empty();
        filters_.process(batch);
        return !empty;
    }

    void note_clock() {
        const auto told = parser_->clock();
        if (!told || told == clock_) return;
        clock_ = told;
        clock_arrived_ = now_;
    }

    std::unique_ptr<Camera> camera_;
    std::unique_ptr<Parser> parser_;
    SourceFilters filters_;
    RawPacket packet_;
    bool gap_before_ = false, ended_ = false;
    std::atomic<bool> stopped_{false};
    HostTime now_{}, clock_arrived_{};
    std::optional<SensorTime> clock_;
};

EventCamera::EventCamera(const std::string& name, const CameraSettings& settings)
    : impl_(std::make_unique<Impl>(name, settings)) {}
EventCamera::~EventCamera() = default;
EventCamera::EventCamera(EventCamera&&) noexcept = default;
EventCamera& EventCamera::operator=(EventCamera&&) noexcept = default;

const SensorInfo& EventCamera::info() const noexcept {
    return impl_->filters().info();
}
int EventCamera::width() const noexcept {
    return info().width;
}
int EventCamera::height() const noexcept {
    return info().height;
}
void EventCamera::add_filter(const std::string& filter) {
    impl_->filters().add(filter);
}
bool EventCamera::read(Batch& batch) {
    return impl_->read(batch);
}
std::optional<SensorTime> EventCamera::clock() const {
    return impl_->clock();
}
bool EventCamera::gap_before() const noexcept {
    return impl_->gap_before();
}
bool EventCamera::is_live() const noexcept {
    return impl_->is_live();
}
std::uint64_t EventCamera::damaged() const noexcept {
    return impl_->parser().damaged().total();
}
void EventCamera::stop() noexcept {
    impl_->stop();
}

}  // namespace eventide
