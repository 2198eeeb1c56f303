// Prophesee's DAT: 8 bytes for each event or trigger (docs/protocols.md D.4).
#pragma once

#include "src/codec/event_validator.h"
#include "src/codec/parser.h"
#include "src/codec/prophesee/evt_words.h"
#include "src/codec/prophesee/joined_words.h"
#include "src/codec/stream.h"

#include <cstdint>
#include <optional>
#include <span>

namespace eventide {

struct DatHeader {
    enum class Record { events_v1, events_v2, triggers };
    StreamHeader stream;
    Record record = Record::events_v2;
};

/// Empty when it is no DAT file.
std::optional<DatHeader> find_dat_header(std::span<const std::byte> first_bytes);

/// Throws Error (input) naming what was found.
DatHeader read_dat_header(std::span<const std::byte> first_bytes);

/// Reads the records after the header. Times are the file's own, with wraps of the 32 bits counted.
/// A file that was joined behind another begins a new stream, of its own kind of records; words of
/// one of another format count as unknown.
class DatParser final : public Parser {
public:
    /// Size in px, 0 when not known (then what the record's bits hold).
    explicit DatParser(DatHeader::Record record, int width = 0, int height = 0);

    void parse(std::span<const std::byte> bytes, Batch& into) override;
    void finish(Batch& into) override;
    void resync() override;
    std::optional<SensorTime> clock() const override;
    const Damage& damaged() const override { return damage_; }

private:
    static constexpr std::size_t kBytesBehindLines = 2;  // the records' type and size
    void take(std::span<const std::byte> records, Batch& into);
    static std::int64_t unwrapped(std::uint32_t stamp, std::int64_t near_us);
    void take_trigger(std::uint32_t stamp, std::uint32_t word, Batch& into);
    void let_trigger_go(Batch& into);
    void end_file(Batch& into);
    void begin_file(std::span<const std::byte> header);

    DatHeader::Record record_;
    EventValidator validator_;
    JoinedWords<8> words_{kBytesBehindLines};
    FileSeam seam_;
    bool is_of_other_format_ = false;  ///< the joined file
    EventBlock block_;
    Damage damage_;
    std::int64_t last_trigger_us_ = kNoTime;  ///< of those taken
    std::optional<Trigger> held_trigger_;     ///< until the next one agrees with it
};

}  // namespace eventide
