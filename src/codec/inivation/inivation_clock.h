// Time as iniVation's words tell it: some low bits, wraps, and resets (docs/protocols.md A.9,
// A.12).
#pragma once

#include "src/codec/inivation/host_reference.h"
#include "src/core/damage.h"
#include "src/core/sensor_time.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

namespace eventide {

/// 64 bits, so the 2^31 us overflow of older readers does not exist. A reset sets the device to
/// zero; here time goes on. A word tells the low `kBits` bits: 15 of DAVIS and DVXplorer, 14 of
/// DVS128.
///
/// A loss may take wraps with it, and only the host's clock can tell how many. They are guessed
/// from how long the packet behind the loss took, which is wrong where that packet came much
/// earlier or later than others do. So the guesses stay in doubt until packets have come on time
/// for a while; until then a time that the host's clock shows to be impossible takes wraps back,
/// and one that stays behind it adds them. Time never steps back: after a correction downwards it
/// is held until the camera's own passes it.
template <int kBits>
class IniVationClock {
public:
    static constexpr std::int64_t kWrapUs = 1 << kBits;

    std::int64_t us() const { return time_; }
    SensorTime now() const { return from_us(time_); }
    /// A word told the time since the start or the last loss.
    bool is_known() const { return known_; }

    /// The next words arrived at this time of the host's clock: see Parser::arrives.
    void arrives(HostTime at, Damage& damage) {
        if (arrived_ && told_at_ == arrived_) judge(damage);
        arrived_ = std::chrono::duration_cast<SensorDuration>(at.time_since_epoch()).count();
    }
    /// False where the event that comes with the word has to be left out.
    bool timestamp(std::uint16_t low, Damage& damage) {
        if (!known_) catch_up(wrap_add_ + low, damage);
        return move_to(wrap_add_ + low, damage);
    }
    void wrap(std::uint16_t wraps, Damage& damage) {
        if (wraps == 0) return damage.count(DamageReason::bad_record);
        wrap_add_ += kWrapUs * wraps;
        if (!known_) catch_up(wrap_add_, damage);
        move_to(wrap_add_, damage);
    }
    /// The device counts from zero again, the stream goes on (after an unplugging, by the host's
    /// clock). A device that nobody read from for minutes also resets itself, when it cannot count
    /// its wraps any further: then time is behind the host's clock by more than packets are ever
    /// late.
    void reset(Damage& damage) {
        const bool is_stalled = known_ && reference_ && arrived_ &&
                                reference_->latest(*arrived_) - time_ > kLongestDelayUs;
        if (is_stalled) damage.count(DamageReason::time_corrected);
        time_ = is_stalled ? reference_->latest(*arrived_)
                           : std::max(time_, expected().value_or(time_));
        wrap_add_ = told_ = time_;
        known_ = true;
        told_at_ = arrived_;
        reference_.reset();
        doubt_.reset();
    }
    /// Bytes were lost: nothing has a time until a word tells it again.
    void forget() { known_ = false; }

    // For loops that keep the time in a register while only timestamps come, then hand it back.

    /// Nothing but the word itself decides what the next timestamp means.
    bool is_settled() const { return known_; }
    std::int64_t wrap_add() const { return wrap_add_; }  ///< us; plus a word's low bits: its time
    void move_on(std::int64_t us) {                      ///< settled only, and not backwards
        if (us == time_) return;
        time_ = told_ = us;
        told_at_ = arrived_;
    }

private:
    // How much a packet may seem too early, and how much all of them too late, without a wrap being
    // wrong: a reference from packets that were all late is that much off, too.
    static constexpr std::int64_t kEarlySlackUs = kWrapUs / 2, kLateSlackUs = kWrapUs / 3;
    static constexpr std::int64_t kLongestDelayUs = 1'000'000;
    static constexpr std::int64_t kGuessTimeoutUs = 300'000;  ///< until a guess is believed
    static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

    /// Since a loss: what was guessed, and what packets since then showed.
    struct Doubt {
        std::int64_t lost_at = 0;          ///< host's clock, us: the last loss or correction
        std::int64_t window_began = 0;     ///< host's clock, us
        std::int64_t least_late = kNever;  ///< of the packets in the window, us
        std::int64_t guessed = 0;          ///< wraps
    };

    bool move_to(std::int64_t time, Damage& damage) {
        told_at_ = arrived_;
        told_ = time;
        known_ = true;
        if (time < time_) {
            if (time_ <= held_at_) return true;
            damage.count(DamageReason::time_backwards);
            return false;
        }
        time_ = time;
        return true;
    }

    /// The time now, were packets as late as the last one before the loss was. Empty without a
    /// host's clock.
    std::optional<std::int64_t> expected() const {
        if (known_ || !arrived_ || !told_at_) return std::nullopt;
        const std::int64_t guess = told_ + (*arrived_ - *told_at_);
        return reference_ ? std::min(guess, reference_->latest(*arrived_)) : guess;
    }

    /// Whole wraps may be missing: adds as many as bring `candidate` nearest to the expected time,
    /// and no fewer than bring it past the time told before, unless that was a guess itself.
    void catch_up(std::int64_t candidate, Damage& damage) {
        const auto expected = this->expected();
        if (!expected) return;
        double wraps = std::round(double(*expected - candidate) / double(kWrapUs));
        if (!doubt_ || doubt_->guessed == 0)
            wraps = std::max(wraps, std::ceil(double(told_ - candidate) / double(kWrapUs)));
        if (!doubt_) doubt_ = Doubt{.window_began = *arrived_};
        doubt_->lost_at = *arrived_;
        if (wraps > 0) shift(std::int64_t(wraps), damage);
    }

    void shift(std::int64_t wraps, Damage& damage) {
        damage.count(DamageReason::time_corrected);
        wrap_add_ += wraps * kWrapUs;
        told_ += wraps * kWrapUs;
        doubt_->guessed += wraps;
        doubt_->least_late = kNever;
        doubt_->window_began = doubt_->lost_at = *arrived_;
        if (wraps < 0) held_at_ = time_;
    }

    /// What the packet before says, now that its newest time is known.
    void judge(Damage& damage) {
        if (!reference_) return reference_.emplace().begin(told_, *arrived_);
        if (doubt_) settle(reference_->latest(*arrived_) - told_, damage);
        reference_->see(told_, *arrived_, doubt_ && doubt_->guessed > 0);
    }

    void settle(std::int64_t late, Damage& damage) {
        if (-late > kEarlySlackUs && doubt_->guessed > 0) {
            const std::int64_t impossible = (-late - kEarlySlackUs + kWrapUs - 1) / kWrapUs;
            return shift(-std::min(impossible, doubt_->guessed), damage);
        }
        doubt_->least_late = std::min(doubt_->least_late, late);
        if (*arrived_ - doubt_->window_began < kGuessTimeoutUs) return;
        const std::int64_t missing = (doubt_->least_late + kLateSlackUs) / kWrapUs;
        if (missing > 0) return shift(missing, damage);
        if (*arrived_ - doubt_->lost_at >= kGuessTimeoutUs) return doubt_.reset();
        *doubt_ = Doubt{.lost_at = doubt_->lost_at, .window_began = *arrived_};
    }

    std::int64_t wrap_add_ = 0, time_ = 0;
    std::int64_t told_ = 0;  ///< what the last word said; behind time_ only while that is held
    std::int64_t held_at_ = std::numeric_limits<std::int64_t>::min();
    bool known_ = false;
    std::optional<std::int64_t> arrived_, told_at_;  ///< host's clock, us
    std::optional<HostReference> reference_;
    std::optional<Doubt> doubt_;
};

}  // namespace eventide
