// What a run takes over from an earlier one, and keeps for later ones.
#include "apps/cli/run/run.h"
#include "apps/cli/run/state/run_state.h"
#include "apps/cli/run/state/state_folder.h"
#include "pipeline/filters/event_filter.h"
#include "src/core/error.h"
#include "src/io/output_file.h"
#include "src/nn/safetensors.h"

#include <spdlog/spdlog.h>

#include <optional>
#include <string>
#include <utility>

namespace eventide::app {

/// Goes on where another run stopped: the networks, and where it was kept also the stream.
void Run::resume(TensorFile state) {
    restore_state(std::move(state), settings_.state_in, network_, colour_ ? &*colour_ : nullptr);
    const auto& resumed = input_.resumed();
    if (!resumed) return;
    const auto require = [this](const char* option, const std::string& kept,
                                const std::string& found) {
        if (kept != found)
            throw Error(ErrorKind::input, settings_.state_in +
                                              ": expected the state of a run with " + option + ' ' +
                                              found + ", found that of one with " + kept);
    };
    require("--window", resumed->window, window_text(slicer_));
    require("--noise-filter", resumed->noise_filter, noise_filter_of(settings_, network_.config()));
    require("--lamp-flicker", resumed->lamp_flicker, lamp_flicker_of(settings_, !input_.as_live()));
    try {
        if (filter_)
            filter_->restore(resumed->filters);
        else if (resumed->filters != EventFilters::State{})
            throw Error(ErrorKind::input, "expected nothing of filters");
    } catch (const Error& error) {
        throw Error(error.kind(), settings_.state_in + ": " + error.what());
    }
}

void Run::keep_state(const PipelineState& memory) {
    const StreamState state{memory, filter_ ? filter_->state() : EventFilters::State{},
                            window_text(slicer_), noise_filter_of(settings_, network_.config()),
                            lamp_flicker_of(settings_, !input_.as_live())};
    TensorFile file = state_of(network_, nullptr);
    put_stream_state(state, input_.sensor().width, file);
    outputs_.states()->keep(file);
}

/// At the end of the run, which a pipe without a reader must not put off for ever.
void Run::keep_last_state() {
    OutputFile file{settings_.state_out,
                    {.overwrite = settings_.overwrite, .give_up = [this] { return gives_up(); }}};
    file.write(format_safetensors(state_of(network_, colour_ ? &*colour_ : nullptr)));
    file.close();
    if (!file.is_read())
        spdlog::warn("--state-out {}: {}", settings_.state_out, text_of(file.reader()));
}

}  // namespace eventide::app
