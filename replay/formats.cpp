// The table of formats. To add one: a parser in src/codec, and a row here.
#include "replay/formats.h"

#include "replay/hdf5/hdf5_recording.h"
#include "replay/hdf5/hdf5_writer.h"
#include "replay/numpy/numpy_recording.h"
#include "replay/ros/bag_recording.h"
#include "src/codec/aedat/aedat1.h"
#include "src/codec/aedat/aedat2.h"
#include "src/codec/aedat/aedat3.h"
#include "src/codec/aedat4/aedat4.h"
#include "src/codec/aedat4/aedat4_records.h"
#include "src/codec/aedat4/aedat4_table.h"
#include "src/codec/aedat4/aedat4_writer.h"
#include "src/codec/event_stream.h"
#include "src/codec/prophesee/dat.h"
#include "src/codec/prophesee/evt2.h"
#include "src/codec/prophesee/evt3.h"
#include "src/codec/prophesee/evt_header.h"
#include "src/codec/text/text.h"
#include "src/core/error.h"
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

/// For formats whose stamps wrap: DAT every 72 min, EVT3 every 17 s.
template <typename P>
SeekMeans by_skimming() {
    return {0, [](const Parser& parser) -> std::unique_ptr<Parser> {
                return std::make_unique<P>(static_cast<const P&>(parser));
            }};
}

template <const char* kMagic>
bool has_magic(Bytes first_bytes) {
    return starts_with(first_bytes, kMagic);
}
constexpr char kAedat2Magic[] = "#!AER-DAT2.", kAedat3Magic[] = "#!AER-DAT3.",
               kAedat4FirstLine[] = "#!AER-DAT4.";

OpenedStream open_aedat1(Bytes first_bytes, const OpenOptions& options) {
    const auto make_parser = [one_is_on = options.dvs128_one_is_on](const StreamHeader& stream) {
        return std::make_unique<Aedat1Parser>(one_is_on, stream.width, stream.height);
    };
    return {read_aedat1_header(first_bytes), make_parser, by_skimming<Aedat1Parser>()};
}

OpenedStream open_aedat2(Bytes first_bytes, const OpenOptions& options) {
    const Aedat2Header header = read_aedat2_header(first_bytes, options.width, options.height);
    const auto make_parser = [header,
                              one_is_on = options.dvs128_one_is_on](const StreamHeader& stream) {
        return std::make_unique<Aedat2Parser>(header.sensor, header.stream.width,
                                              header.stream.height, one_is_on, stream.width,
                                              stream.height);
    };
    return {header.stream, make_parser, by_skimming<Aedat2Parser>()};
}

