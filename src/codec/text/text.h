// Events as lines of text.
#pragma once

#include "src/codec/event_validator.h"
#include "src/codec/parser.h"
#include "src/codec/reorder.h"
#include "src/codec/stream.h"
#include "src/codec/text/text_layout.h"

#include <string>

namespace eventide {

/// Reads rows of numbers, one event each. Blank lines and comments are passed over; a line that is
/// no row counts as bad_record, one of more than kLongestLineBytes as bad_length.
class TextParser final : public Parser {
public:
    static constexpr std::size_t kLongestLineBytes = 1024;

    /// Events outside width x height px are left out and counted; so are those that come more than
    /// `reorder` before one already read.
    TextParser(const TextLayout& layout, int width, int height,
               SensorDuration reorder = TextOptions::kUsualReorder);

    void parse(std::span<const std::byte> bytes, Batch& into) override;
    void finish(Batch& into) override;
    void resync() override;
    std::optional<SensorTime> clock() const override;
    const Damage& damaged() const override { return damage_; }

private:
    const char* parse_quickly(const char* p, const char* end, Batch& into);
    const char* complete_carried_line(const char* p, const char* end, Batch& into);
    void place(std::int64_t t_us, std::uint64_t x, std::uint64_t y, bool on, Batch& into);
    /// What hands events on to validator_.
    auto taker(Batch& into) {
        return [this, &into](const Event& event) {
            validator_.add(to_us(event.t), event.x, event.y, event.polarity == Polarity::on, into,
                           damage_);
        };
    }
    void take_up(Batch& into);
    bool parse_line(const char* begin, const char* end, Batch& into);

    TextLayout layout_;
    Reorder reorder_;
    EventValidator validator_;
    bool resyncing_ = false;  ///< what was held before the jump is still to be handed on
    std::size_t time_column_ = 0, x_column_ = 0, y_column_ = 0, polarity_column_ = 0;
    std::string carried_;            ///< the beginning of a line whose end has not come
    bool skipping_to_line_ = false;  ///< in the middle of a line that cannot be used
    Damage damage_;
};

/// Where the size is known, it is in the first line: "width height", as E2VID's files have it, or a
/// comment "# geometry: width,height", which readers of the Event Camera Dataset pass over.
enum class TextSize : std::uint8_t { in_a_line, in_a_comment };

/// Writes the size, then "t x y p" with t in seconds, six
/// decimals, and p 0 or 1. Holds events only.
class TextWriter final : public StreamWriter {
public:
    explicit TextWriter(TextSize size = TextSize::in_a_line) : size_(size) {}

    void begin(const StreamHeader& header, std::vector<std::byte>& out) override;
    void write(const Batch& batch, std::vector<std::byte>& out) override;
    void finish(std::vector<std::byte>&) override {}

private:
    TextSize size_;
};

}  // namespace eventide
