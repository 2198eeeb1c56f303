// A paced recording gives the same bytes, and stops at once when told.
#include "replay/real_time_playback.h"

#include "replay/formats.h"
#include "src/core/error.h"
#include "tests/replay/recording_files.h"
#include "tests/replay/some_bags.h"

#include <chrono>
#include <cstdio>
#include <limits>
#include <thread>

namespace eventide {
namespace {

constexpr double kFasterThanAnyClock = 1e12, kForEver = 1e-9;

using Bytes = std::vector<std::byte>;

Bytes all_bytes(Recording& recording) {
    Bytes bytes;
    RawPacket packet;
    while (recording.read(packet) == ReadStatus::data)
        bytes.insert(bytes.end(), packet.bytes.begin(), packet.bytes.end());
    return bytes;
}

TEST(RealTimePlayback, GivesTheSameBytes) {
    const TestFolder folder;
    for (const char* format : {"text", "aedat3"}) {
        const std::string path = write_recording(folder.path("a"), format, some_events(30'000));
        RealTimePlayback paced(open_recording(path), kFasterThanAnyClock);
        EXPECT_TRUE(all_bytes(paced) == all_bytes(*open_recording(path)));
        EXPECT_EQ(paced.position_bytes(), paced.size_bytes());
    }
}

/// Of a format that is no stream, whose packets have more bytes than the file.
TEST(RealTimePlayback, TellsHowFarItIsInTheBytesOfTheFile) {
    const TestFolder folder;
    const std::string path = folder.write("a.bag", test::bag_of(some_events(20'000), "bz2"));
    RealTimePlayback paced(open_recording(path), kFasterThanAnyClock);
    std::uint64_t before = paced.position_bytes(), bytes = 0;
    for (RawPacket packet; paced.read(packet) == ReadStatus::data;
         before = paced.position_bytes()) {
        bytes += packet.bytes.size();
        ASSERT_GE(paced.position_bytes(), before);
    }
    EXPECT_EQ(paced.position_bytes(), paced.size_bytes());
    EXPECT_GT(bytes, paced.size_bytes());
    paced.seek(SensorTime::min());
    EXPECT_LT(paced.position_bytes(), paced.size_bytes() / 10);
}

TEST(RealTimePlayback, WhatIsNotDueIsNotGiven) {
    const TestFolder folder;
    const std::string path = write_recording(folder.path("a"), "text", some_events(30'000));
    RealTimePlayback paced(open_recording(path), kForEver);
    const std::uint64_t begin = paced.position_bytes();
    RawPacket packet;
    ASSERT_EQ(paced.read(packet), ReadStatus::data);
    EXPECT_LT(packet.bytes.size(), 1000U);  // of a chunk of 128 KiB
    EXPECT_EQ(paced.position_bytes(), begin + packet.bytes.size());
}

TEST(RealTimePlayback, APauseOfAnHourIsNotWaitedFor) {
    const TestFolder folder;
    auto events = some_events(200, 1'000'000, 1);
    for (std::size_t i = 100; i < events.size(); ++i) events[i].t += SensorDuration{3'600'000'000};
    const std::string path = write_recording(folder.path("a"), "text", events);
    RealTimePlayback paced(open_recording(path), 1);
    EXPECT_EQ(all_bytes(paced).size(), all_bytes(*open_recording(path)).size());
}

/// Events 10 ms apart, each in a packet of its own, by a host's clock that goes a millisecond
/// further each time somebody looks at it.
class PacedByMilliseconds {
public:
    explicit PacedByMilliseconds(const TestFolder& folder)
        : playback_{open(folder), 1, [this] { return now_ += std::chrono::milliseconds{1}; }} {
        for (RawPacket packet; given_ == 0;) read(packet);
        begin_ = now_;
    }
    /// Until a packet of the event has come. How long after the first, in ms by the host's clock.
    double when(int event) {
        for (RawPacket packet; given_ <= event;) read(packet);
        return std::chrono::duration<double, std::milli>(now_ - begin_).count();
    }
    void is_busy(std::chrono::milliseconds time) { now_ += time; }

private:
    static std::unique_ptr<Recording> open(const TestFolder& folder) {
        OpenOptions as_they_come;
        as_they_come.text.reorder = SensorDuration{0};
        std::string rows = "240 180\n";
        for (int i = 0; i < 200; ++i) {
            char row[32];
            std::snprintf(row, sizeof row, "%.6f 1 2 1\n", 1 + .01 * i);
            // So long that each row is a piece, whose time is known with its last byte.
            rows += "#" + std::string(256 - 2 - std::string{row}.size(), ' ') + "\n" + row;
        }
        return open_recording(folder.write("paced.txt", rows), as_they_come);
    }
    void read(RawPacket& packet) {
        ASSERT_EQ(playback_.read(packet), ReadStatus::data);
        bytes_ += packet.bytes.size();
        given_ = int(bytes_ / 256);
    }

    HostTime now_{};  // long past: nothing is waited for
    HostTime begin_{};
    RealTimePlayback playback_;
    std::size_t bytes_ = 0;
    int given_ = 0;
};

TEST(RealTimePlayback, WhatIsALittleLateIsMadeUpForAndWhatIsMoreIsNot) {
    const TestFolder folder;
    PacedByMilliseconds reader{folder};
    EXPECT_NEAR(reader.when(20), 200, 5);
    reader.is_busy(std::chrono::milliseconds{150});
    EXPECT_NEAR(reader.when(40), 400, 5) << "on time again";
    reader.is_busy(std::chrono::milliseconds{1000});
    const double late = reader.when(41);
    EXPECT_NEAR(late, 1400, 15);
    EXPECT_NEAR(reader.when(61), late + 200, 15) << "at its pace from there";
}

TEST(RealTimePlayback, StopEndsAWait) {
    const TestFolder folder;
    const std::string path = write_recording(folder.path("a"), "text", some_events(30'000));
    RealTimePlayback paced(open_recording(path), kForEver);
    RawPacket packet;
    ASSERT_EQ(paced.read(packet), ReadStatus::data);
    std::jthread stopper([&] { paced.stop(); });
    EXPECT_EQ(paced.read(packet), ReadStatus::end);
    EXPECT_EQ(paced.read(packet), ReadStatus::end);
}

TEST(RealTimePlayback, AChangeOfSpeedIsHeardByAReadThatWaits) {
    const TestFolder folder;
    const std::string path = write_recording(folder.path("a"), "text", some_events(30'000));
    RealTimePlayback paced(open_recording(path), kForEver);
    RawPacket packet;
    ASSERT_EQ(paced.read(packet), ReadStatus::data);
    std::size_t bytes = packet.bytes.size();
    std::jthread changer([&] {
        paced.set_speed(0);
        paced.set_speed(kFasterThanAnyClock);
    });
    bytes += all_bytes(paced).size();
    EXPECT_EQ(bytes, all_bytes(*open_recording(path)).size());
    EXPECT_EQ(paced.speed(), kFasterThanAnyClock);
}

TEST(RealTimePlayback, AfterASeekWhatLiesBeforeIsNotWaitedFor) {
    const TestFolder folder;
    const auto events = some_events(30'000);
    const std::string path = write_recording(folder.path("a"), "text", events);
    OpenOptions as_they_come;  // else an event waits for ones 10 ms later
    as_they_come.text.reorder = SensorDuration{0};
    RealTimePlayback paced(open_recording(path, as_they_come), kForEver);
    paced.seek(events[20'000].t);
    const auto parser = paced.make_parser();
    Batch batch;
    RawPacket packet;
    while (batch.events.empty() || batch.events.back().t < events[20'000].t) {
        ASSERT_EQ(paced.read(packet), ReadStatus::data);
        parser->parse(packet.bytes, batch);
    }
}

TEST(RealTimePlayback, OnlyPositiveSpeedsAreTaken) {
    const TestFolder folder;
    const std::string path = folder.write("a.txt", "9 9\n0.1 1 2 1\n");
    for (const double speed : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::infinity()})
        EXPECT_THROW(RealTimePlayback(open_recording(path), speed), Error);
    EXPECT_THROW(RealTimePlayback(open_recording(path), 1).set_speed(-1), Error);
}

}  // namespace
}  // namespace eventide
