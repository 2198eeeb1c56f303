// Recordings of a stream whose clock begins anew, and of triggers that come late.
#include "apps/cli/run/events_out.h"
#include "apps/cli/run/recorded_source.h"
#include "replay/written_data.h"
#include "src/codec/udp_records.h"
#include "tests/replay/recording_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <vector>

namespace eventide::app {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Event at(std::int64_t us) {
    return {from_us(us), 1, 1, Polarity::on};
}

template <typename T>
std::vector<std::int64_t> times_of(const std::vector<T>& items) {
    std::vector<std::int64_t> times;
    for (const T& item : items) times.push_back(to_us(item.t));
    return times;
}

TEST(WrittenData, GoOnWhereTheFormatCannotSayThatTheClockBeganAnew) {
    WrittenData data{find_format("evt3")->holds};
    Batch batch;
    batch.events = {at(5000), at(6000), at(10), at(30)};
    batch.triggers = {{from_us(5500), Trigger::Kind::rising, 0},
                      {from_us(20), Trigger::Kind::rising, 0}};
    data.fit(batch);
    EXPECT_THAT(times_of(batch.events), ElementsAre(5000, 6000, 6001, 6021));
    EXPECT_THAT(times_of(batch.triggers), ElementsAre(5500, 6011));
    Batch next;
    next.events = {at(40), at(7)};
    next.triggers = {{from_us(35), Trigger::Kind::rising, 0}};
    data.fit(next);
    EXPECT_THAT(times_of(next.events), ElementsAre(6031, 6032));
    EXPECT_THAT(times_of(next.triggers), ElementsAre(6026));
    EXPECT_EQ(data.restarts(), 2U);
    EXPECT_EQ(data.late_triggers(), 0U);
    EXPECT_THAT(data.remarks("x.raw"),
                ElementsAre(HasSubstr("x.raw: the clock began anew 2 times")));
}

TEST(WrittenData, GoOnWhereTheClockLeapsFurtherThanTheFormatCanSay) {
    constexpr std::int64_t kSince1970 = 1'700'000'000'000'000;
    for (const char* const format : {"evt3", "text", "aedat4"}) {
        WrittenData data{find_format(format)->holds};
        Batch batch;
        batch.events = {at(5000), at(kSince1970), at(kSince1970 + 7)};
        data.fit(batch);
        const bool moves = data.restarts() == 1;
        EXPECT_EQ(moves, std::string_view{format} == "evt3") << format;
        const std::int64_t first = moves ? 5001 : kSince1970;
        EXPECT_THAT(times_of(batch.events), ElementsAre(5000, first, first + 7)) << format;
    }
}

TEST(WrittenData, StayWhereTheFormatSaysIt) {
    WrittenData data{find_format("aedat4")->holds};
    Batch batch;
    batch.events = {at(5000), at(10)};
    data.fit(batch);
    EXPECT_THAT(times_of(batch.events), ElementsAre(5000, 10));
    EXPECT_THAT(data.remarks("x.aedat4"), IsEmpty());
}

TEST(WrittenData, AreTakenOutWhereTheFormatHasNoRecordForThem) {
    WrittenData data{find_format("text")->holds};
    Batch batch;
    batch.events = {at(5)};
    batch.images.resize(2);
    batch.triggers.resize(1);
    data.fit(batch);
    EXPECT_EQ(batch.events.size(), 1U);
    EXPECT_TRUE(batch.images.empty() && batch.triggers.empty());
    EXPECT_FALSE(data.is_whole());
    EXPECT_THAT(data.remarks("x.txt"),
                ElementsAre("x.txt: left out what its format cannot hold: 2 images, 1 trigger"));
}

TEST(WrittenData, LoseTheColourFilterWhereTheFormatCannotSayIt) {
    const auto remarks_of = [](const char* format, ColourFilter colours, std::size_t images) {
        WrittenData data{find_format(format)->holds, colours};
        Batch batch;
        batch.events = {at(5)};
        batch.images.resize(images);
        data.fit(batch);
        EXPECT_EQ(data.is_whole(), data.remarks("x").empty());
        return data.remarks("x");
    };
    EXPECT_THAT(remarks_of("hdf5", ColourFilter::gbrg, 1),
                ElementsAre("x: its format cannot say the images' colour filter, gbrg: --bayer "
                            "states it"));
    EXPECT_THAT(remarks_of("hdf5", ColourFilter::gbrg, 0), IsEmpty()) << "there is no mosaic";
    EXPECT_THAT(remarks_of("hdf5", ColourFilter::none, 1), IsEmpty());
    EXPECT_THAT(remarks_of("aedat3", ColourFilter::gbrg, 1), IsEmpty());
    EXPECT_THAT(remarks_of("aedat4", ColourFilter::gbrg, 1), IsEmpty());
}

/// As a topic's messages do.
TEST(WrittenData, LoseTheColourFilterThatImagesAloneTell) {
    const auto remarks_of = [](const char* format, ColourFilter colours, int channels) {
        WrittenData data{find_format(format)->holds, colours};
        Batch batch;
        batch.images.resize(1);
        batch.images[0].filter = ColourFilter::gbrg;
        batch.images[0].channels = channels;
        data.fit(batch);
        EXPECT_EQ(data.is_whole(), data.remarks("x").empty());
        return data.remarks("x");
    };
    EXPECT_THAT(remarks_of("hdf5", ColourFilter::none, 1),
                ElementsAre("x: its format cannot say the images' colour filter, gbrg: --bayer "
                            "states it"));
    EXPECT_THAT(remarks_of("aedat4", ColourFilter::none, 1),
                ElementsAre("x: its format says the images' colour filter before the first of "
                            "them, which told it, gbrg: --bayer states it"));
    EXPECT_THAT(remarks_of("aedat4", ColourFilter::gbrg, 1), IsEmpty());
    EXPECT_THAT(remarks_of("aedat3", ColourFilter::none, 1), IsEmpty());
    EXPECT_THAT(remarks_of("aedat4", ColourFilter::none, 3), IsEmpty()) << "no mosaic";
}

TEST(WrittenData, CountTriggersBehindLaterEvents) {
    for (const char* const format : {"evt3", "aedat4"}) {
        WrittenData data{find_format(format)->holds};
        Batch batch;
        batch.events = {at(100), at(200)};
        batch.triggers = {{from_us(50), Trigger::Kind::rising, 0}};
        data.fit(batch);
        batch.triggers = {{from_us(199), Trigger::Kind::rising, 0},
                          {from_us(200), Trigger::Kind::rising, 0}};
        batch.events = {at(300)};
        data.fit(batch);
        const bool is_evt3 = std::string_view{format} == "evt3";
        EXPECT_EQ(data.late_triggers(), is_evt3 ? 1U : 0U) << format;
        if (is_evt3) {
            EXPECT_THAT(data.remarks("x.raw"),
                        ElementsAre(HasSubstr("x.raw: 1 trigger came behind")));
        }
    }
}

/// A UDP sender that counts to 9 s and is then started again.
class RestartedSender final : public Source {
public:
    RestartedSender() {
        info_.width = 64;
        info_.height = 48;
    }
    const SensorInfo& info() const override { return info_; }
    bool is_live() const noexcept override { return true; }
    ReadStatus read(RawPacket& into) override {
        if (packets_ == 2) return ReadStatus::end;
        std::vector<Event> events;
        for (int i = 0; i < 50; ++i) events.push_back(at((packets_ == 0 ? 9'000'000 : 0) + i));
        ++packets_;
        into.bytes.clear();
        append_udp_records(UdpRecords::t64, events, into.bytes);
        return ReadStatus::data;
    }
    void stop() noexcept override {}
    std::unique_ptr<Parser> make_parser() const override {
        return std::make_unique<UdpRecordsParser>(UdpRecords::t64, info_.width, info_.height);
    }

private:
    SensorInfo info_;
    int packets_ = 0;
};

TEST(RecordedSource, GoesOnWhereASenderIsStartedAgain) {
    for (const std::string name : {"a.raw", "a.aedat4", "a.h5", "a.txt"}) {
        const TestFolder folder;
        const std::string file = folder.path(name);
        RestartedSender sender;
        RecordedSource recorded{sender, file, ColourFilter::none, {}};
        for (RawPacket packet; recorded.read(packet) == ReadStatus::data;) continue;
        recorded.finish();
        const std::size_t known_as_old = UdpRecordsParser::kEventsOfAnother - 1;
        EXPECT_EQ(read_everything(*open_recording(file)).events.size(), 100 - known_as_old) << name;
        EXPECT_EQ(recorded.data().restarts(), name == "a.aedat4" ? 0U : 1U) << name;
    }
}

/// Takes what EVT3 takes.
struct KeepsTriggers final : ConvertTarget {
    const FormatHolds& holds() const override { return find_format("evt3")->holds; }
    void write(const Batch&) override {}
    void finish() override {}
    std::uint64_t bytes_written() const override { return 0; }
};

TEST(EventsOut, CountsTriggersBehindLaterEvents) {
    const EventsOut::Limit none = [] { return std::optional<SensorTime>{}; };
    EventsOut out{nullptr, std::make_unique<KeepsTriggers>(), none, none};
    Batch batch;
    batch.events = {at(100)};
    out.see(batch);
    out.process(batch.events);
    Batch late;
    late.triggers = {{from_us(99), Trigger::Kind::falling, 1}};
    out.see(late);
    out.finish();
    EXPECT_EQ(out.data().late_triggers(), 1U);
}

}  // namespace
}  // namespace eventide::app
