// eventide convert: a recording in another format.
#include "src/app/convert_command.h"

#include "replay/convert.h"
#include "replay/formats.h"
#include "src/app/moment.h"
#include "src/app/progress.h"
#include "src/core/error.h"

#include <spdlog/spdlog.h>

namespace eventide::app {

namespace {

std::string names_of_writable() {
    std::string names;
    for (const Format& format : all_formats())
        if (format.make_writer != nullptr)
            names += (names.empty() ? "" : ", ") + std::string{format.name};
    return names;
}

const Format& target_format(const std::string& file, const std::string& name) {
    const Format* format = name == "auto" ? format_for_writing(file) : find_format(name);
    if (format == nullptr)
        throw Error(ErrorKind::usage, file +
                                          ": its extension names no format that can be "
                                          "written; --to-format takes " +
                                          names_of_writable());
    return *format;
}

/// "3 events, 2 images"; what there is none of goes unsaid.
std::string text_of(const DataCounts& counts) {
    std::string text;
    const auto add = [&text](std::uint64_t n, const char* what) {
        if (n > 0) text += (text.empty() ? "" : ", ") + std::to_string(n) + " " + what;
    };
    add(counts.events, "events");
    add(counts.images, "images");
    add(counts.imu, "imu samples");
    add(counts.triggers, "triggers");
    return text.empty() ? "nothing" : text;
}

void say(const std::string& file, const ConvertReport& report) {
    spdlog::info("{}: {}; {} bytes", file, text_of(report.written), report.bytes_written);
    if (!(report.not_held == DataCounts{}))
        spdlog::warn("{}: its format has no place for {}, which were left out", file,
                     text_of(report.not_held));
    for (std::size_t i = 0; i < kDamageReasons; ++i)
        if (const auto n = report.damaged[DamageReason(i)]; n > 0)
            spdlog::warn("damaged input: {} {}", name_of(DamageReason(i)), n);
}

}  // namespace

std::string ConvertCommand::examples() const {
    return "Examples:\n"
           "  eventide convert events.txt events.aedat4 --input-size 240x180\n"
           "  eventide convert recording.raw part.raw --from 2s --to 3s\n"
           "  eventide convert recording.aedat4 - --to-format text | head";
}

std::vector<Positional> ConvertCommand::positionals() {
    return {{"FROM", "Recording, or - for standard input", &from_file_},
            {"TO", "File to write, or - for standard output", &to_file_}};
}

SettingTable ConvertCommand::settings() {
    SettingTable table{"convert", "eventide convert: a recording in another format.", {}};
    table.settings.push_back(
        text_setting("to_format", to_format_, "FORMAT",
                     "Format to write, auto: by the extension; " + names_of_writable() + "."));
    table.settings.push_back(moment_setting("from", from_, "start",
                                            "First data: 2.5s or 20ms after the first event, or "
                                            "@MICROSECONDS of the sensor; start: all."));
    table.settings.push_back(
        moment_setting("to", to_, "end", "Last data, written as --from; end: all."));
    table.settings.push_back(flag_setting("overwrite", overwrite_, "Replace what is there."));
    table.settings.push_back(flag_setting(
        "strict", strict_, "End with exit code 5 when something was damaged or had no place."));
    input_.add_to(table);
    return table;
}

int ConvertCommand::run(Program& program) {
    const Format& format = target_format(to_file_, to_format_);
    const OpenOptions options = input_.options();
    const auto recording = open_recording(from_file_, options);
    const MomentReader moments{from_file_, options};
    ConvertOptions how;
    how.overwrite = overwrite_;
    if (from_) how.from = moments.time_of(*from_);
    if (to_) how.to = moments.time_of(*to_);
    Progress progress{program.quiet};
    const ConvertReport report = convert(*recording, to_file_, format, how, [&] {
        if (recording->size_bytes() > 0)
            progress.show(double(recording->position_bytes()) / double(recording->size_bytes()));
        return !program.signals.stopping();
    });
    progress.clear();
    if (program.signals.stopping())
        spdlog::warn("{}: stopped before the end; it holds what was read until then", to_file_);
    say(to_file_, report);
    const bool incomplete = report.damaged.total() > 0 || !(report.not_held == DataCounts{});
    return strict_ && incomplete ? exit_data_lost : exit_done;
}

}  // namespace eventide::app
