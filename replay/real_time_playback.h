// A recording delivered at the pace it was recorded.
#pragma once

#include "replay/recording.h"

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>

namespace eventide {

/// Waits so that sensor time runs at `speed` times host time.
///
/// It finds the time of bytes with a parser of its own (Recording::make_clock()), in pieces far
/// smaller than a chunk, so that slow recordings come as a stream and not in bursts of seconds; in
/// formats of compressed blocks a block comes at once. What is due is passed on in one packet. A
/// reader that is slow loses nothing; when it is more than kMaxLateness behind, the pace goes on
/// from there and is not made up for. Leaps of more than kLongestWait are not waited for.
class RealTimePlayback final : public Recording {
public:
    static constexpr SensorDuration kLongestWait = std::chrono::seconds(60);
    static constexpr std::chrono::milliseconds kMaxLateness{200};

    /// `speed` above zero: 1 is real time. Throws Error (usage) otherwise. `now`: the host's clock.
    RealTimePlayback(std::unique_ptr<Recording> recording, double speed,
                     std::function<HostTime()> now = std::chrono::steady_clock::now);

    const SensorInfo& info() const override { return recording_->info(); }
    ReadStatus read(RawPacket& into) override;
    void stop() noexcept override;  ///< a waiting read() ends at once
    std::unique_ptr<Parser> make_parser() const override { return recording_->make_parser(); }
    std::unique_ptr<Parser> make_clock() const override { return recording_->make_clock(); }
    std::vector<std::string> remarks() const override { return recording_->remarks(); }
    /// What lies before `t` comes without waiting.
    void seek(SensorTime t) override;
    std::uint64_t size_bytes() const override { return recording_->size_bytes(); }
    /// Any thread.
    std::uint64_t position_bytes() const override { return position_; }

    /// Any thread, heard also by a read() that waits. Zero pauses.
    void set_speed(double speed);
    double speed() const;

private:
    struct Anchor {
        HostTime host;
        SensorTime sensor;
    };

    bool next_piece();
    void note_position();
    bool wait_until_due(SensorTime t);
    HostTime due(SensorTime t) const;
    bool needs_anchor(SensorTime t, HostTime now) const;

    std::unique_ptr<Recording> recording_;
    const std::function<HostTime()> now_;

    // Source thread.
    std::unique_ptr<Parser> clock_;
    RawPacket chunk_;
    std::uint64_t chunk_begin_ = 0, chunk_end_ = 0;  ///< in the recording's bytes
    std::size_t given_ = 0;                          ///< bytes of the chunk passed on
    std::size_t parsed_ = 0;                         ///< bytes of the chunk whose time is known
    Batch unused_;
    std::optional<SensorTime> start_at_;  ///< after a seek: earlier data are not waited for
    std::optional<SensorTime> last_;      ///< time of the piece before

    // Any thread.
    std::atomic<std::uint64_t> position_{0};

    // Any thread, under the mutex.
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    double speed_;
    bool stopped_ = false;
    std::optional<Anchor> anchor_;
};

}  // namespace eventide
