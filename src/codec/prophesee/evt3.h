// EVT3: 16-bit words; row, column, vectors of columns and time in words of their own
// (docs/protocols.md D.4).
#pragma once

#include "src/codec/prophesee/evt_parser.h"
#include "src/codec/stream.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace eventide {

/// Times have 24 bits.
class Evt3Parser final : public EvtWordParser<EvtParser, 2> {
public:
    explicit Evt3Parser(int width = 0, int height = 0, std::int64_t time_base_us = 0)
        : EvtWordParser({"evt3", 12, 12}, width, height, time_base_us) {}

    /// Words do not go on in the next message, and a first time is believed: times of ROS are
    /// counted from a message's first.
    void end_message(Batch& into);

private:
    void take(std::span<const std::byte> words, Batch& into) override;
    void take_one(std::uint16_t word, Batch& into);
    void take_vector(unsigned mask, unsigned bits, Batch& into);
    void take_column(unsigned x, bool on, Batch& into);
    void look();

    std::int64_t told_us() const override { return t_us_; }
    void end(Batch& into) override;
    void begin_anew() override;
    void read_header(std::span<const std::byte> header) override;

    static constexpr std::uint32_t kNoRow = 1U << 16, kNoColumn = 1U << 16;

    std::int64_t t_us_ = 0;  ///< of the word being read, without time_base_us_
    std::uint32_t y_ = kNoRow;
    std::uint32_t base_x_ = kNoColumn;  ///< of the next vector
    bool base_on_ = false;
    bool plain_ = false;  ///< events of this time and row may be taken without a look
};

/// Whether the writer has a word for it: rising and falling edges of sources 0 to 15.
bool evt3_holds(const Trigger& trigger);

/// Writes RAW files. Events of one row and time go as vectors where that takes fewer words, always
/// in the order 12, 12, 8 at multiples of 32 as cameras send them and OpenEB demands (openeb#111).
/// Times beyond 24 bits are kept by a header line "% time_base_us" that other readers ignore.
/// Triggers wait for the events up to their time; one that comes behind later events has the time
/// of the last. Throws Error (usage) for coordinates above 2047, triggers other than rising and
/// falling edges of sources 0 to 15, events that step back, times that leap by more than 10 days,
/// images and IMU samples.
class Evt3Writer final : public StreamWriter {
public:
    void begin(const StreamHeader& header, std::vector<std::byte>& out) override;
    void write(const Batch& batch, std::vector<std::byte>& out) override;
    void finish(std::vector<std::byte>& out) override;

private:
    void write_header(std::int64_t first_us, std::vector<std::byte>& out);
    void time(SensorTime t, std::vector<std::byte>& out);
    void wait_for_events(std::span<const Trigger> triggers);
    void trigger(const Trigger& trigger, std::vector<std::byte>& out);
    void row(std::span<const Event> events, std::vector<std::byte>& out);

    StreamHeader header_;
    bool header_written_ = false, time_written_ = false;
    std::int64_t base_us_ = 0, t_us_ = 0, high_ = 0;
    int y_ = -1;
    std::vector<Trigger> waiting_;  ///< in time order
};

}  // namespace eventide
