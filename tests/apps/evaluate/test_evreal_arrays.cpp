// The arrays that EVREAL's own tools make.
#include "apps/evaluate/evaluate.h"
#include "apps/evaluate/evreal_sequence.h"
#include "src/core/error.h"
#include "tests/apps/evaluate/recordings.h"
#include "tests/apps/evaluate/small_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

namespace eventide::test {
namespace {

/// An .npy file of these bytes per number.
template <typename T>
void write_npy(const fs::path& path, const std::string& kind, const std::string& shape,
               const std::vector<T>& values) {
    const std::string header =
        "{'descr': '" + kind + "', 'fortran_order': False, 'shape': (" + shape + "), }\n";
    std::ofstream file{path, std::ios::binary};
    file << std::string{"\x93NUMPY\x01\x00", 8} << char(header.size()) << '\0' << header;
    file.write(reinterpret_cast<const char*>(values.data()),
               std::streamsize(values.size() * sizeof(T)));
}

TEST(Evreal, ReadsTheSameFromItsOwnArraysAsFromText) {
    const fs::path dataset = fresh_folder("ecd_npy");
    const ReferenceSequence text =
        read_reference_sequence(write_recording(dataset / "text", 1.05, .001, .1));
    std::vector<double> ts, images_ts;
    std::vector<std::int64_t> xy, p;
    std::vector<std::uint8_t> images;
    for (const Event& event : text.events) {
        ts.push_back(double(to_us(event.t)) * 1e-6);
        xy.insert(xy.end(), {event.x, event.y});
        p.push_back(event.polarity == Polarity::on ? 1 : 0);
    }
    for (const ReferenceImage& image : text.images) {
        images_ts.push_back(double(to_us(image.t)) * 1e-6);
        for (const std::uint16_t v : image.pixels.values()) images.push_back(std::uint8_t(v / 257));
    }
    const fs::path folder = dataset / "arrays";
    fs::create_directories(folder);
    const std::string n = std::to_string(ts.size()), m = std::to_string(images_ts.size());
    write_npy(folder / "events_ts.npy", "<f8", n + ",", ts);
    write_npy(folder / "events_xy.npy", "<i8", n + ", 2", xy);
    write_npy(folder / "events_p.npy", "<i8", n + ",", p);
    write_npy(folder / "images_ts.npy", "<f8", m + ", 1", images_ts);
    write_npy(folder / "images.npy", "|u1", m + ", 28, 36, 1", images);

    const ReferenceSequence arrays = read_evreal_sequence(folder, {}, {});
    EXPECT_EQ(arrays.events, text.events);
    EXPECT_EQ(arrays.images, text.images);
    const ReferenceSequence part = read_evreal_sequence(folder, .2, .5);
    const ReferenceSequence text_part = read_reference_sequence(dataset / "text", .2, .5);
    EXPECT_EQ(part.events, text_part.events);
    EXPECT_EQ(part.images, text_part.images);
    EXPECT_EQ(part.images.size(), 4U);

    const EvaluateReport report = evaluate_evreal(dataset, small_model());
    ASSERT_EQ(report.sequences.size(), 2U);
    EXPECT_EQ(report.sequences[0].scores.raw.mse, report.sequences[1].scores.raw.mse);
}

TEST(Evreal, RefusesArraysCutShort) {
    const fs::path folder = fresh_folder("short");
    write_npy<double>(folder / "events_ts.npy", "<f8", "1000000000000,", {1, 2});
    write_npy<std::uint8_t>(folder / "images.npy", "|u1", "1, 28, 36, 1", {0});
    write_npy<double>(folder / "images_ts.npy", "<f8", "1,", {0});
    EXPECT_THROW(read_evreal_sequence(folder, {}, {}), Error);
    write_npy(folder / "images.npy", "|u1", "1, 28, 36, 1", std::vector<std::uint8_t>(28 * 36));
    EXPECT_THROW(read_evreal_sequence(folder, {}, {}), Error);
}

TEST(Evreal, RefusesTimesThatAreNone) {
    const fs::path folder = fresh_folder("no_times");
    write_npy<std::uint8_t>(folder / "images.npy", "|u1", "1, 2, 3", {1, 2, 3, 4, 5, 6});
    write_npy<double>(folder / "images_ts.npy", "<f8", "1,", {0.1});
    write_npy<std::int64_t>(folder / "events_xy.npy", "<i8", "3, 2", {0, 0, 1, 1, 2, 1});
    write_npy<std::int64_t>(folder / "events_p.npy", "<i8", "3,", {0, 1, 0});
    for (const double wrong : {std::nan(""), 1e300, -1e300, HUGE_VAL}) {
        write_npy<double>(folder / "events_ts.npy", "<f8", "3,", {0.0, wrong, 0.2});
        try {
            read_evreal_sequence(folder, {}, {});
            FAIL() << wrong << " was taken";
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("row 1: expected a time"), std::string::npos)
                << error.what();
        }
    }
    // Rows of no numbers at all.
    write_npy<double>(folder / "events_ts.npy", "<f8", "3, 0", {});
    EXPECT_THROW(read_evreal_sequence(folder, {}, {}), Error);
}

/// Three events and three images of 3 x 2 px at these times, as arrays.
fs::path write_arrays(const std::string& name, const std::vector<double>& events_ts,
                      const std::vector<double>& images_ts) {
    const fs::path folder = fresh_folder(name);
    write_npy(folder / "events_ts.npy", "<f8", "3,", events_ts);
    write_npy<std::int64_t>(folder / "events_xy.npy", "<i8", "3, 2", {0, 0, 1, 1, 2, 1});
    write_npy<std::int64_t>(folder / "events_p.npy", "<i8", "3,", {0, 1, 0});
    write_npy(folder / "images_ts.npy", "<f8", "3,", images_ts);
    write_npy(folder / "images.npy", "|u1", "3, 2, 3", std::vector<std::uint8_t>(18));
    return folder;
}

TEST(Evreal, MendsImageTimesOfArraysAsOfRecordings) {
    const auto sequence =
        read_evreal_sequence(write_arrays("disorder", {.1, .2, .3}, {.1, .5, .3}), {}, {});
    std::size_t events = 0;
    for_each_reference_window(sequence, [&](const EventWindow& event_window) {
        EXPECT_LT(event_window.window.begin, event_window.window.end);
        events += event_window.events.size();
    });
    EXPECT_EQ(events, 2U) << "of (.1, .2] and (.2, .3]";
    EXPECT_EQ(sequence.images[1].t, from_us(200'000));
}

TEST(Evreal, NamesEventTimesThatDoNotAscend) {
    const fs::path folder = write_arrays("unsorted", {.1, .3, .2}, {.1, .2, .3});
    try {
        read_evreal_sequence(folder, {}, {});
        FAIL() << "was taken";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("events_ts.npy: row 2: expected a time"),
                  std::string::npos)
            << error.what();
    }
}

TEST(Evreal, NamesArraysThatDoNotBelongTogether) {
    const auto refused = [](const std::string& file, const std::string& shape, std::size_t n) {
        const fs::path folder = write_arrays("apart", {.1, .2, .3}, {.1, .2, .3});
        write_npy(folder / file, "<i8", shape, std::vector<std::int64_t>(n));
        try {
            read_evreal_sequence(folder, {}, {});
            ADD_FAILURE() << file << " of " << shape << " was taken";
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("of as many rows"), std::string::npos)
                << error.what();
        }
    };
    refused("events_xy.npy", "2, 2", 4);
    refused("events_p.npy", "2,", 2);
    refused("events_xy.npy", "3, 3", 9);
    refused("events_p.npy", "3, 2", 6);
}

TEST(Evreal, TakesEventsOfOneTimeInTheirOrder) {
    const auto sequence =
        read_evreal_sequence(write_arrays("together", {.1, .2, .2}, {.1, .2, .3}), {}, .2);
    ASSERT_EQ(sequence.events.size(), 3U) << "the end of the time asked for included";
    EXPECT_EQ(sequence.events[1], (Event{from_us(200'000), 1, 1, Polarity::on}));
    EXPECT_EQ(sequence.events[2], (Event{from_us(200'000), 2, 1, Polarity::off}));
    EXPECT_EQ(sequence.images.size(), 2U);
}

TEST(Evreal, LeavesOutEventsBesideTheSensor) {
    const fs::path folder = write_arrays("beside", {.1, .2, .3}, {.1, .2, .3});
    write_npy<std::int64_t>(folder / "events_xy.npy", "<i8", "3, 2", {3, 0, 2, 1, 0, 2});
    const auto sequence = read_evreal_sequence(folder, {}, {});
    ASSERT_EQ(sequence.events.size(), 1U) << "of 3 x 2 px";
    EXPECT_EQ(sequence.events[0].x, 2);
}

TEST(Evreal, LosesNoEventOfArraysThatAreReadInParts) {
    constexpr std::size_t kEvents = (1 << 20) + 3;
    const fs::path folder = write_arrays("long", {.1, .2, .3}, {.1, .2, .3});
    std::vector<double> ts(kEvents);
    for (std::size_t i = 0; i < kEvents; ++i) ts[i] = 1e-6 * double(i);
    const std::string n = std::to_string(kEvents);
    write_npy(folder / "events_ts.npy", "<f8", n + ",", ts);
    write_npy(folder / "events_xy.npy", "|u1", n + ", 2", std::vector<std::uint8_t>(2 * kEvents));
    write_npy(folder / "events_p.npy", "|u1", n + ",", std::vector<std::uint8_t>(kEvents));
    EXPECT_EQ(read_evreal_sequence(folder, {}, {}).events.size(), kEvents);
}

TEST(Evreal, RefusesSensorsLargerThanAny) {
    const fs::path folder = fresh_folder("large");
    write_npy<double>(folder / "events_ts.npy", "<f8", "0,", {});
    write_npy<double>(folder / "images_ts.npy", "<f8", "0,", {});
    write_npy<std::uint8_t>(folder / "images.npy", "|u1", "0, 65535, 65535", {});
    EXPECT_THROW(read_evreal_sequence(folder, {}, {}), Error);
}

}  // namespace
}  // namespace eventide::test
