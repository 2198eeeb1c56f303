// eventide info: reads a recording to its end and says what was in it.
#include "apps/cli/commands/info_command.h"

#include "apps/cli/printable.h"
#include "apps/cli/progress.h"
#include "apps/cli/settings/model_path.h"
#include "replay/formats.h"
#include "replay/left_out.h"
#include "replay/summary.h"
#include "src/core/damage_text.h"
#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/model/model_file.h"
#include "src/model/model_metadata.h"
#include "src/nn/safetensors.h"

#include <spdlog/spdlog.h>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <filesystem>
#include <iostream>

namespace eventide::app {

namespace {

std::string flicker_text(const Summary& summary) {
    if (summary.in_flicker == 0) return "none";
    const double share = double(summary.in_flicker) / double(summary.events);
    return std::to_string(std::lround(summary.flicker_hz)) + " Hz, during " +
           std::to_string(std::lround(100 * share)) + " % of the events";
}

void print_table(const SensorInfo& sensor, const Summary& summary, std::uint64_t bytes) {
    const auto line = [](const char* name, const std::string& value) {
        std::cout << name << std::string(12 - std::string{name}.size(), ' ') << printable(value)
                  << '\n';
    };
    const auto whole = [](std::uint64_t n) { return std::to_string(n); };
    line("format", summary.format);
    if (!sensor.name.empty())
        line("sensor", sensor.name + (sensor.serial.empty() ? "" : ", serial " + sensor.serial));
    line("size",
         whole(std::uint64_t(summary.width)) + " x " + whole(std::uint64_t(summary.height)));
    if (bytes > 0) line("bytes", whole(bytes));
    line("events", whole(summary.events) + " (" + whole(summary.on) + " on)");
    if (summary.first && summary.last) {
        const double seconds = std::chrono::duration<double>(summary.span).count();
        char text[96];
        std::snprintf(text, sizeof text, "%lld .. %lld us (%.6f s)",
                      static_cast<long long>(to_us(*summary.first)),
                      static_cast<long long>(to_us(*summary.last)), seconds);
        line("time", summary.clock_resets == 0 ? text
                                               : text + (", the clock began anew " +
                                                         counted(summary.clock_resets, "time")));
        if (seconds > 0) line("rate", short_count(double(summary.events) / seconds) + " events/s");
    }
    line("images", whole(summary.frames));
    line("imu", whole(summary.imu));
    line("triggers", whole(summary.triggers));
    line("flicker", flicker_text(summary));
    std::string damage = whole(summary.damaged.total());
    if (summary.damaged.total() > 0) add_to_list(damage, damage_text(summary.damaged));
    line("damaged", damage);
}

}  // namespace

/// What a model is, from its own metadata.
int InfoCommand::describe_model(const std::filesystem::path& file) const {
    if (const auto metadata = read_safetensors(file).metadata; metadata.contains("format"))
        if (metadata.at("format") == "eventide-state")
            throw Error(ErrorKind::input, file.string() +
                                              ": expected a recording or a model, found a saved "
                                              "state, as --state-in of run takes");
    const Model model = load_model(file);
    std::size_t weights = 0;
    for (const auto& [name, tensor] : model.weights) weights += tensor.values.size();
    std::map<std::string, std::string> facts = format_metadata(model.config);
    facts["weights"] = std::to_string(weights);
    facts["identity"] = encoder_identity(model);
    if (json_) {
        std::cout << json_text(facts) << '\n';
        return exit_done;
    }
    for (const auto& [key, value] : facts)
        std::cout << key << std::string(key.size() < 16 ? 16 - key.size() : 1, ' ')
                  << printable(value, Lines::keep) << '\n';
    return exit_done;
}

std::string InfoCommand::examples() const {
    return "Examples:\n  eventide info recording.aedat4\n  eventide info default\n  "
           "eventide info recording.raw --json | jq "
           ".events";
}

std::vector<Positional> InfoCommand::positionals() {
    return {
        {"FILE", "Recording, - for standard input, or a model, by its file or its name", &file_}};
}

SettingTable InfoCommand::settings() {
    SettingTable table{"info", "eventide info: what a recording holds.", {}};
    table.settings.push_back(flag_setting("json", json_, "One JSON object instead of a table."));
    table.settings.push_back(
        flag_setting("strict", strict_, "End with exit code 5 when something is damaged."));
    input_.add_to(table);
    return table;
}

int InfoCommand::run(Program& program) {
    if (file_.ends_with(".safetensors") || is_safetensors(file_)) return describe_model(file_);
    // As of --model; a file of that name comes first.
    if (const auto model = found_model(file_); !model.empty() && !std::filesystem::exists(file_))
        return describe_model(model);
    const auto recording =
        open_input(file_, input_, [&program] { return program.signals.stopping(); });
    refuse_idle_input_flags(program.flags, {recording->info().format});
    Progress progress{program.quiet};
    const Summary summary = summarize(*recording, [&] {
        if (recording->size_bytes() > 0)
            progress.show(double(recording->position_bytes()) / double(recording->size_bytes()));
        return !program.signals.stopping();
    });
    progress.clear();
    if (program.signals.stopping()) throw Error(ErrorKind::failed, "stopped before the end");
    if (const std::string why =
            left_out_text(file_, summary.format, summary.events, summary.damaged);
        !why.empty())
        spdlog::warn("{}", why);
    if (json_)
        std::cout << to_json(summary) << '\n';
    else
        print_table(recording->info(), summary, recording->size_bytes());
    return strict_ && summary.damaged.total() > 0 ? exit_data_lost : exit_done;
}

}  // namespace eventide::app
