// AEDAT 1.0: 16-bit addresses of a DVS128 and 32-bit times, big-endian (docs/protocols.md
// D.1).
#pragma once

#include "src/codec/aedat/aedat_parser.h"
#include "src/codec/stream.h"

namespace eventide {

/// What an address of a DVS128 says, in image coordinates.
struct Dvs128Address {
    std::uint16_t x, y;
    bool bit0;
    bool external;  ///< no event but an edge on the external input
};
Dvs128Address read_dvs128_address(std::uint32_t address);

/// The data of DVS128 records, in AEDAT 1 or 2. An edge on the external input becomes a Trigger of
/// kind pulse: the format does not say which edge.
class Dvs128Events {
public:
    /// Events outside `width` x `height` px, where a smaller size was stated, are out_of_range.
    Dvs128Events(bool one_is_on, int width, int height)
        : one_is_on_(one_is_on), width_(width), height_(height) {}
    void take(const AedatRecord& record, std::int64_t t_us, Batch& into, Damage& damage);
    void end_of_file(Batch&, Damage&) {}
    void resync() { last_event_us_.reset(); }

private:
    bool one_is_on_;
    int width_, height_;
    std::optional<std::int64_t> last_event_us_;
};

/// True for a header that says 1.0, or says nothing and is followed by bytes that are no text.
bool looks_like_aedat1(std::span<const std::byte> first_bytes);
StreamHeader read_aedat1_header(std::span<const std::byte> first_bytes);

class Aedat1Parser final : public AedatParser<std::uint16_t, Dvs128Events> {
public:
    /// `one_is_on`: what bit 0 of the address means (see OpenOptions).
    explicit Aedat1Parser(bool one_is_on = false, int width = 128, int height = 128)
        : AedatParser(Dvs128Events(one_is_on, width, height)) {}
};

}  // namespace eventide
