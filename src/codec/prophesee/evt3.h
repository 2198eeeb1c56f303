// EVT3: 16-bit words; row, column, vectors of columns and time in words of their own
// (docs/protocols.md D.4).
#pragma once

#include "src/codec/parser.h"
#include "src/codec/prophesee/evt_words.h"
#include "src/codec/prophesee/joined_words.h"
#include "src/codec/stream.h"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace eventide {

/// Reads bare words: what follows a file's header, or what a camera sends. Times are the stream's
/// own, with wraps of the 24 bits counted from the first. What comes before the first time is
/// passed over. A file that was joined behind another begins a new stream; words of one of another
/// format count as unknown.
class Evt3Parser final : public Parser {
public:
    /// Size in px, 0 when not known (then 2048, the most the format holds).
    explicit Evt3Parser(int width = 0, int height = 0, std::int64_t time_base_us = 0);

    void parse(std::span<const std::byte> bytes, Batch& into) override;
    void finish(Batch& into) override;
    /// Words do not go on in the next message, and a first time is believed: times of ROS are
    /// counted from a message's first.
    void end_message(Batch& into);
    void resync() override;
    void reopened() override;
    void arrives(HostTime at) override { high_.arrives(at); }
    std::optional<SensorTime> clock() const override;
    const Damage& damaged() const override { return damage_; }

private:
    void take(std::span<const std::byte> words, Batch& into);
    void take_one(std::uint16_t word, Batch& into);
    void take_vector(unsigned mask, unsigned bits, Batch& into);
    void take_event(unsigned x, bool on, Batch& into);
    void take_trigger(unsigned content, Batch& into);
    void take_let_go(const Batch& into, std::size_t before);
    void end_words();
    void end_file(Batch& into);
    void begin_file(std::span<const std::byte> header);
    void move_clock();
    void look();

    std::uint32_t width_, height_;
    std::int64_t time_base_us_;
    JoinedWords<2> words_;
    EventBlock block_;
    Damage damage_;

    EvtTimeHigh high_;
    FileSeam seam_;
    bool is_of_other_format_ = false;   ///< the joined file
    std::int64_t t_us_ = 0;             ///< of the word being read, without time_base_us_
    std::int64_t newest_us_ = kNoTime;  ///< told
    std::int64_t last_event_us_ = kNoTime;
    std::uint32_t y_ = kNoRow;
    std::uint32_t base_x_ = kNoColumn;  ///< of the next vector
    bool base_on_ = false;
    bool plain_ = false;  ///< events of this time and row may be taken without a look

    static constexpr std::uint32_t kNoRow = 1U << 16, kNoColumn = 1U << 16;
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
