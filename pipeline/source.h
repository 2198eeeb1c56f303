// Where bytes come from.
#pragma once

#include "src/codec/parser.h"
#include "src/core/packet.h"

#include <eventide/event.h>

#include <cstddef>
#include <memory>
#include <optional>

namespace eventide {

enum class ReadStatus {
    data,     ///< `into` holds bytes
    timeout,  ///< live sources only: nothing came for a while (at most 20 ms); `into.bytes` is
              ///< empty
    end       ///< nothing will come any more
};

/// Where bytes come from: a camera or a recording. The pipeline owns the thread.
class Source {
public:
    virtual ~Source() = default;
    virtual const SensorInfo& info() const = 0;
    virtual bool is_live() const noexcept = 0;  ///< a live source may not be made to wait

    /// Source thread. Fills `into.bytes` (whose capacity is reused) and `into.arrived`; live
    /// sources may set `into.gap_before`. Throws Error of kind device when a camera is lost, of
    /// kind input when a file cannot be read.
    virtual ReadStatus read(RawPacket& into) = 0;

    /// What one packet holds at most; 0: any number of bytes.
    virtual std::size_t packet_bytes() const { return 0; }

    virtual void stop() noexcept = 0;  ///< any thread; a waiting read() returns end soon
    virtual std::unique_ptr<Parser> make_parser() const = 0;
};

/// What a parser is told of each packet of its source, so that whoever parses them tells the same
/// times. Appends what the bytes complete; an empty packet tells of a gap at most.
inline void parse_packet(const RawPacket& packet, bool is_live, Parser& parser, Batch& into) {
    if (packet.gap_before) packet.reopened ? parser.reopened() : parser.resync();
    if (packet.bytes.empty()) return;
    if (is_live) parser.arrives(packet.arrived);
    parser.parse(packet.bytes, into);
}

}  // namespace eventide
