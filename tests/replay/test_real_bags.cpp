// Bags that others recorded.
#include "replay/formats.h"
#include "replay/summary.h"
#include "src/core/error.h"
#include "tests/replay/recording_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>

namespace eventide {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// Null where it is not at hand or cannot be read by this build, and `why_not` tells.
std::unique_ptr<Recording> open_known(const char* name, std::string& why_not) {
    const auto path = std::filesystem::path(EVENTIDE_SOURCE_DIR) / "../shared/data/formats" / name;
    if (!std::filesystem::exists(path)) {
        why_not = "no " + std::string{name} + " at hand";
        return nullptr;
    }
    try {
        return open_recording(path.string());
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::failed) throw;
        why_not = error.what();  // built without SQLite
        return nullptr;
    }
}

struct Known {
    const char* name;
    const char* format;
    std::uint64_t off, on;
};

class RealBags : public testing::TestWithParam<Known> {};

TEST_P(RealBags, GiveTheKnownNumbers) {
    const Known& known = GetParam();
    std::string why_not;
    const auto recording = open_known(known.name, why_not);
    if (!recording) GTEST_SKIP() << why_not;
    const Summary sum = summarize(*recording);
    EXPECT_EQ(sum.format, known.format);
    EXPECT_EQ(sum.events - sum.on, known.off);
    EXPECT_EQ(sum.on, known.on);
    EXPECT_EQ(sum.damaged.total(), 0U);
    recording->seek(*sum.first);
    EXPECT_EQ(read_everything(*recording).events.size(), sum.events);
}

INSTANTIATE_TEST_SUITE_P(All, RealBags,
                         testing::Values(Known{"ros1_events.bag", "rosbag", 218291, 125183},
                                         Known{"ros2_events.mcap", "mcap", 360223, 211043}),
                         [](const auto& each) { return std::string(each.param.format); });

/// Of these the sums of their events are known.
struct KnownSums {
    const char* name;
    std::uint64_t x, y, on;
};

class RealDb3 : public testing::TestWithParam<KnownSums> {};

TEST_P(RealDb3, GivesTheKnownSums) {
    const KnownSums& known = GetParam();
    std::string why_not;
    const auto recording = open_known(known.name, why_not);
    if (!recording) GTEST_SKIP() << why_not;
    EXPECT_EQ(recording->info().format, "db3");
    EXPECT_THAT(recording->remarks(), ElementsAre());
    std::uint64_t x = 0, y = 0, on = 0;
    for (const Event& event : read_everything(*recording).events) {
        x += event.x;
        y += event.y;
        on += event.polarity == Polarity::on;
    }
    EXPECT_EQ(x, known.x);
    EXPECT_EQ(y, known.y);
    EXPECT_EQ(on, known.on);
}

INSTANTIATE_TEST_SUITE_P(
    All, RealDb3,
    testing::Values(KnownSums{"ros2_evt3_trigger.db3", 42078718, 31656267, 41439},
                    KnownSums{"ros2_libcaer_rollover.db3", 111651612, 82801007, 181908}),
    [](const auto& each) { return std::to_string(each.index); });

TEST_P(RealDb3, SaysThatItsJournalIsNotRead) {
    std::string why_not;
    if (!open_known(GetParam().name, why_not)) GTEST_SKIP() << why_not;
    const TestFolder folder;
    const std::string path = folder.path("a.db3");
    std::filesystem::copy_file(
        std::filesystem::path(EVENTIDE_SOURCE_DIR) / "../shared/data/formats" / GetParam().name,
        path);
    folder.write("a.db3-wal", "pages");
    EXPECT_THAT(open_recording(path)->remarks(), ElementsAre(HasSubstr("a.db3-wal, what the")));
}

/// Of a recorder that was not closed: SQLite keeps in a journal what is not in the file yet.
TEST(Db3Journal, WhatIsStillInItIsSaidNotToBeRead) {
    // A first page with no table on it, of a file with such a journal.
    std::string file("SQLite format 3");
    file.resize(4096);
    for (const auto& [at, byte] : {std::pair{16, 16},
                                   {18, 2},
                                   {19, 2},
                                   {21, 64},
                                   {22, 32},
                                   {23, 32},
                                   {27, 1},
                                   {31, 1},
                                   {95, 1},
                                   {99, 1},
                                   {100, 13},
                                   {105, 16}})
        file[std::size_t(at)] = char(byte);
    const TestFolder folder;
    const std::string path = folder.write("a.db3", file);
    const auto refusal = [&] {
        try {
            open_recording(path);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    if (refusal().find("EVENTIDE_SQLITE") != std::string::npos) GTEST_SKIP() << refusal();
    EXPECT_THAT(refusal(), AllOf(HasSubstr("without its tables"), Not(HasSubstr("-wal"))));
    folder.write("a.db3-wal", "");
    EXPECT_THAT(refusal(), Not(HasSubstr("-wal")));
    folder.write("a.db3-wal", "pages");
    EXPECT_THAT(refusal(), HasSubstr("a.db3-wal, what the recorder had not moved into the file"));
}

}  // namespace
}  // namespace eventide