/// Of AEDAT 3 and 4: images come after the events around them.
constexpr SensorDuration kLatestPacket{500'000};

OpenedStream open_aedat3(Bytes first_bytes, const OpenOptions& options) {
    const Aedat3Header header = read_aedat3_header(first_bytes, options.stream);
    const auto make_parser = [header](const StreamHeader& stream) {
        return std::make_unique<Aedat3Parser>(header, stream.width, stream.height);
    };
    std::vector<std::string> remarks;
    for (const Aedat3Source& other : header.others)
        remarks.push_back("the events of source " + std::to_string(other.number) + " (" +
                          other.name + ") are left out, those of source " +
                          std::to_string(*header.source) + " are read; " +
                          reads_stream(std::to_string(other.number)));
    return {header.stream, make_parser, {1, nullptr, {}, kLatestPacket}, remarks};
}

/// Which event streams are not read.
std::vector<std::string> other_streams(const Aedat4Header& header) {
    const auto read = header.chosen[std::size_t(Aedat4Kind::events)];
    std::vector<std::string> remarks;
    for (const Aedat4Stream& stream : header.streams)
        if (stream.identifier == identifier_of(Aedat4Kind::events) && stream.id != read)
            remarks.push_back("the events of stream " + std::to_string(stream.id) + " (" +
                              stream.source + ") are left out, those of stream " +
                              std::to_string(*read) + " are read; " +
                              reads_stream(std::to_string(stream.id)));
    return remarks;
}

OpenedStream open_aedat4(Bytes first_bytes, const OpenOptions& options) {
    const Aedat4Header header = read_aedat4_header(first_bytes, options.stream);
    const auto make_parser = [header](const StreamHeader& stream) {
        return std::make_unique<Aedat4Parser>(header, stream.width, stream.height);
    };
    const auto look_up = [header](const ByteFile& file, SensorTime t) {
        const auto read_at = [&](std::uint64_t position, std::span<std::byte> into) {
            return file.read_at(position, into);
        };
        return find_in_aedat4_table(header, read_at, t);
    };
    return {
        header.stream, make_parser, {1, nullptr, look_up, kLatestPacket}, other_streams(header)};
}

template <const char* kName>
bool is_evt(Bytes first_bytes) {
    const auto header = find_evt_header(first_bytes);
    return header && header->stream.format == kName;
}
constexpr char kEvt2[] = "evt2", kEvt21[] = "evt21", kEvt3[] = "evt3";

/// A file without a header is believed to be what the user says.
EvtHeader evt_header(Bytes first_bytes, const OpenOptions& options) {
    const bool is_stated = !options.format.empty() && options.width > 0;
    if (is_stated && !find_evt_header(first_bytes))
        return stated_evt_header(first_bytes, options.format);
    return read_evt_header(first_bytes);
}

OpenedStream open_evt2(Bytes first_bytes, const OpenOptions& options) {
    const auto make_parser = [](const StreamHeader& stream) {
        return std::make_unique<Evt2Parser>(stream.width, stream.height);
    };
    return {evt_header(first_bytes, options).stream, make_parser, by_skimming<Evt2Parser>()};
}

OpenedStream open_evt21(Bytes first_bytes, const OpenOptions& options) {
    using Order = Evt21Parser::Order;
    const EvtHeader header = evt_header(first_bytes, options);
    const Order order = header.halves_swapped ? Order::upper_half_first : Order::lower_half_first;
    const auto make_parser = [order](const StreamHeader& stream) {
        return std::make_unique<Evt21Parser>(stream.width, stream.height, order);
    };
    return {header.stream, make_parser, by_skimming<Evt21Parser>()};
}

OpenedStream open_evt3(Bytes first_bytes, const OpenOptions& options) {
    const EvtHeader header = evt_header(first_bytes, options);
    const auto make_parser = [base_us = header.time_base_us](const StreamHeader& stream) {
        return std::make_unique<Evt3Parser>(stream.width, stream.height, base_us);
    };
    return {header.stream, make_parser, by_skimming<Evt3Parser>()};
}

bool is_dat(Bytes first_bytes) {
    return find_dat_header(first_bytes).has_value();
}

OpenedStream open_dat(Bytes first_bytes, const OpenOptions&) {
    const DatHeader header = read_dat_header(first_bytes);
    const auto make_parser = [record = header.record](const StreamHeader& stream) {
        return std::make_unique<DatParser>(record, stream.width, stream.height);
    };
    return {header.stream, make_parser, by_skimming<DatParser>()};
}

OpenedStream open_event_stream(Bytes first_bytes, const OpenOptions&) {
    const EventStreamHeader header = read_event_stream_header(first_bytes);
    const auto make_parser = [kind = header.kind](const StreamHeader& stream) {
        return std::make_unique<EventStreamParser>(kind, stream.width, stream.height);
    };
    return {header.stream, make_parser, by_skimming<EventStreamParser>()};
}

OpenedStream open_text(Bytes first_bytes, const OpenOptions& options) {
    const TextHeader header = read_text_header(first_bytes, options.text);
    const auto make_parser = [layout = header.layout,
                              reorder = options.text.reorder](const StreamHeader& stream) {
        return std::make_unique<TextParser>(layout, stream.width, stream.height, reorder);
    };
    return {header.stream, make_parser, {1, nullptr, {}, options.text.reorder}, header.remarks};
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
    .streams = true};
constexpr FormatHolds with_streams(FormatHolds holds) {
    holds.streams = true;
    return holds;
}
constexpr FormatHolds kEvt3Holds{true, false, false, true, evt3_holds, true};

// Formats that say what they are come first, text last.
const std::array kFormats{
    Format{"aedat4", "AEDAT 4", ".aedat4", kAedat4Holds, has_magic<kAedat4FirstLine>, open_aedat4,
           make<Aedat4Writer>},
    Format{"aedat3", "AEDAT 3.1", ".aedat", with_streams(kEverything), has_magic<kAedat3Magic>,
           open_aedat3, make<Aedat3Writer>},
    Format{"aedat2", "AEDAT 2.0", ".aedat2", kEverything, has_magic<kAedat2Magic>, open_aedat2,
           nullptr},
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
    Format{"aedat1", "AEDAT 1.0", ".dat", kOnlyEvents, looks_like_aedat1, open_aedat1, nullptr},
    Format{"text", "lines of \"t x y p\"", ".txt", kOnlyEvents, looks_like_text, open_text,
           make<TextWriter>},
};

/// What `member` says of each format that is written: "aedat4, evt3, ...".
std::string list_of_writable(std::string_view Format::*member) {
    std::string list;
    for (const Format& format : kFormats)
        if (format.is_written()) list += (list.empty() ? "" : ", ") + std::string{format.*member};
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
        if (n > 0) text += (text.empty() ? "" : ", ") + counted(n, what);
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
    const auto found = std::find_if(kFormats.begin(), kFormats.end(), [&](const Format& format) {
        return format.is_written() && path.ends_with(format.extension);
    });
    return found == kFormats.end() ? nullptr : &*found;
}

std::unique_ptr<StreamWriter> open_writer(std::string_view name) {
    const Format* format = find_format(name);
    if (!format || !format->make_writer) {
        std::string writable;
        for (const Format& each : kFormats)
            if (each.make_writer)
                writable += (writable.empty() ? "" : ", ") + std::string(each.name);
        throw Error(ErrorKind::usage, "format to write: expected one of " + writable +
                                          ", found \"" + std::string(name) + "\"");
    }
    return format->make_writer();
}

}  // namespace eventide
