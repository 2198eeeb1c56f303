// eventide convert: a recording in another format.
#include "apps/cli/commands/convert_command.h"

#include "apps/cli/commands/command_files.h"
#include "apps/cli/commands/look_ahead.h"
#include "apps/cli/commands/recording_out.h"
#include "apps/cli/progress.h"
#include "apps/cli/run/colour.h"
#include "apps/cli/run/events_out.h"
#include "apps/cli/terminal.h"
#include "replay/formats.h"
#include "replay/left_out.h"
#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/io/held_pipes.h"
#include "src/io/output_file.h"
#include "src/io/stream_name.h"

#include <spdlog/spdlog.h>

namespace eventide::app {

namespace {

/// Null for a folder.
const Format* target_format(const std::string& file, const std::string& name) {
    if (names_folder(file)) {
        if (name == "auto") return nullptr;
        throw Error(ErrorKind::usage,
                    "--to-format " + name +
                        ": expected a file as TO, found the "
                        "folder " +
                        file + ", which is written as events.txt, images.txt and images/");
    }
    const Format* format = name == "auto" ? format_for_writing(file) : find_format(name);
    if (name != "auto" && (format == nullptr || !format->is_written()))
        throw Error(ErrorKind::usage, "--to-format: expected one of " + names_of_writable() +
                                          ", found '" + name + "'");
    if (format == nullptr)
        throw Error(ErrorKind::usage,
                    file + ": expected a folder (ending in /) or the extension of a format that " +
                        "can be written, " + extensions_of_writable() + "; --to-format takes " +
                        names_of_writable());
    return format;
}

void say(const std::string& source, const std::string& source_format, const std::string& target,
         const ConvertReport& report) {
    const std::string file = output_name(target);
    if (report.reader != PipeReader::takes)
        spdlog::info("{}: {}", file, text_of(report.reader));
    else
        spdlog::info("{}: wrote {} ({})", file, text_of(report.written),
                     counted(report.bytes_written, "byte"));
    for (const std::string& remark : report.data.remarks(file)) spdlog::warn("{}", remark);
    if (report.lost > 0) spdlog::warn("{}: lost {}", file, lost_datagrams(report.lost));
    if (const std::string why =
            left_out_text(source, source_format, report.events_read, report.damaged);
        !why.empty())
        spdlog::warn("{}", why);
    for (std::size_t i = 0; i < kDamageReasons; ++i)
        if (const auto n = report.damaged[DamageReason(i)];
            n > 0 && DamageReason(i) != DamageReason::time_backwards)
            spdlog::warn("damaged input: {} {}", name_of(DamageReason(i)), n);
}

}  // namespace

std::string ConvertCommand::examples() const {
    return "Examples:\n"
           "  eventide convert events.txt events.aedat4 --input-size 240x180\n"
           "  eventide convert recording.raw part.raw --from 2s --to 3s\n"
           "  eventide convert recording.aedat4 ecd/\n"
           "  eventide convert recording.aedat4 - --to-format text | head";
}

std::vector<Positional> ConvertCommand::positionals() {
    return {{"FROM", "Recording, or - for standard input", &from_file_},
            {"TO",
             "File to write, folder/ with events.txt and images/, udp://HOST:PORT, or - for "
             "standard output",
             &to_file_}};
}

SettingTable ConvertCommand::settings() {
    SettingTable table{"convert", "eventide convert: a recording in another format.", {}};
    table.settings.push_back(
        text_setting("to_format", to_format_, "FORMAT",
                     "Format to write, auto: by the extension; " + names_of_writable() + "."));
    table.settings.push_back(
        time_point_setting("from", from_, "start",
                           "First data: 2.5s or 20ms after the first event, or "
                           "@MICROSECONDS of the sensor; start: all."));
    table.settings.push_back(
        time_point_setting("to", to_, "end", "Last data, written as --from; end: all."));
    table.settings.push_back(filter_setting(filter_));
    table.settings.push_back(
        flag_setting("overwrite", overwrite_,
                     "Replace files that exist; of a folder, what an earlier run "
                     "wrote."));
    table.settings.push_back(flag_setting(
        "force", force_, "Write to standard output even where it is a terminal, other than text."));
    table.settings.push_back(flag_setting(
        "strict", strict_,
        "End with exit code 5 when something was damaged, lost, or could not be held."));
    input_.add_to(table);
    return table;
}

/// Null for datagrams and for a folder.
const Format* ConvertCommand::format_to_write() const {
    if (!to_udp()) return target_format(to_file_, to_format_);
    if (to_format_ != "auto")
        throw Error(ErrorKind::usage, "--to-format " + to_format_ +
                                          ": expected a file as TO, found " + to_file_ +
                                          "; datagrams have ?format=t64, t32 or spif");
    return nullptr;
}

void ConvertCommand::name_all_files(const Format* format, NamedFiles& files) const {
    files.may_replace(overwrite_);
    name_recording("FROM", from_file_, files);
    name_filter_files(filter_, files);
    if (format != nullptr)
        files.writes("TO", to_file_);
    else if (!to_udp())
        name_run_folder("TO", to_file_, EcdWriter::files(), files);
}

/// May read the beginning of the recording.
ConvertOptions ConvertCommand::limits(const TimePointReader& times) const {
    ConvertOptions how;
    if (from_) how.from = times.time_of(*from_);
    if (to_) how.to = times.time_of(*to_);
    check_part({from_file_, input_.options(), from_, how.from, how.to});
    return how;
}

/// Of what the filters leave. A recording that does not say its images' pattern is asked for it
/// where images are written.
StreamHeader ConvertCommand::header_behind(const FilterChain& filters, const Format* format,
                                           const SensorInfo& sensor) const {
    StreamHeader header = header_of(sensor);
    const bool holds_images = !to_udp() && (format == nullptr || format->holds.images);
    if (holds_images && header.colour_filter == ColourFilter::none)
        header.colour_filter = filter_of_images(from_file_, sensor.format, input_.options());
    header.width = filters.size().width;
    header.height = filters.size().height;
    header.colour_filter = filters.pattern(header.colour_filter);
    return header;
}

std::unique_ptr<ConvertTarget> ConvertCommand::open_target(const Format* format,
                                                           const StreamHeader& header,
                                                           const Program& program) const {
    const OutputOptions options{.overwrite = overwrite_,
                                .give_up = [&program] { return program.signals.stopping(); }};
    if (to_udp()) return open_event_target(to_file_, options, header);
    return std::make_unique<RecordingOut>(to_file_, options, format, header);
}

/// `keeps_earlier`: a part does not take the place of a whole file.
ConvertReport ConvertCommand::copy(Recording& recording, ConvertTarget& target,
                                   const ConvertOptions& how, bool keeps_earlier,
                                   const Program& program) const {
    Progress progress{program.quiet};
    const ConvertReport report = convert(recording, target, how, [&] {
        if (recording.size_bytes() > 0)
            progress.show(double(recording.position_bytes()) / double(recording.size_bytes()));
        if (keeps_earlier && program.signals.stopping()) throw kept_earlier_file(to_file_);
        return !program.signals.stopping();
    });
    progress.clear();
    if (program.signals.stopping() && report.reader == PipeReader::takes)
        spdlog::warn("{}: stopped before the end; it holds what was read until then", to_file_);
    return report;
}

int ConvertCommand::run(Program& program) {
    const Format* const format = format_to_write();
    if (format != nullptr && format->name != "text")
        refuse_terminal("TO " + to_file_, to_file_, force_);
    name_all_files(format, program.files);
    HeldPipes readers{program.files.pipes()};
    const auto recording = open_input(from_file_, input_, [&] {
        readers.look();
        return program.signals.stopping();
    });
    const SensorInfo& sensor = recording->info();
    refuse_idle_input_flags(program.flags, {sensor.format});
    const TimePointReader times{from_file_, input_.options()};
    ConvertOptions how = limits(times);
    FilterChain filters{filter_, {sensor.width, sensor.height}};
    if (!filters.empty()) {
        if (how.from && !is_read_once(from_file_)) filters.count_from(times.time_of({}));
        how.filter = [&filters](Batch& batch) { filters.process(batch); };
    }
    const StreamHeader header = header_behind(filters, format, sensor);
    how.colours = header.colour_filter;
    // A camera behind a pipe goes on until it is stopped; of a file, a part is not what was wanted.
    const bool keeps_earlier = !is_read_once(from_file_) && would_replace(to_file_);
    const auto target = open_target(format, header, program);
    readers.let_go();
    const ConvertReport report = copy(*recording, *target, how, keeps_earlier, program);
    say(from_file_, sensor.format, to_file_, report);
    if (!filters.empty()) spdlog::info("filters left out: {}", filters.report());
    const bool incomplete =
        report.damaged.total() > 0 || report.lost > 0 || !report.data.is_whole();
    return strict_ && incomplete ? exit_data_lost : exit_done;
}

}  // namespace eventide::app
