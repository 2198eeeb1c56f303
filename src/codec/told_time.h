// The newest time that a recording's packets tell, whatever one of them says.
#pragma once

#include "src/codec/event_validator.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

namespace eventide {

/// Times of events are taken as they are: EventValidator has judged their leaps. The order of
/// images, IMU samples and triggers to the events is not known, so a leap of theirs is believed
/// only when the next packet of them does not lie before it. One flipped bit would otherwise be
/// hours of silence at the end of a recording.
class ToldTime {
public:
    std::optional<std::int64_t> newest_us() const { return newest_; }

    void tell_by_events(std::int64_t t_us) {
        if (newest_ && t_us <= *newest_) return;
        newest_ = t_us;
        if (doubted_ && t_us < *doubted_ - EventValidator::kLongestStep) doubted_.reset();
    }
    /// The time of an image, sample or trigger; it counts from end_packet() on.
    void tell(std::int64_t t_us) { told_ = std::max(told_.value_or(t_us), t_us); }

    void end_packet() {
        if (!told_) return;
        const std::int64_t told = *std::exchange(told_, std::nullopt);
        const bool is_leap = newest_ && told > *newest_ &&
                             std::uint64_t(told) - std::uint64_t(*newest_) >
                                 std::uint64_t(EventValidator::kLongestStep);
        if (is_leap && !(doubted_ && told >= *doubted_)) {
            doubted_ = told;
            return;
        }
        doubted_.reset();
        newest_ = std::max(newest_.value_or(told), told);
    }
    /// The stream ended: nothing can contradict the last leap.
    void finish() {
        end_packet();
        if (doubted_) newest_ = std::exchange(doubted_, std::nullopt);
    }

private:
    std::optional<std::int64_t> newest_, told_, doubted_;  ///< us
};

}  // namespace eventide
