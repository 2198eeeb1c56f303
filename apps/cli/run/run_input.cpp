// See run_input.h.
#include "apps/cli/run/run_input.h"

#include "apps/cli/commands/look_ahead.h"
#include "apps/cli/run/colour.h"
#include "apps/cli/run/state/state_folder.h"
#include "drivers/camera.h"
#include "replay/formats.h"

namespace eventide::app {

namespace {

SensorPixels size_of(const Source& source) {
    return {source.info().width, source.info().height};
}

std::optional<TensorFile> state_in_of(const RunSettings& settings) {
    if (settings.state_in.empty()) return std::nullopt;
    return read_safetensors(settings.state_in);
}

std::optional<StreamState> stream_in(const RunSettings& settings, std::optional<TensorFile>& state,
                                     const SensorInfo& sensor, bool live) {
    if (!state) return std::nullopt;
    auto stream = take_stream_state(*state, settings.state_in, sensor.width, sensor.height);
    if (stream) check_stream_state(settings, "--state-in " + settings.state_in, live);
    return stream;
}

Span span_in(const RunSettings& settings, const std::optional<StreamState>& resumed, bool live) {
    const Span span = span_of(settings, live);
    return resumed ? resumed_span(settings, span, resumed->stream.t) : span;
}

}  // namespace

RunInput::RunInput(const RunSettings& settings, double speed, const std::function<bool()>& give_up)
    : settings_{settings},
      opened_{open_source(settings, speed, give_up)},
      filters_{settings.filter, size_of(*opened_.source)},
      sensor_{filters_.behind(opened_.source->info())},
      state_{state_in_of(settings)},
      resumed_{stream_in(settings, state_, sensor_, live())},
      span_{span_in(settings, resumed_, live())},
      source_colours_{source_colours_of(settings, opened_.source->info(), live())},
      colours_{colour_filter_of(settings, source_colours_, sensor_, filters_)} {}

double RunInput::pace() const {
    if (live()) return 1;
    return opened_.paced != nullptr ? opened_.paced->speed() : 0;
}

void RunInput::check(const FlagKeys& flags, const SlicerSettings& slicer) const {
    if (opened_.recording != nullptr)
        refuse_idle_input_flags(flags, {opened_.recording->info().format});
    const AskedPart part{settings_.source, settings_.input.options(), settings_.from,
                         span_.frames_from, span_.end};
    check_part(part);
    check_images(part, slicer);
}

void RunInput::go_to_begin() {
    Recording* const recording = opened_.recording;
    if (recording == nullptr) return;
    if (span_.begin) {
        if (!filters_.empty())
            if (const auto first = first_event_of(settings_, live())) filters_.count_from(*first);
        recording->seek(*span_.begin);
    }
    if (recording->size_bytes() > 0)
        bytes_to_read_ = recording->size_bytes() - recording->position_bytes();
    const Format* const format = find_format(recording->info().format);
    is_stream_ = format == nullptr || format->open_path == nullptr;
}

Source& RunInput::behind_filters(Source& came) {
    if (filters_.empty()) return came;
    if (!filtered_) filtered_.emplace(came, filters_);
    return *filtered_;
}

void RunInput::count(Snapshot& now) const {
    if (const auto* camera = dynamic_cast<const Camera*>(opened_.source.get()))
        now.camera = camera->counters();
    now.events += filters_.left_out();
    now.filtered_events += filters_.left_out();
    if (!is_stream_)
        now.parsed_bytes =
            opened_.recording->position_bytes() + bytes_to_read_ - opened_.recording->size_bytes();
}

}  // namespace eventide::app
