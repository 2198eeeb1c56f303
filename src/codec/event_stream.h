// Event Stream 2 (.es): times as differences (github.com/neuromorphic-paris/event_stream).
#pragma once

#include "src/codec/event_validator.h"
#include "src/codec/parser.h"
#include "src/codec/stream.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace eventide {

struct EventStreamHeader {
    /// Of ATIS streams only the change events are read; exposure measurements are passed over.
    enum class Kind { dvs, atis };
    StreamHeader stream;
    Kind kind = Kind::dvs;
};

/// Whether the bytes begin with "Event Stream".
bool is_event_stream(std::span<const std::byte> first_bytes);

/// Throws Error (input) for other versions, for kinds that hold no change events, and for a header
/// cut short.
EventStreamHeader read_event_stream_header(std::span<const std::byte> first_bytes);

/// Reads what follows the header: an event in five bytes, or a byte that lets time pass. Rows are
/// counted from below in the file. Times begin at 0; there is no word by which a reader that lost
/// its place finds it again.
class EventStreamParser final : public Parser {
public:
    EventStreamParser(EventStreamHeader::Kind kind, int width, int height);

    void parse(std::span<const std::byte> bytes, Batch& into) override;
    void finish(Batch& into) override;
    void resync() override;
    std::optional<SensorTime> clock() const override;
    const Damage& damaged() const override { return damage_; }

private:
    void take_first(unsigned byte);
    void take_event(Batch& into);

    EventStreamHeader::Kind kind_;
    int height_;
    EventValidator validator_;
    Damage damage_;
    std::int64_t t_us_ = 0;
    bool started_ = false;
    std::array<unsigned, 5> bytes_{};
    std::size_t n_ = 0;  ///< of the event in work
};

}  // namespace eventide
