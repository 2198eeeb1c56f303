// Seek in files that were joined (cat), where the clock begins anew with the second.
#include "replay/formats.h"
#include "tests/replay/made_formats.h"

#include <string>
#include <vector>

namespace eventide {
namespace {

/// What is read after a seek, and whether that is less than all.
std::vector<Event> events_from(const std::string& path, SensorTime t, bool& skipped) {
    const auto recording = open_recording(path);
    const auto begin = recording->position_bytes();
    recording->seek(t);
    skipped = recording->position_bytes() > begin + recording->size_bytes() / 10;
    return read_everything(*recording).events;
}

class SeekInJoinedFiles : public testing::TestWithParam<const char*> {
protected:
    /// From a number of times near the end of the first, so that the clock begins anew soon behind.
    void expect_end_found(const std::vector<Event>& first, const std::vector<Event>& second) {
        std::string bytes = read_text(write_as(folder_, GetParam(), first));
        bytes += read_text(write_as(folder_, GetParam(), second));
        const std::string path = folder_.write("joined", bytes);
        const auto all = read_everything(*open_recording(path)).events;
        ASSERT_EQ(all.size(), first.size() + second.size());
        for (const std::size_t left : {1U, 10U, 100U, 1'000U, 3'000U, 30'000U}) {
            const auto begin = all.begin() + std::ptrdiff_t(first.size() - left);
            bool skipped = false;
            const auto found = events_from(path, begin->t, skipped);
            ASSERT_GE(found.size(), std::size_t(all.end() - begin)) << left;
            EXPECT_TRUE(std::equal(begin, all.end(), found.end() - (all.end() - begin))) << left;
            EXPECT_TRUE(skipped) << "reads from the beginning";
        }
    }

private:
    const TestFolder folder_;
};

INSTANTIATE_TEST_SUITE_P(Formats, SeekInJoinedFiles,
                         testing::Values("aedat2", "evt2", "evt21", "evt3", "dat"),
                         [](const auto& each) { return std::string(each.param); });

TEST_P(SeekInJoinedFiles, TheEndOfTheFirstIsFoundWhereTheSecondIsEarlier) {
    expect_end_found(some_events(120'000, 9'000'000, 50), some_events(60'000, 1'000'000));
}

/// So that a time in the middle of the second may also be one of the first.
TEST_P(SeekInJoinedFiles, TheEndOfTheFirstIsFoundWhereTheSecondHasTheSameTimes) {
    expect_end_found(some_events(120'000, 1'000'000, 50), some_events(200'000, 1'000'000, 50));
}

}  // namespace
}  // namespace eventide
