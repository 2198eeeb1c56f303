// EVT2 and EVT2.1: each word with time, place and polarity; 2.1 carries 32 columns at once
// (docs/protocols.md D.4).
#pragma once

#include "src/codec/parser.h"
#include "src/codec/prophesee/evt_header.h"
#include "src/codec/prophesee/evt_words.h"
#include "src/codec/prophesee/joined_words.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace eventide {

/// The part that EVT2 and EVT2.1 share. Reads bare words: what follows a file's header, or what a
/// camera sends. Times are the stream's own, with wraps of the 34 bits counted from the first. What
/// comes before the first time is passed over. A file that was joined behind another begins a new
/// stream; words of one of another format count as unknown.
class Evt2Base : public Parser {
public:
    void reopened() override;
    void arrives(HostTime at) override { high_.arrives(at); }
    std::optional<SensorTime> clock() const override;
    const Damage& damaged() const override { return damage_; }

protected:
    /// Size in px, 0 when not known (then 2048, the most the formats hold).
    Evt2Base(int width, int height);

    /// One event that is not plain.
    void take_event(std::int64_t t_us, std::uint32_t x, std::uint32_t y, bool on, Batch& into);
    /// All words but events; `upper` is an EVT2 word or the upper half of an EVT2.1 word.
    void take_other(std::uint32_t upper, bool is_padding, Batch& into);
    /// Nothing contradicts any more what waits for its time to be sure.
    void end(Batch& into);
    void begin_anew();
    void begin_file(std::span<const std::byte> header, std::string_view format);
    void move_clock(std::int64_t t_us) {
        if (t_us > newest_us_) newest_us_ = t_us;
    }

    std::uint32_t width_, height_;
    Damage damage_;
    EventBlock block_;
    EvtTimeHigh high_;
    FileSeam seam_;
    bool is_of_other_format_ = false;       ///< the joined file
    std::int64_t newest_us_ = kNoTime;      ///< told
    std::int64_t last_event_us_ = kNoTime;  ///< of the events taken

private:
    void take_trigger(std::uint32_t word, Batch& into);
    void take_let_go(const Batch& into, std::size_t before);
};

class Evt2Parser final : public Evt2Base {
public:
    explicit Evt2Parser(int width = 0, int height = 0) : Evt2Base(width, height) {}
    void parse(std::span<const std::byte> bytes, Batch& into) override;
    void finish(Batch& into) override;
    void resync() override;

private:
    void take(std::span<const std::byte> words, Batch& into);
    void end_file(Batch& into);
    JoinedWords<4> words_;
};

class Evt21Parser final : public Evt2Base {
public:
    /// In files of "endianness legacy" and from V4L2 nodes of format PSE1 the upper half of each
    /// word comes first.
    enum class Order { lower_half_first, upper_half_first };
    static Order order_of(const EvtHeader& header);

    explicit Evt21Parser(int width = 0, int height = 0, Order order = Order::lower_half_first)
        : Evt2Base(width, height), order_(order) {}
    void parse(std::span<const std::byte> bytes, Batch& into) override;
    void finish(Batch& into) override;
    void resync() override;

private:
    void take(std::span<const std::byte> words, Batch& into);
    void end_file(Batch& into);
    Order order_;
    JoinedWords<8> words_;
};

}  // namespace eventide
