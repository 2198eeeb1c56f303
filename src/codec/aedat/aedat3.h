// AEDAT 3.1 (and 3.0): packets of polarity events, frames, IMU samples and special events,
// little-endian (docs/protocols.md D.2).
#pragma once

#include "src/codec/aedat/aedat3_content.h"
#include "src/codec/aedat/aedat3_packet.h"
#include "src/codec/parser.h"
#include "src/codec/stream.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace eventide {

struct Aedat3Source {
    int number = 0;
    std::string name;  ///< "DAVIS346"
};

struct Aedat3Header {
    StreamHeader stream;                 ///< width and height where the source's name tells them
    bool lower_left = false;             ///< AEDAT 3.0: the origin is at the lower left
    std::optional<int> source;           ///< number of the source that is read
    std::vector<Aedat3Source> others{};  ///< the other sources that it names
};

/// `source`: the number of the one to be read; empty: the first that is named. Throws Error: input
/// when it is no RAW AEDAT 3 file, usage where no such source is named.
Aedat3Header read_aedat3_header(std::span<const std::byte> first_bytes,
                                std::string_view source = {});

/// Reads the packets of one source: those of others that the header names are passed over, and of
/// any other count as unknown_word. Events that a timestamp reset, or another file joined to the
/// first, sets back in time begin a new stream. Packets of types beyond IMU9 are passed over.
class Aedat3Parser final : public Parser {
public:
    /// Size in px; of a sensor that the header says to be larger, its upper left part.
    Aedat3Parser(const Aedat3Header& header, int width, int height);

    void parse(std::span<const std::byte> bytes, Batch& into) override;
    void finish(Batch& into) override;
    void resync() override;
    std::optional<SensorTime> clock() const override;
    const Damage& damaged() const override { return content_.damage(); }

private:
    enum class State { header, searching, records, passing_over };

    std::span<const std::byte> search_header(std::span<const std::byte> bytes);
    std::span<const std::byte> read_header(std::span<const std::byte> bytes);
    void begin_packet(const Aedat3Packet& packet);
    std::span<const std::byte> read_records(std::span<const std::byte> bytes, Batch& into);
    std::span<const std::byte> pass_over(std::span<const std::byte> bytes);

    std::optional<int> source_;
    std::vector<Aedat3Source> others_;
    Aedat3Content content_;

    State state_ = State::header;
    std::vector<std::byte> unit_;  ///< the beginning of a header or record whose end has not come
    Aedat3Packet packet_;          ///< whose records are being read
    std::uint64_t left_ = 0;       ///< records of it to come; in passing_over: bytes
};

/// Writes AEDAT 3.1: packets of at most kPacketRecords, colour frames as RGB, IMU samples with a
/// magnetometer's values as IMU9, triggers as special events. A line "#Geometry: WxH", which other
/// readers pass over, keeps the size. Throws Error (usage) for times below zero and coordinates
/// above 32767. An image that does not say its colour filter has that of the header.
class Aedat3Writer final : public StreamWriter {
public:
    static constexpr std::size_t kPacketRecords = 4096;

    void begin(const StreamHeader& header, std::vector<std::byte>& out) override;
    void write(const Batch& batch, std::vector<std::byte>& out) override;
    void finish(std::vector<std::byte>&) override {}

private:
    ColourFilter colours_ = ColourFilter::none;
};

}  // namespace eventide
