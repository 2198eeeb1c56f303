// Recordings through the library: written, and read again.
#include "tests/library/library_test.h"

#include <filesystem>
#include <functional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace eventide::test {
namespace {

using Recordings = LibraryTest;

TEST_F(Recordings, ComeBackAsTheyWereWritten) {
    EventReader reader{recording()};
    EventWriter events_alone{temp_ / "events.raw", reader.info(), {"evt3", false}};
    EventWriter all{temp_ / "all.aedat4", reader.info()};
    std::vector<Event> events;
    for (Batch batch; reader.read(batch);) {
        events.insert(events.end(), batch.events.begin(), batch.events.end());
        events_alone.write(batch);
        all.write(batch);
    }
    EXPECT_FALSE(std::filesystem::exists(temp_ / "all.aedat4")) << "not before it is whole";
    events_alone.finish();
    all.finish();
    EXPECT_EQ(events_alone.not_held(), 11U) << "images";
    EXPECT_EQ(all.not_held(), 0U);
    EXPECT_EQ(events_of(temp_ / "events.raw"), events);
    EXPECT_EQ(events_of(temp_ / "all.aedat4"), events);
    EXPECT_NE(error_of([&] { all.write(std::span<const Event>{events}); }).find("finish()"),
              std::string::npos);
    EventWriter text{temp_ / "events.txt", {"", "", "", 64, 48}};
    text.write(std::span<const Event>{events});
    text.finish();
    EventReader again{temp_ / "events.txt", {"", 64, 48}};
    EXPECT_EQ(again.width(), 64);
}

TEST_F(Recordings, OfAColourCameraSaySoWhenTheyComeBack) {
    Batch batch;
    batch.images.resize(1);
    batch.images[0].pixels = Array2<std::uint16_t>(48, 64);
    EventWriter writer{temp_ / "colour.aedat4",
                       {"DAVIS346", "00000007", "", 64, 48, ColourFilter::grbg}};
    writer.write(batch);
    writer.finish();
    EventReader reader{temp_ / "colour.aedat4"};
    EXPECT_EQ(reader.info().colour_filter, ColourFilter::grbg);
    EXPECT_EQ(reader.info().name, "DAVIS346");
    EXPECT_EQ(reader.info().serial, "00000007");
    ASSERT_TRUE(reader.read(batch));
    ASSERT_EQ(batch.images.size(), 1U);
    EXPECT_EQ(batch.images[0].filter, ColourFilter::grbg);
}

TEST_F(Recordings, HoldNoImageWhoseExposureEndsBeforeItBegins) {
    Batch batch;
    batch.images.resize(1);
    batch.images[0].pixels = Array2<std::uint16_t>(4, 6);
    batch.images[0].t = batch.images[0].exposure_begin = from_us(9);
    batch.images[0].exposure_end = from_us(8);
    EventWriter writer{temp_ / "images.aedat4", {"", "", "", 64, 48}};
    EXPECT_NE(error_of([&] { writer.write(batch); }).find("exposure_end not before"),
              std::string::npos);
    batch.images[0].exposure_end = from_us(9);
    writer.write(batch);
    writer.finish();
    EventReader reader{temp_ / "images.aedat4"};
    std::size_t images = 0;
    for (Batch read; reader.read(read);) images += read.images.size();
    EXPECT_EQ(images, 1U);
}

TEST_F(Recordings, AreWrittenInTheOrderOfTimeOnly) {
    const auto at = [](std::int64_t t) { return Event{from_us(t), 1, 2, Polarity::on}; };
    for (const std::string format : {"aedat4", "aedat3", "evt3", "text"}) {
        const std::string file = temp_ / ("ordered." + format);
        EventWriter writer{file, {"", "", "", 64, 48}, {format, false}};
        writer.write(std::vector{at(1000), at(1000), at(2000)});
        // A reader would leave out the second, or all until 2000 us.
        EXPECT_NE(error_of([&] {
                      writer.write(std::vector{at(3000), at(2500)});
                  }).find("expected events in order of time, found one at 2500 us after one"),
                  std::string::npos)
            << format;
        EXPECT_NE(error_of([&] { writer.write(std::vector{at(1999)}); }).find("2000 us"),
                  std::string::npos)
            << format;
        writer.write(std::vector{at(2000), at(4000)});
        writer.finish();
        const ReaderOptions size{"", format == "text" ? 64 : 0, format == "text" ? 48 : 0};
        EventReader reader{file, size};
        std::vector<Event> events;
        for (Batch batch; reader.read(batch);)
            events.insert(events.end(), batch.events.begin(), batch.events.end());
        EXPECT_EQ(events, (std::vector{at(1000), at(1000), at(2000), at(2000), at(4000)}))
            << format << ": what was refused is not in it";
    }
}

TEST_F(Recordings, AreWrittenWithinTheSensorOnly) {
    for (const std::string format : {"aedat4", "aedat3", "evt3", "text"}) {
        EventWriter writer{temp_ / ("within." + format), {"", "", "", 64, 48}, {format, false}};
        for (const auto& [x, y, found] : {std::tuple{64, 2, "64,2"}, {2, 48, "2,48"}}) {
            const std::vector<Event> outside{
                {from_us(1), std::uint16_t(x), std::uint16_t(y), Polarity::on}};
            EXPECT_NE(error_of([&] {
                          writer.write(outside);
                      }).find(std::string{"within 64x48 px, found one at "} + found),
                      std::string::npos)
                << format;
        }
    }
}

TEST_F(Recordings, AreWrittenOfSensorsThatCoordinatesReachOnly) {
    for (const auto& [width, height] : {std::pair{0, 48}, {64, 0}, {65536, 48}, {64, 65536}})
        EXPECT_NE(error_of([&, w = width, h = height] {
                      EventWriter{temp_ / "a.txt", {"", "", "", w, h}};
                  })
                      .find("sensor size: expected 1 to 65535 px, found " + std::to_string(width) +
                            "x" + std::to_string(height)),
                  std::string::npos);
}

TEST_F(Recordings, CountWhatTheyDoNotHoldOnceTheRestIsAccepted) {
    Batch batch;
    batch.images.resize(1);
    batch.images[0].pixels = Array2<std::uint16_t>(48, 64);
    batch.events = {{from_us(1), 64, 2, Polarity::on}};
    EventWriter writer{temp_ / "events.txt", {"", "", "", 64, 48}};
    EXPECT_NE(error_of([&] { writer.write(batch); }).find("within 64x48 px"), std::string::npos);
    EXPECT_EQ(writer.not_held(), 0U);
    batch.events[0].x = 63;
    writer.write(batch);
    EXPECT_EQ(writer.not_held(), 1U);
}

/// A part of the batch may be in the file by then.
TEST_F(Recordings, EndWithABatchThatTheirFormatCannotHold) {
    const auto at = [](std::int64_t t_us, int x) {
        return Event{from_us(t_us), std::uint16_t(x), 2, Polarity::on};
    };
    for (const std::string format : {"aedat3", "aedat4", "evt3"}) {
        const std::string file = temp_ / ("ended." + format);
        EventWriter writer{file, {"", "", "", 40000, 48}, {format, false}};
        writer.write(std::vector{at(1, 5)});
        EXPECT_NE(error_of([&] { writer.write(std::vector{at(2, 5), at(3, 39999)}); }), "");
        for (const auto& then :
             {std::function<void()>{[&] { writer.write(std::vector{at(2, 5)}); }},
              {[&] { writer.finish(); }}})
            EXPECT_NE(error_of(then).find("one of which a write failed"), std::string::npos)
                << format;
        EXPECT_FALSE(std::filesystem::exists(file)) << format;
    }
}

TEST_F(Recordings, OfTheLargestSensorsComeBack) {
    for (const auto& [format, side] : {std::pair{"hdf5", 5000}, {"aedat4", 32768}}) {
        const std::string file = temp_ / (std::string{"large."} + format);
        const std::vector<Event> corner{
            {from_us(1), std::uint16_t(side - 1), std::uint16_t(side - 1), Polarity::on}};
        EventWriter writer{file, {"", "", "", side, side}, {format, false}};
        writer.write(corner);
        writer.finish();
        EXPECT_EQ(EventReader{file}.width(), side);
        EXPECT_EQ(events_of(file), corner);
    }
}

TEST_F(Recordings, HoldNoImageThatTheirReaderLeavesOut) {
    for (const std::string format : {"aedat4", "aedat3"}) {
        Batch batch;
        batch.images.resize(1);
        batch.images[0].pixels = Array2<std::uint16_t>(4, 6);
        batch.images[0].x0 = -1;
        EventWriter writer{temp_ / ("beyond." + format), {"", "", "", 64, 48}, {format, false}};
        EXPECT_NE(error_of([&] { writer.write(batch); }).find("-1, 0"), std::string::npos);
    }
}

TEST_F(Recordings, HoldImagesSamplesAndTriggersOfTimesThatAreReadOnly) {
    const SensorTime far = from_us(-Reconstructor::kFarthestTime - 1);
    std::vector<Batch> batches(5);
    for (std::size_t i = 0; i < 3; ++i) {
        batches[i].images.resize(1);
        batches[i].images[0].pixels = Array2<std::uint16_t>(48, 64);
    }
    batches[0].images[0].t = far;
    batches[1].images[0].exposure_begin = far;
    batches[2].images[0].exposure_begin = batches[2].images[0].exposure_end = far;
    batches[3].imu.resize(1);
    batches[3].imu[0].t = far;
    batches[4].triggers = {{far, Trigger::Kind::rising}};
    EventWriter writer{temp_ / "far.aedat4", {"", "", "", 64, 48}};
    for (const Batch& batch : batches)
        EXPECT_NE(error_of([&] { writer.write(batch); }).find("at most 2^60 us"),
                  std::string::npos);
}

TEST_F(Recordings, AreWrittenAtTimesThatAreReadOnly) {
    constexpr std::int64_t kLast = Reconstructor::kFarthestTime;
    for (const std::string format : {"aedat4", "evt3", "text", "hdf5"}) {
        const std::string file = temp_ / ("far." + format);
        EventWriter writer{file, {"", "", "", 64, 48}, {format, false}};
        const std::vector<Event> far{{from_us(kLast + 1), 1, 2, Polarity::on}};
        EXPECT_NE(error_of([&] { writer.write(far); }).find("at most 2^60 us"), std::string::npos)
            << format;
    }
    const std::string file = temp_ / "last.h5";
    EventWriter writer{file, {"", "", "", 64, 48}, {"hdf5", false}};
    writer.write(std::vector<Event>{{from_us(kLast), 1, 2, Polarity::on}});
    writer.finish();
    EXPECT_EQ(events_of(file).size(), 1U);
}

TEST_F(Recordings, ThatCannotBeWrittenAreRefusedInWords) {
    const SensorInfo sensor{"", "", "", 64, 48};
    EXPECT_NE(error_of([&] { EventWriter(temp_ / "a.jpeg", sensor); }).find("a.jpeg"),
              std::string::npos);
    EXPECT_NE(error_of([&] { EventWriter(temp_ / "a.raw", {}); }).find("found 0x0"),
              std::string::npos);
    write_text(temp_ / "letter", "Dear Sir or Madam");
    EXPECT_NE(error_of([&] {
                  EventWriter(temp_ / "letter", sensor, {"aedat4", false});
              }).find("letter"),
              std::string::npos);
    EXPECT_EQ(read_text(temp_ / "letter"), "Dear Sir or Madam") << "what exists is not replaced";
}

}  // namespace
}  // namespace eventide::test
