// NumPy's files as recordings, in the layouts that people save events in.
#include "replay/formats.h"
#include "replay/summary.h"
#include "src/core/error.h"
#include "tests/io/npz_writer.h"
#include "tests/replay/recording_files.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace eventide {
namespace {

using testing::AllOf;
using testing::HasSubstr;

template <typename T>
std::string raw(T value) {
    return {reinterpret_cast<const char*>(&value), sizeof value};
}

/// As numpy.save writes it.
std::string npy(const std::string& descr, const std::string& shape, const std::string& data,
                bool fortran = false) {
    std::string header = "{'descr': " + descr +
                         ", 'fortran_order': " + (fortran ? "True" : "False") + ", 'shape': (" +
                         shape + "), }";
    header.resize((header.size() + 10 + 64) / 64 * 64 - 11, ' ');
    header += '\n';
    return std::string("\x93NUMPY\x01\0", 8) + raw(std::uint16_t(header.size())) + header + data;
}

std::string column(const std::vector<Event>& events, const std::string& descr,
                   const std::function<std::string(const Event&)>& value) {
    std::string data;
    for (const Event& event : events) data += value(event);
    return npy("'" + descr + "'", std::to_string(events.size()) + ",", data);
}

std::string records(const std::vector<Event>& events) {
    std::string data;
    for (const Event& event : events)
        data += raw(to_us(event.t)) + raw(event.x) + raw(event.y) + raw(event.polarity);
    return npy("[('t', '<i8'), ('x', '<u2'), ('y', '<u2'), ('p', '|b1')]",
               std::to_string(events.size()) + ",", data);
}

/// Rows of four in this order, in seconds where `seconds`.
std::string matrix(const std::vector<Event>& events, const std::string& order, bool seconds,
                   bool fortran = false) {
    const auto value = [&](const Event& event, char field) {
        if (field == 't') return double(to_us(event.t)) / (seconds ? 1e6 : 1);
        return field == 'x' ? event.x : field == 'y' ? event.y : double(event.polarity);
    };
    std::string data;
    if (fortran)
        for (const char field : order)
            for (const Event& event : events) data += raw(value(event, field));
    else
        for (const Event& event : events)
            for (const char field : order) data += raw(value(event, field));
    return npy("'<f8'", std::to_string(events.size()) + ", 4", data, fortran);
}

std::string npz(const std::vector<std::pair<std::string, std::string>>& arrays, bool deflated) {
    NpzWriter writer;
    for (const auto& [name, bytes] : arrays) writer.add_bytes(name, bytes, deflated);
    return writer.bytes();
}

std::string columns(const std::vector<Event>& events, bool deflated, bool seconds) {
    return npz(
        {{"other", npy("'<U5'", "", std::string(20, 'x'))},
         {"x", column(events, "<u2", [](const Event& e) { return raw(e.x); })},
         {"y", column(events, "<i2", [](const Event& e) { return raw(e.y); })},
         {seconds ? "ts" : "timestamp_us",
          seconds
              ? column(events, "<f8", [](const Event& e) { return raw(double(to_us(e.t)) / 1e6); })
              : column(events, "<i8", [](const Event& e) { return raw(to_us(e.t)); })},
         {"polarity", column(events, "|i1",
                             [](const Event& e) {
                                 return raw(std::int8_t(e.polarity == Polarity::on ? 1 : -1));
                             })}},
        deflated);
}

struct Layout {
    const char* name;
    std::string (*bytes)(const std::vector<Event>&);
    const char* format;
};

class NumpyLayouts : public testing::TestWithParam<Layout> {
protected:
    const TestFolder folder_;
    const std::vector<Event> events_ = some_events(30'000, 2'500'000, 20, 240, 180);
    std::unique_ptr<Recording> open() const {
        return open_recording(folder_.write("a.np", GetParam().bytes(events_)));
    }
};

using Events = std::vector<Event>;
INSTANTIATE_TEST_SUITE_P(
    All, NumpyLayouts,
    testing::Values(
        Layout{"records", [](const Events& e) { return records(e); }, "npy"},
        Layout{"txyp_us", [](const Events& e) { return matrix(e, "txyp", false); }, "npy"},
        Layout{"txyp_s", [](const Events& e) { return matrix(e, "txyp", true); }, "npy"},
        Layout{"xytp_us", [](const Events& e) { return matrix(e, "xytp", false); }, "npy"},
        Layout{"xypt_s", [](const Events& e) { return matrix(e, "xypt", true); }, "npy"},
        Layout{"fortran", [](const Events& e) { return matrix(e, "txyp", true, true); }, "npy"},
        Layout{"columns_us", [](const Events& e) { return columns(e, false, false); }, "npz"},
        Layout{"columns_s", [](const Events& e) { return columns(e, false, true); }, "npz"},
        Layout{"columns_packed", [](const Events& e) { return columns(e, true, true); }, "npz"},
        Layout{"records_packed",
               [](const Events& e) {
                   return npz({{"events", records(e)}}, true);
               },
               "npz"},
        Layout{"matrix_packed",
               [](const Events& e) {
                   return npz({{"arr_0", matrix(e, "txyp", false)}}, true);
               },
               "npz"}),
    [](const auto& each) { return std::string(each.param.name); });

TEST_P(NumpyLayouts, GiveTheEventsThatWereWritten) {
    const auto recording = open();
    EXPECT_EQ(recording->info().format, GetParam().format);
    EXPECT_EQ(recording->info().width, 240);
    EXPECT_EQ(recording->info().height, 180);
    EXPECT_TRUE(read_everything(*recording).events == events_);
    EXPECT_EQ(recording->position_bytes(), recording->size_bytes());
}

TEST_P(NumpyLayouts, SeekThenReadIsReadThenSkip) {
    const auto recording = open();
    for (const std::size_t i : {std::size_t{25'000}, std::size_t{0}, std::size_t{9'999}}) {
        recording->seek(events_[i].t);
        EXPECT_GE(recording->position_bytes() + 1'000, recording->size_bytes() * i / 30'001);
        std::vector<Event> found = read_everything(*recording).events, expected = events_;
        const auto early = [&](const Event& event) { return event.t < events_[i].t; };
        std::erase_if(found, early);
        std::erase_if(expected, early);
        EXPECT_TRUE(found == expected) << i;
    }
}

TEST(Numpy, ARowWithoutATimeHidesNothingFromASeek) {
    const TestFolder folder;
    const auto events = some_events(30'000, 2'500'000, 20, 240, 180);
    const auto seconds = [&](const Event& event) {
        const bool in_the_middle = &event == &events[15'000] || &event == &events[7'500];
        return raw(in_the_middle ? std::nan("") : double(to_us(event.t)) / 1e6);
    };
    const auto recording = open_recording(folder.write(
        "a.npz", npz({{"t", column(events, "<f8", seconds)},
                      {"x", column(events, "<u2", [](const Event& e) { return raw(e.x); })},
                      {"y", column(events, "<u2", [](const Event& e) { return raw(e.y); })},
                      {"p", column(events, "|u1", [](const Event& e) { return raw(e.polarity); })}},
                     false)));
    recording->seek(events[5'000].t);
    std::vector<Event> found = read_everything(*recording).events;
    std::erase_if(found, [&](const Event& event) { return event.t < events[5'000].t; });
    EXPECT_GE(found.size(), 30'000U - 5'000U - 2U);
}

TEST(Numpy, TheSmallestIntegerIsNoTime) {
    const TestFolder folder;
    for (const auto unit :
         {TextTimeUnit::seconds, TextTimeUnit::milliseconds, TextTimeUnit::microseconds}) {
        std::vector<Event> events = some_events(500, 2'500'000, 20, 240, 180);
        for (std::size_t i = 1; i < events.size(); ++i) events[i].t = from_us(std::int64_t(i));
        events[0].t = SensorTime::min();
        OpenOptions options;
        options.text.unit = unit;
        options.width = 240;
        options.height = 180;
        const Summary sum =
            summarize(*open_recording(folder.write("a.npy", records(events)), options));
        EXPECT_EQ(sum.events, 499U) << int(unit);
        EXPECT_EQ(sum.damaged[DamageReason::bad_record], 1U) << int(unit);
    }
}

TEST(Numpy, MetavisionsRecordsAreOfMicrosecondsHoweverFewTheyAre) {
    const TestFolder folder;
    std::vector<Event> events = some_events(500, 2'500'000, 20, 240, 180);
    for (std::size_t i = 0; i < events.size(); ++i) events[i].t = from_us(std::int64_t(i) * 20'000);
    std::string data;
    for (const Event& e : events)
        data += raw(e.x) + raw(e.y) + raw(std::int16_t(e.polarity)) + raw(to_us(e.t));
    const auto recording = open_recording(folder.write(
        "a.npy", npy("[('x', '<u2'), ('y', '<u2'), ('p', '<i2'), ('t', '<i8')]", "500,", data)));
    EXPECT_TRUE(read_everything(*recording).events == events);
}

std::string refusal(const std::string& path, ErrorKind kind = ErrorKind::input,
                    const OpenOptions& options = {}) {
    try {
        read_everything(*open_recording(path, options));
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), kind) << error.what();
        return error.what();
    }
    return "nothing was refused";
}

TEST(Numpy, ColumnsAndUnitsCanBeStated) {
    const TestFolder folder;
    const auto events = some_events(5'000, 2'500'000, 20, 100, 100);
    OpenOptions options;
    options.text.columns = "pyxt";
    options.text.unit = TextTimeUnit::seconds;
    const auto recording =
        open_recording(folder.write("a.npy", matrix(events, "pyxt", true)), options);
    EXPECT_TRUE(read_everything(*recording).events == events);
    options.text.columns = "txy";
    EXPECT_THAT(refusal(folder.path("a.npy"), ErrorKind::usage, options), HasSubstr("\"txy\""));
}

TEST(Numpy, WhatIsNoTableOfEventsIsRefusedWithWhatItIs) {
    const TestFolder folder;
    EXPECT_THAT(refusal(folder.write("a.npy", npy("'<f4'", "3, 5", std::string(60, 'x')))),
                AllOf(HasSubstr("a.npy"), HasSubstr("numbers of shape (3, 5)")));
    EXPECT_THAT(refusal(folder.write("b.npy", npy("'>f4'", "3, 4", std::string(48, 'x')))),
                HasSubstr("'>f4'"));
    EXPECT_THAT(
        refusal(folder.write("c.npz", npz({{"images", npy("'|u1'", "2, 3", "abcdef")}}, false))),
        HasSubstr("found images (2, 3)"));
    const auto events = some_events(100);
    std::string fewer =
        npz({{"t", column(events, "<i8", [](const Event& e) { return raw(to_us(e.t)); })},
             {"x", column({events.begin(), events.end() - 1}, "<u2",
                          [](const Event& e) { return raw(e.x); })}},
            false);
    EXPECT_THAT(refusal(folder.write("d.npz", fewer)), HasSubstr("as many numbers as t, 100"));
}

TEST(Numpy, EventsInNoOrderOfTimeAreRefusedAtOnce) {
    const TestFolder folder;
    std::vector<Event> events = some_events(5'000, 2'500'000, 20, 240, 180);
    std::ranges::shuffle(events, std::mt19937{7});
    for (const std::string& file : {folder.write("a.npy", records(events)),
                                    folder.write("a.npz", columns(events, true, true)),
                                    folder.write("b.npy", matrix(events, "txyp", false))})
        EXPECT_THAT(refusal(file), AllOf(HasSubstr(file + ": expected events in order of time"),
                                         HasSubstr(" of the first 5000 "), HasSubstr("sort")));
    // Less than half of them late: as much as there is to read is read, and what is not is counted.
    std::ranges::sort(events, {}, &Event::t);
    for (std::size_t i = 0; i + 1 < events.size(); i += 3) std::swap(events[i], events[i + 1]);
    const auto recording = open_recording(folder.write("c.npy", records(events)));
    EXPECT_GT(read_everything(*recording).events.size(), 3'000U);
}

TEST(Numpy, AnArchiveWithATextRecordingSaysHowToReadIt) {
    const TestFolder folder;
    // As the data of rpg_e2vid come.
    std::string archive = npz({{"events", "240 180\n0.1 1 2 1\n"}}, true);
    for (auto at = archive.find(".npy"); at != archive.npos; at = archive.find(".npy"))
        archive.replace(at, 4, ".txt");
    EXPECT_THAT(refusal(folder.write("events.zip", archive)),
                AllOf(HasSubstr("found events.txt"),
                      HasSubstr("unzip -p FILE events.txt | eventide run - reads it")));
}

TEST(Numpy, AFileThatIsCutGivesItsWholeRows) {
    const TestFolder folder;
    std::vector<Event> events = some_events(20'000, 2'500'000, 20, 240, 180);
    for (const std::string& whole : {records(events), matrix(events, "txyp", false)}) {
        const auto path = folder.write("a.npy", whole.substr(0, whole.size() - 7));
        EXPECT_TRUE(read_everything(*open_recording(path)).events ==
                    std::vector<Event>(events.begin(), events.end() - 1));
        const Summary sum = summarize(*open_recording(path));
        EXPECT_EQ(sum.damaged[DamageReason::truncated], 1U);
        EXPECT_EQ(sum.damaged.total(), 1U);
    }
    const std::string columns_first = matrix(events, "txyp", false, true);
    EXPECT_THAT(refusal(folder.write("b.npy", columns_first.substr(0, columns_first.size() - 7))),
                HasSubstr("do not hold"));
}

TEST(Numpy, HeadersThatPromiseMoreThanThereIsAreRefused) {
    const TestFolder folder;
    EXPECT_THAT(refusal(folder.write("a.npy", npy("'<f8'", "100000000000, 4", "few"))),
                HasSubstr("do not hold"));
    const std::string whole = columns(some_events(1'000), true, false);
    EXPECT_THAT(refusal(folder.write("b.npz", whole.substr(0, whole.size() / 2))),
                HasSubstr("no directory"));
    // Of what deflates well, an archive may say any size.
    std::string zeros = npz({{"t", npy("'<i8'", "1000000000000,", "")},
                             {"x", npy("'<i8'", "1000000000000,", "")},
                             {"y", npy("'<i8'", "1000000000000,", "")},
                             {"p", npy("'<i8'", "1000000000000,", "")}},
                            true);
    EXPECT_THAT(refusal(folder.write("c.npz", zeros)), HasSubstr("no arrays"));
}

TEST(Numpy, APackedArrayThatBreaksCostsWhatFollows) {
    const TestFolder folder;
    const auto events = some_events(100'000, 0, 20, 128, 128);
    std::string bytes = columns(events, true, false);
    bytes[bytes.size() / 2] ^= char(0x7F);
    OpenOptions options;
    options.width = options.height = 128;
    const Summary sum = summarize(*open_recording(folder.write("a.npz", bytes), options));
    EXPECT_LT(sum.events, events.size());
    EXPECT_GT(sum.damaged.total(), 0U);
}

}  // namespace
}  // namespace eventide
