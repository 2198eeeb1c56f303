// Bytes at the pace of their own clock.
#include "replay/real_time_playback.h"

#include "src/core/error.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace eventide {

namespace {

// A few dozen events: milliseconds even where little moves.
constexpr std::size_t kPieceBytes = 256;

}  // namespace

RealTimePlayback::RealTimePlayback(std::unique_ptr<Recording> recording, double speed,
                                   std::function<HostTime()> now)
    : recording_(std::move(recording)),
      now_(std::move(now)),
      clock_(recording_->make_clock()),
      speed_(speed) {
    if (!(speed > 0) || !std::isfinite(speed))
        throw Error(ErrorKind::usage,
                    "speed: expected a number above 0, found " + std::to_string(speed));
    note_position();
}

/// Parses on by one piece, of the next chunk where this one is used up; false at the end.
bool RealTimePlayback::next_piece() {
    if (parsed_ == chunk_.bytes.size()) {
        parsed_ = given_ = 0;
        chunk_begin_ = recording_->position_bytes();
        if (recording_->read(chunk_) != ReadStatus::data) {
            chunk_.bytes.clear();
            note_position();
            return false;
        }
        chunk_end_ = recording_->position_bytes();
    }
    const std::size_t n = std::min(kPieceBytes, chunk_.bytes.size() - parsed_);
    clock_->parse(std::span(chunk_.bytes).subspan(parsed_, n), unused_);
    unused_.clear();
    parsed_ += n;
    return true;
}

/// Packets of formats that are no streams have more bytes than the file, or fewer.
void RealTimePlayback::note_position() {
    const std::uint64_t size = chunk_.bytes.size();
    position_ = size == 0 ? recording_->position_bytes()
                          : chunk_begin_ + (chunk_end_ - chunk_begin_) * given_ / size;
}

HostTime RealTimePlayback::due(SensorTime t) const {
    const double us = double((t - anchor_->sensor).count()) / speed_;
    return anchor_->host + std::chrono::microseconds(std::llround(us));
}

bool RealTimePlayback::needs_anchor(SensorTime t, HostTime now) const {
    if (!anchor_ || (last_ && (t < *last_ || t - *last_ > kLongestWait))) return true;
    return now - due(t) > kMaxLateness;
}

/// False when stopped.
bool RealTimePlayback::wait_until_due(SensorTime t) {
    if (start_at_ && t < *start_at_) return true;
    start_at_.reset();
    std::unique_lock lock(mutex_);
    while (!stopped_) {
        if (speed_ == 0) {
            changed_.wait(lock);
            continue;
        }
        const HostTime now = now_();
        if (needs_anchor(t, now)) anchor_ = {now, t};
        const HostTime when = due(t);
        last_ = t;
        if (when <= now) return true;
        changed_.wait_until(lock, when);
    }
    return false;
}

ReadStatus RealTimePlayback::read(RawPacket& into) {
    into.bytes.clear();
    if (given_ == parsed_ && !next_piece()) return ReadStatus::end;
    // The first piece is waited for; what else is due by then goes with it.
    for (bool first = true;; first = false) {
        if (const auto t = clock_->clock()) {
            if (first && !wait_until_due(*t)) return ReadStatus::end;
            if (!first) {
                const std::lock_guard lock(mutex_);
                const bool early = start_at_ && *t < *start_at_;
                const bool is_due =
                    anchor_ && speed_ > 0 && (!last_ || *t >= *last_) && due(*t) <= now_();
                if (!early && (!is_due || start_at_)) break;
                last_ = t;
            }
        }
        const auto begin = chunk_.bytes.begin();
        into.bytes.insert(into.bytes.end(), begin + std::ptrdiff_t(given_),
                          begin + std::ptrdiff_t(parsed_));
        given_ = parsed_;
        if (parsed_ == chunk_.bytes.size() || !next_piece()) break;
    }
    into.arrived = now_();
    into.gap_before = std::exchange(chunk_.gap_before, false);
    into.sequence = chunk_.sequence;
    note_position();
    return ReadStatus::data;
}

void RealTimePlayback::stop() noexcept {
    recording_->stop();
    {
        const std::lock_guard lock(mutex_);
        stopped_ = true;
    }
    changed_.notify_all();
}

void RealTimePlayback::seek(SensorTime t) {
    recording_->seek(t);
    clock_ = recording_->make_clock();
    chunk_.bytes.clear();
    given_ = parsed_ = 0;
    start_at_ = t;
    last_.reset();
    const std::lock_guard lock(mutex_);
    anchor_.reset();
    note_position();
}

void RealTimePlayback::set_speed(double speed) {
    if (!(speed >= 0) || !std::isfinite(speed))
        throw Error(ErrorKind::usage,
                    "speed: expected a number, 0 or above, found " + std::to_string(speed));
    {
        const std::lock_guard lock(mutex_);
        speed_ = speed;
        anchor_.reset();  // the new pace begins with the next piece
    }
    changed_.notify_all();
}

double RealTimePlayback::speed() const {
    const std::lock_guard lock(mutex_);
    return speed_;
}

}  // namespace eventide
