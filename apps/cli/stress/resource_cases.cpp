// What opening and closing leaves behind.
#include "apps/cli/commands/recording_out.h"
#include "apps/cli/stress/process_size.h"
#include "apps/cli/stress/stress_case.h"
#include "pipeline/sinks/contact_sheet.h"
#include "pipeline/sinks/folder.h"
#include "pipeline/sinks/raw_stream.h"
#include "pipeline/sinks/video/video.h"
#include "replay/formats.h"
#include "src/core/error.h"
#include "src/core/list_text.h"

#include <cstdlib>
#include <filesystem>

namespace eventide::stress {
namespace {

namespace fs = std::filesystem;

/// A folder in the system's place for such, gone with everything in it.
class WorkFolder {
public:
    WorkFolder() {
        std::string name = (fs::temp_directory_path() / "eventide-stress-XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr)
            throw Error(ErrorKind::failed,
                        "no folder can be made in " + fs::temp_directory_path().string());
        path_ = name;
    }
    ~WorkFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    WorkFolder(const WorkFolder&) = delete;
    WorkFolder& operator=(const WorkFolder&) = delete;
    std::string operator/(const std::string& name) const { return (path_ / name).string(); }

private:
    fs::path path_;
};

/// Memory of 1,000 rounds, beside that of the first tenth: less than a leak of 4 KiB each time.
constexpr double kGrowthMiB = 4;

/// Runs `once` again and again; the first tenth fills what is kept on purpose.
Result repeated(const Bench& bench, const std::function<void()>& once) {
    const int rounds = bench.budget.length(1000, 20);
    ProcessSize before;
    for (int n = 0; n < rounds; ++n) {
        if (n == rounds / 10) before = process_size();
        once();
    }
    const ProcessSize after = process_size();
    Result result;
    const double grown = double(after.resident - before.resident) / (1 << 20);
    result.happened = std::to_string(rounds) + " times: " + std::to_string(after.files) +
                      " open files before and after, " + std::to_string(after.threads) +
                      " threads, resident memory " + short_number(grown) + " MiB more";
    result.error = std::max(0.0, grown);
    result.bound = kGrowthMiB;
    result.expect(after.files == before.files,
                  "as many files as before, " + std::to_string(before.files));
    result.expect(after.threads == before.threads,
                  "as many threads as before, " + std::to_string(before.threads));
    // Twenty rounds tell nothing of pages.
    if (!bench.budget.is_quick()) result.expect(grown <= kGrowthMiB, "memory");
    return result;
}

Result recordings(const Bench& bench) {
    const WorkFolder folder;
    StreamHeader header;
    header.width = 64;
    header.height = 48;
    Batch batch;
    batch.events = moving_edge(64, 48, {}, SensorTime{SensorDuration{100'000}});
    std::vector<std::string> files;
    std::string names;
    for (const Format& format : all_formats()) {
        if (!format.is_written()) continue;
        files.push_back(folder / (std::string{format.name} + std::string{format.extension}));
        app::RecordingOut file{files.back(), {.overwrite = true}, &format, header};
        file.write(batch);
        file.finish();
        add_to_list(names, format.name);
    }
    Result result = repeated(bench, [&] {
        for (const std::string& file : files) {
            const auto recording = open_recording(file);
            const auto parser = recording->make_parser();
            Batch read;
            for (RawPacket packet; recording->read(packet) == ReadStatus::data;)
                parser->parse(packet.bytes, read);
            parser->finish(read);
        }
    });
    result.happened = names + ", " + result.happened;
    return result;
}

Frame some_frame(int n) {
    Frame frame;
    frame.t = from_us(40'000 * (n + 1));
    frame.index = std::uint64_t(n);
    frame.intensity = Array2<float>(48, 64);
    frame.sigma = Array2<float>(48, 64);
    for (std::size_t i = 0; i < frame.intensity.values().size(); ++i)
        frame.intensity.values()[i] = float((i + std::size_t(n)) % 64) / 64;
    return frame;
}

Result sinks(const Bench& bench) {
    const WorkFolder folder;
    Result result = repeated(bench, [&] {
        std::vector<std::unique_ptr<Sink>> all;
        all.push_back(std::make_unique<VideoSink>(
            VideoSettings{.path = folder / "v.mkv", .overwrite = true}));
        all.push_back(std::make_unique<FolderSink>(
            FolderSettings{.path = folder / "frames", .overwrite = true}));
        all.push_back(std::make_unique<StreamSink>(
            StreamSettings{.path = folder / "s.y4m", .overwrite = true}));
        all.push_back(std::make_unique<ContactSheetSink>(
            ContactSheetSettings{.path = folder / "c.png", .overwrite = true}));
        for (const auto& sink : all) {
            for (int n = 0; n < 2; ++n) sink->write(some_frame(n));
            sink->close();
        }
    });
    result.happened = "video, folder, stream and contact sheet, " + result.happened;
    return result;
}

/// The pipeline itself on its four threads, with its network.
Result pipelines(const Bench& bench) {
    const auto events = moving_edge(24, 16, {}, SensorTime{SensorDuration{100'000}});
    return repeated(bench, [&] {
        PipelineRunSettings how = bench.run_settings();
        how.width = 24;
        how.height = 16;
        how.threaded = true;
        run_pipeline(bench.model, all_of(events), how);
    });
}

}  // namespace

std::vector<Case> resource_cases() {
    return {{"open-recordings", "1,000 times each recording read", recordings, false},
            {"open-sinks", "1,000 times each output written", sinks, false},
            {"open-pipelines", "1,000 times a network and its pipeline", pipelines, false}};
}

}  // namespace eventide::stress
