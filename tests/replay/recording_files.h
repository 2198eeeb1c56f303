// Files for tests: a folder of their own, and recordings written into it.
#pragma once

#include "replay/formats.h"
#include "replay/recording_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace eventide {

/// A folder that lives as long as the test.
class TestFolder {
public:
    TestFolder() {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::path(testing::TempDir()) /
                  ("eventide_" + std::string(test->test_suite_name()) + "_" + test->name());
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_);
    }
    ~TestFolder() { std::filesystem::remove_all(folder_); }
    TestFolder(const TestFolder&) = delete;
    TestFolder& operator=(const TestFolder&) = delete;

    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    std::string write(const std::string& name, const std::string& content) const {
        std::filesystem::create_directories((folder_ / name).parent_path());
        std::ofstream(path(name), std::ios::binary) << content;
        return path(name);
    }

private:
    std::filesystem::path folder_;
};

inline std::string read_text(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// All there is in a recording.
inline Batch read_everything(Recording& recording) {
    Batch batch;
    const auto parser = recording.make_parser();
    RawPacket packet;
    while (recording.read(packet) == ReadStatus::data) parser->parse(packet.bytes, batch);
    parser->finish(batch);
    return batch;
}

/// What its parser tells of the time once all was read.
inline std::optional<SensorTime> clock_at_end(Recording& recording) {
    Batch unused;
    const auto parser = recording.make_parser();
    RawPacket packet;
    while (recording.read(packet) == ReadStatus::data) parser->parse(packet.bytes, unused);
    parser->finish(unused);
    return parser->clock();
}

inline std::vector<Event> some_events(std::size_t n, std::int64_t first_us = 0,
                                      unsigned most_step_us = 20, int width = 128,
                                      int height = 128) {
    std::mt19937 random(3);
    std::vector<Event> events;
    std::int64_t t = first_us;
    for (std::size_t i = 0; i < n; ++i) {
        t += std::int64_t(random() % (most_step_us + 1));
        events.push_back({from_us(t), std::uint16_t(random() % unsigned(width)),
                          std::uint16_t(random() % unsigned(height)), Polarity(random() % 2)});
    }
    return events;
}

/// A recording of these events in a format that can be written, in batches.
inline std::string write_recording(const std::string& path, std::string_view format,
                                   const std::vector<Event>& events, int width = 128,
                                   int height = 128) {
    StreamHeader header;
    header.width = width;
    header.height = height;
    RecordingFile file(path, true, open_writer(format), header);
    for (std::size_t i = 0; i < events.size(); i += 1000) {
        Batch batch;
        batch.events.assign(events.begin() + std::ptrdiff_t(i),
                            events.begin() + std::ptrdiff_t(std::min(i + 1000, events.size())));
        file.write(batch);
    }
    file.finish();
    return path;
}

}  // namespace eventide
