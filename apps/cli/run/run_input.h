// What a run reads: its source behind the filters of data, and where an earlier run stopped.
#pragma once

#include "apps/cli/command.h"
#include "apps/cli/run/open_source.h"
#include "apps/cli/run/run_plan.h"
#include "apps/cli/run/state/stream_state.h"
#include "apps/cli/settings/run_settings.h"
#include "pipeline/counters.h"
#include "pipeline/filters/filter_chain.h"
#include "src/nn/safetensors.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

namespace eventide::app {

class RunInput {
public:
    /// Opens the source, and reads what an earlier run kept. `settings` are borrowed; `speed` and
    /// `give_up` are those of open_source(). Throws Error.
    RunInput(const RunSettings& settings, double speed, const std::function<bool()>& give_up);

    bool live() const { return opened_.source->is_live(); }
    /// A camera, or a recording as if a camera gave it.
    bool as_live() const { return live() || settings_.realtime; }
    /// Sensor time over that of the clock: of a camera, and of a recording that is paced; else 0.
    double pace() const;
    const SensorInfo& sensor() const { return sensor_; }  ///< behind the filters
    const Span& span() const { return span_; }
    const FilterChain& filters() const { return filters_; }
    ColourFilter source_colours() const { return source_colours_; }  ///< before all filters, ...
    ColourFilter colours() const { return colours_; }                ///< ... and behind them
    RealTimePlayback* paced() const { return opened_.paced; }        ///< null: it keeps no pace
    Source& source() { return *opened_.source; }

    /// Checks that a recording has what is asked of it, and that the flags of input concern it.
    void check(const FlagKeys& flags, const SlicerSettings& slicer) const;
    /// Goes to where the span asked of a recording begins; does nothing with a live source.
    void go_to_begin();
    /// What the pipeline reads. `came`: the source, or what writes it down.
    Source& behind_filters(Source& came);

    /// The networks' state to go on from, once; none: they start with a new one.
    std::optional<TensorFile> take_state() { return std::exchange(state_, std::nullopt); }
    /// The stream's state to go on from; none: a new stream begins.
    const std::optional<StreamState>& resumed() const { return resumed_; }

    /// Bytes of a recording, from where reading began; 0: not known.
    std::uint64_t bytes_to_read() const { return bytes_to_read_; }
    /// Adds a camera's counters, and as events read what the filters left out. Thread: any.
    void count(Snapshot& now) const;

private:
    const RunSettings& settings_;
    OpenedSource opened_;
    FilterChain filters_;
    const SensorInfo sensor_;
    std::optional<TensorFile> state_;
    std::optional<StreamState> resumed_;
    const Span span_;
    const ColourFilter source_colours_, colours_;
    std::uint64_t bytes_to_read_ = 0;
    bool is_stream_ = true;                   // what is read are the recording's own bytes
    std::optional<FilteredSource> filtered_;  // none: without --filter
};

}  // namespace eventide::app
