// A recording of any length takes the memory of a short one.
#include "replay/formats.h"
#include "replay/summary.h"
#include "src/codec/aedat4/aedat4_header.h"
#include "tests/replay/made_formats.h"

#include <unistd.h>

#include <thread>

namespace eventide {
namespace {

constexpr std::size_t kStreamBytes = std::size_t(96) << 20;
constexpr std::size_t kMaxGrowthBytes = std::size_t(32) << 20;

/// Of /proc/self/status, in bytes.
std::size_t memory(const std::string& key) {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with(key + ":")) return std::stoull(line.substr(key.size() + 1)) << 10;
    return 0;
}

void forget_peak() {
    std::ofstream("/proc/self/clear_refs") << "5";
}

/// The header, then the records again and again, into one end of a pipe.
void write_stream(int end, const std::string& header, const std::string& records) {
    const auto write_all = [end](std::string_view bytes) {
        while (!bytes.empty()) {
            const ssize_t n = ::write(end, bytes.data(), bytes.size());
            if (n <= 0) return;
            bytes.remove_prefix(std::size_t(n));
        }
    };
    write_all(header);
    for (std::size_t done = 0; done < kStreamBytes; done += records.size()) write_all(records);
    ::close(end);
}

class MemoryOfReading : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Formats, MemoryOfReading,
                         testing::Values("text", "aedat1", "aedat2", "aedat3", "aedat4", "evt2",
                                         "evt21", "evt3", "dat", "es"),
                         [](const auto& each) { return std::string(each.param); });

TEST_P(MemoryOfReading, DoesNotGrowWithTheRecording) {
    const TestFolder folder;
    const std::string path = write_as(folder, GetParam(), some_events(100'000));
    const auto recording = open_recording(path);
    const auto& file = dynamic_cast<const FileRecording&>(*recording);
    std::string content = read_text(path);
    if (file.header().format == "aedat4")  // what follows its table is not read
        content.resize(
            std::size_t(read_aedat4_header(std::as_bytes(std::span(content))).table_position));
    const auto begin = std::size_t(file.header().data_offset);

    std::array<int, 2> ends{};
    ASSERT_EQ(::pipe(ends.data()), 0);
    std::jthread writer(write_stream, ends[1], content.substr(0, begin), content.substr(begin));
    OpenOptions options;
    options.width = options.height = 128;
    const auto stream = open_recording("/dev/fd/" + std::to_string(ends[0]), options);
    forget_peak();
    const std::size_t before = memory("VmRSS");
    const Summary sum = summarize(*stream);
    EXPECT_LT(memory("VmHWM"), before + kMaxGrowthBytes);
    // All of it was read: the first round's events, and the others' as far as time allows.
    EXPECT_GE(sum.events, 100'000U);
    EXPECT_GE(stream->position_bytes(), kStreamBytes);
    ::close(ends[0]);
}

TEST(MemoryOfReading, IsMeasuredByADetectorThatDetects) {
    forget_peak();
    const std::size_t before = memory("VmRSS");
    const std::string large(2 * kMaxGrowthBytes, 'x');
    EXPECT_GT(memory("VmHWM"), before + kMaxGrowthBytes) << large.size();
}

}  // namespace
}  // namespace eventide
