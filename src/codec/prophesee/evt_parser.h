// What the parsers of EVT2, EVT2.1 and EVT3 share: where a file, a stream or a time begins and
// ends, and events that are not plain.
#pragma once

#include "src/codec/parser.h"
#include "src/codec/prophesee/evt_words.h"
#include "src/codec/prophesee/joined_words.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace eventide {

/// Reads bare words: what follows a file's header, or what a camera sends. Times are the stream's
/// own, with wraps counted from the first. What comes before the first time is passed over. A file
/// that was joined behind another begins a new stream; words of one of another format count as
/// unknown. The members' times are without time_base_us_.
class EvtParser : public Parser {
public:
    void reopened() override;
    void arrives(HostTime at) override { high_.arrives(at); }
    std::optional<SensorTime> clock() const override;
    const Damage& damaged() const override { return damage_; }

protected:
    struct Format {
        std::string_view name;  ///< as EvtHeader says it
        int high_bits;          ///< of times, in words of their own
        int low_bits;
    };
    /// Size in px, 0 when not known (then 2048, the most the formats hold).
    EvtParser(const Format& format, int width, int height, std::int64_t time_base_us = 0);

    /// One event that is not plain.
    void take_event(std::int64_t t_us, std::uint32_t x, std::uint32_t y, bool on, Batch& into);
    void take_trigger(std::int64_t t_us, bool rising, std::uint8_t source, Batch& into);
    /// What waited for its time to be sure: events from `before` on.
    void take_let_go(const Batch& into, std::size_t before);
    /// The same behind a word with the upper bits of the time.
    void take_let_go_by_high(Batch& into, std::size_t before);
    void move_clock(std::int64_t t_us) {
        if (t_us > newest_us_) newest_us_ = t_us;
    }

    /// The time that the words read so far tell.
    virtual std::int64_t told_us() const { return high_.us(); }
    /// Nothing contradicts any more what waits for its time to be sure.
    virtual void end(Batch& into);
    virtual void begin_anew();
    virtual void read_header(std::span<const std::byte> /*of a joined file*/) {}
    void begin_file(std::span<const std::byte> header);

    std::uint32_t width_, height_;
    std::int64_t time_base_us_;
    Damage damage_;
    EventBlock block_;
    EvtTimeHigh high_;
    bool is_of_other_format_ = false;       ///< the joined file
    std::int64_t newest_us_ = kNoTime;      ///< told
    std::int64_t last_event_us_ = kNoTime;  ///< of the events taken

private:
    Format format_;
    FileSeam seam_;
};

/// `Base` with words of kBytes, of which the parser has to take whole ones.
template <typename Base, std::size_t kBytes>
class EvtWordParser : public Base {
public:
    void parse(std::span<const std::byte> bytes, Batch& into) final {
        this->high_.hand_out(into);
        words_.feed(
            bytes, [&](auto words) { take_known(words, into); },
            [&](auto header) {
                end_file(into);
                this->begin_file(header);
            });
    }
    void finish(Batch& into) final {
        words_.finish([&](auto words) { take_known(words, into); }, [&](auto) { end_file(into); });
        end_file(into);
    }
    void resync() final {
        words_.drop();
        this->begin_anew();
    }

protected:
    using Base::Base;

    virtual void take(std::span<const std::byte> words, Batch& into) = 0;
    void end_words() {
        if (words_.is_half_read()) this->damage_.count(DamageReason::truncated);
        words_.drop();
    }

private:
    void take_known(std::span<const std::byte> words, Batch& into) {
        if (this->is_of_other_format_)
            this->damage_.count(DamageReason::unknown_word, words.size() / kBytes);
        else
            take(words, into);
    }
    void end_file(Batch& into) {
        end_words();
        this->end(into);
    }

    JoinedWords<kBytes> words_;
};

}  // namespace eventide
