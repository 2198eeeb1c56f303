// The table of formats. To add one: a parser in src/codec, how it is opened in
// stream/stream_formats.cpp, and a row here.
#include "replay/formats.h"

#include "replay/hdf5/hdf5_recording.h"
#include "replay/hdf5/hdf5_writer.h"
#include "replay/numpy/numpy_recording.h"
#include "replay/ros/bag_recording.h"
#include "replay/stream/stream_formats.h"
#include "src/codec/aedat/aedat1.h"
#include "src/codec/aedat/aedat3.h"
#include "src/codec/aedat4/aedat4_records.h"
#include "src/codec/aedat4/aedat4_writer.h"
#include "src/codec/event_stream.h"
#include "src/codec/prophesee/dat.h"
#include "src/codec/prophesee/evt3.h"
#include "src/codec/prophesee/evt_header.h"
#include "src/codec/text/text.h"
#include "src/core/error.h"
#include "src/core/list_text.h"
#include "src/core/lower_case.h"
#include "src/core/number_text.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

namespace eventide {

namespace {

using Bytes = std::span<const std::byte>;

template <typename Writer>
std::unique_ptr<StreamWriter> make() {
    return std::make_unique<Writer>();
}

bool starts_with(Bytes bytes, std::string_view magic) {
    return bytes.size() >= magic.size() &&
           std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

template <const char* kMagic>
bool has_magic(Bytes first_bytes) {
    return starts_with(first_bytes, kMagic);
}
constexpr char kAedat2Magic[] = "#!AER-DAT2.", kAedat3Magic[] = "#!AER-DAT3.",
               kAedat4FirstLine[] = "#!AER-DAT4.";

template <const char* kName>
bool is_evt(Bytes first_bytes) {
    const auto header = find_evt_header(first_bytes);
    return header && header->stream.format == kName;
}
constexpr char kEvt2[] = "evt2", kEvt21[] = "evt21", kEvt3[] = "evt3";

bool is_dat(Bytes first_bytes) {
    return find_dat_header(first_bytes).has_value();
}

constexpr char kHdf5Magic[] = "\x89HDF\r\n\x1A\n", kBagMagic[] = "#ROSBAG V2.0",
               kNpyMagic[] = "\x93NUMPY", kNpzMagic[] = "PK\x03\x04",
               kMcapMagic[] = "\x89MCAP0\r\n", kSqliteMagic[] = "SQLite format 3";

constexpr FormatHolds kOnlyEvents{};
constexpr FormatHolds kEventsAndImages{true, true};
constexpr FormatHolds kEventsAndTriggers{true, false, false, true};
constexpr FormatHolds kEverything{
    .events = true, .images = true, .imu = true, .triggers = true, .clock_resets = true};
constexpr FormatHolds kAedat4Holds{
    .events = true,
    .images = true,
    .imu = true,
    .triggers = true,
    .trigger = [](const Trigger& t) { return aedat4_trigger_number(t) >= 0; },
    .clock_resets = true,
    .streams = true,
    .colour_filter = true};
constexpr FormatHolds kAedat3Holds{.events = true,
                                   .images = true,
                                   .imu = true,
                                   .triggers = true,
                                   .clock_resets = true,
                                   .streams = true,
                                   .colour_filter = true,
                                   .colour_filter_of_each = true};
constexpr FormatHolds with_streams(FormatHolds holds) {
    holds.streams = true;
    return holds;
}
constexpr FormatHolds kEvt3Holds{true, false, false, true, evt3_holds, true};

/// Where no line says which camera it was, its addresses do.
constexpr std::size_t kAedat2LooksAt = 4096;
/// Where no line says what it is, bytes that are no text do.
constexpr std::size_t kAedat1LooksAt = 64;

// Formats that say what they are come first, text last.
const std::array kFormats{
    Format{"aedat4", "AEDAT 4", ".aedat4", kAedat4Holds, has_magic<kAedat4FirstLine>, open_aedat4,
           make<Aedat4Writer>},
    Format{"aedat3", "AEDAT 3.1", ".aedat", kAedat3Holds, has_magic<kAedat3Magic>, open_aedat3,
           make<Aedat3Writer>},
    Format{"aedat2", "AEDAT 2.0", ".aedat2", kEverything, has_magic<kAedat2Magic>, open_aedat2,
           nullptr, nullptr, nullptr, kAedat2LooksAt},
    Format{"evt3", "Prophesee RAW EVT3", ".raw", kEvt3Holds, is_evt<kEvt3>, open_evt3,
           make<Evt3Writer>},
    Format{"evt2", "Prophesee RAW EVT2", ".raw", kEventsAndTriggers, is_evt<kEvt2>, open_evt2,
           nullptr},
    Format{"evt21", "Prophesee RAW EVT2.1", ".raw", kEventsAndTriggers, is_evt<kEvt21>, open_evt21,
           nullptr},
    Format{"hdf5", "HDF5", ".h5", with_streams(kEventsAndImages), has_magic<kHdf5Magic>, nullptr,
           nullptr, open_hdf5, make_hdf5_writer},
    Format{"es", "Event Stream", ".es", kOnlyEvents, is_event_stream, open_event_stream, nullptr},
    Format{"npy", "NumPy array", ".npy", kOnlyEvents, has_magic<kNpyMagic>, nullptr, nullptr,
           open_npy},
    Format{"npz", "NumPy arrays", ".npz", kOnlyEvents, has_magic<kNpzMagic>, nullptr, nullptr,
           open_npz},
    Format{"rosbag", "ROS 1 bag", ".bag", with_streams(kEverything), has_magic<kBagMagic>, nullptr,
           nullptr, open_bag},
    Format{"mcap", "ROS 2 bag (MCAP)", ".mcap", with_streams(kEverything), has_magic<kMcapMagic>,
           nullptr, nullptr, open_mcap},
    Format{"db3", "ROS 2 bag (SQLite)", ".db3", with_streams(kEverything), has_magic<kSqliteMagic>,
           nullptr, nullptr, open_db3},
    Format{"dat", "Prophesee DAT", ".dat", kEventsAndTriggers, is_dat, open_dat, nullptr},
    Format{"aedat1", "AEDAT 1.0", ".dat", kOnlyEvents, looks_like_aedat1, open_aedat1, nullptr,
           nullptr, nullptr, kAedat1LooksAt},
    Format{"text", "lines of \"t x y p\"", ".txt", kOnlyEvents, looks_like_text, open_text,
           make<TextWriter>},
};

/// What `member` says of each format that is written: "aedat4, evt3, ...".
std::string list_of_writable(std::string_view Format::*member) {
    std::string list;
    for (const Format& format : kFormats)
        if (format.is_written()) add_to_list(list, format.*member);
    return list;
}

template <typename T>
std::uint64_t remove_unless(std::vector<T>& items, bool held) {
    const std::uint64_t n = held ? 0 : items.size();
    if (!held) items.clear();
    return n;
}

}  // namespace

DataCounts& DataCounts::operator+=(const DataCounts& more) {
    events += more.events;
    images += more.images;
    imu += more.imu;
    triggers += more.triggers;
    return *this;
}

std::string text_of(const DataCounts& counts) {
    std::string text;
    const auto add = [&text](std::uint64_t n, const char* what) {
        if (n > 0) add_to_list(text, counted(n, what));
    };
    add(counts.events, "event");
    add(counts.images, "image");
    add(counts.imu, "IMU sample");
    add(counts.triggers, "trigger");
    return text.empty() ? "0 events" : text;
}

DataCounts remove_not_held(Batch& batch, const FormatHolds& holds) {
    DataCounts removed;
    removed.events = remove_unless(batch.events, holds.events);
    removed.images = remove_unless(batch.images, holds.images);
    removed.imu = remove_unless(batch.imu, holds.imu);
    removed.triggers = remove_unless(batch.triggers, holds.triggers);
    if (holds.trigger)
        removed.triggers +=
            std::erase_if(batch.triggers, [&](const Trigger& t) { return !holds.trigger(t); });
    return removed;
}

std::span<const Format> all_formats() {
    return kFormats;
}

std::string names_of_writable() {
    return list_of_writable(&Format::name);
}

std::string extensions_of_writable() {
    return list_of_writable(&Format::extension);
}

const Format* find_format(std::string_view name) {
    const auto found = std::find_if(kFormats.begin(), kFormats.end(),
                                    [&](const Format& format) { return format.name == name; });
    return found == kFormats.end() ? nullptr : &*found;
}

const Format* detect_format(Bytes first_bytes) {
    const auto found = std::find_if(kFormats.begin(), kFormats.end(), [&](const Format& format) {
        return format.matches(first_bytes);
    });
    return found == kFormats.end() ? nullptr : &*found;
}

const Format* format_for_writing(const std::string& path) {
    const std::string name = lower_case(path);
    const auto found = std::find_if(kFormats.begin(), kFormats.end(), [&](const Format& format) {
        return format.is_written() && name.ends_with(format.extension);
    });
    return found == kFormats.end() ? nullptr : &*found;
}

std::unique_ptr<StreamWriter> open_writer(std::string_view name) {
    const Format* format = find_format(name);
    if (!format || !format->make_writer) {
        std::string writable;
        for (const Format& each : kFormats)
            if (each.make_writer) add_to_list(writable, each.name);
        throw Error(ErrorKind::usage, "format to write: expected one of " + writable +
                                          ", found \"" + std::string(name) + "\"");
    }
    return format->make_writer();
}

}  // namespace eventide
