// Headers into parsers, and how each format is searched for a time.
#include "replay/stream/stream_formats.h"

#include "src/codec/aedat/aedat1.h"
#include "src/codec/aedat/aedat2.h"
#include "src/codec/aedat/aedat3.h"
#include "src/codec/aedat4/aedat4.h"
#include "src/codec/aedat4/aedat4_table.h"
#include "src/codec/event_stream.h"
#include "src/codec/prophesee/dat.h"
#include "src/codec/prophesee/evt2.h"
#include "src/codec/prophesee/evt3.h"
#include "src/codec/prophesee/evt_header.h"
#include "src/codec/text/text.h"

#include <memory>
#include <string>
#include <vector>

namespace eventide {

namespace {

using Bytes = std::span<const std::byte>;

/// For formats whose stamps wrap: DAT every 72 min, EVT3 every 17 s.
template <typename P>
SeekMeans by_skimming() {
    return {0, [](const Parser& parser) -> std::unique_ptr<Parser> {
                return std::make_unique<P>(static_cast<const P&>(parser));
            }};
}

/// Of AEDAT 3 and 4: images come after the events around them.
constexpr SensorDuration kLatestPacket{500'000};

/// A file without a header is believed to be what the user says.
EvtHeader evt_header(Bytes first_bytes, const OpenOptions& options) {
    const bool is_stated = !options.format.empty() && options.width > 0;
    if (is_stated && !find_evt_header(first_bytes))
        return stated_evt_header(first_bytes, options.format);
    return read_evt_header(first_bytes);
}

/// Which event streams are not read.
std::vector<std::string> other_streams(const Aedat4Header& header) {
    const auto read = header.chosen[std::size_t(Aedat4Kind::events)];
    std::vector<std::string> remarks;
    for (const Aedat4Stream& stream : header.streams)
        if (stream.identifier == identifier_of(Aedat4Kind::events) && stream.id != read)
            remarks.push_back(
                left_out_stream("stream " + std::to_string(stream.id) + " (" + stream.source + ")",
                                "stream " + std::to_string(*read), std::to_string(stream.id)));
    return remarks;
}

}  // namespace

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

OpenedStream open_aedat3(Bytes first_bytes, const OpenOptions& options) {
    const Aedat3Header header = read_aedat3_header(first_bytes, options.stream);
    const auto make_parser = [header](const StreamHeader& stream) {
        return std::make_unique<Aedat3Parser>(header, stream.width, stream.height);
    };
    std::vector<std::string> remarks;
    for (const Aedat3Source& other : header.others)
        remarks.push_back(left_out_stream(
            "source " + std::to_string(other.number) + " (" + other.name + ")",
            "source " + std::to_string(*header.source), std::to_string(other.number)));
    return {header.stream, make_parser, {1, nullptr, {}, kLatestPacket}, remarks};
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

OpenedStream open_evt2(Bytes first_bytes, const OpenOptions& options) {
    const auto make_parser = [](const StreamHeader& stream) {
        return std::make_unique<Evt2Parser>(stream.width, stream.height);
    };
    return {evt_header(first_bytes, options).stream, make_parser, by_skimming<Evt2Parser>()};
}

OpenedStream open_evt21(Bytes first_bytes, const OpenOptions& options) {
    const EvtHeader header = evt_header(first_bytes, options);
    const auto make_parser = [order = Evt21Parser::order_of(header)](const StreamHeader& stream) {
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

}  // namespace eventide
