// A DAVIS whose bytes are lost at random, for a minute of made time: what is recorded keeps the
// camera's time, and what the host's clock had to set right is counted.
#include "pipeline/event_windows.h"
#include "tests/drivers/davis_streams.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <random>

namespace eventide::test {
namespace {

using namespace davis;
using testing_support::DavisModel;
using testing_support::DavisModelSettings;

constexpr std::int64_t kMs = 1000, kSecond = 1'000'000;  // us
constexpr std::int64_t kMinute = 60 * kSecond;

/// What the host and the cable do to a stream.
struct Faults {
    unsigned seed = 1;
    unsigned late_us = 10'000;   ///< a packet arrives at most so late
    unsigned cut_per_1000 = 0;   ///< packets that lose their last word
    unsigned lost_per_1000 = 0;  ///< packets behind which a stretch of up to 150 ms is lost
    unsigned stall_us = 0;       ///< once a second nothing is read for so long; then all at once
    double host_rate = 1;        ///< the host's clock against the camera's
};

/// An event a millisecond, the place of each its number; silences of two seconds in between.
Batch numbered_scene(const DavisSensor& sensor) {
    Batch scene;
    for (std::int64_t t = kMs; t < kMinute; t += kMs) {
        if ((t / kSecond) % 10 >= 8) continue;
        const auto number = t / kMs;
        scene.events.push_back({from_us(t), std::uint16_t(number % sensor.width()),
                                std::uint16_t(number / sensor.width()), Polarity::on});
    }
    return scene;
}

/// The model, read by hand: time is made, so that nothing here depends on how busy a machine is.
class LossyCamera final : public Source {
public:
    explicit LossyCamera(const Faults& faults) : faults_(faults), rng_(faults.seed) {
        DavisModelSettings settings;
        settings.now = [this] { return from_us(now_); };
        model_ = std::make_unique<DavisModel>(settings);
        info_.width = settings.sensor.width();
        info_.height = settings.sensor.height();
        sensor_ = settings.sensor;
        model_->show(numbered_scene(sensor_));
        for (const Register at : {kRun, kTimestampRun, kUsbRun, kRunChip, kDvsRun, kTimestampReset})
            model_->write({at, 1});
    }
    const SensorInfo& info() const override { return info_; }
    bool is_live() const noexcept override { return true; }
    void stop() noexcept override {}
    std::unique_ptr<Parser> make_parser() const override {
        return std::make_unique<DavisParser>(sensor_);
    }

    ReadStatus read(RawPacket& into) override {
        for (; now_ < kMinute + kSecond;) {
            now_ += 2 * kMs;
            into.bytes.resize(4096);
            into.bytes.resize(model_->send(into.bytes));
            if (into.bytes.empty()) continue;
            if (now_ < lost_until_) continue;
            if (rng_() % 1000 < faults_.lost_per_1000) lost_until_ = now_ + rng_() % (150 * kMs);
            into.arrived = HostTime{std::chrono::microseconds{arrival()}};
            into.gap_before = std::exchange(gap_, lost_until_ > now_);
            if (rng_() % 1000 < faults_.cut_per_1000) {
                into.bytes.resize(into.bytes.size() - 2);
                gap_ = true;
            }
            return ReadStatus::data;
        }
        return ReadStatus::end;
    }

private:
    std::int64_t arrival() {
        std::int64_t at = now_ + std::int64_t(rng_() % (faults_.late_us + 1));
        const std::int64_t into_second = now_ % kSecond;
        if (now_ > kSecond && into_second < faults_.stall_us)
            at = std::max(at, now_ - into_second + faults_.stall_us);
        arrived_ = std::max(arrived_, at);
        return 1'000 * kSecond + std::int64_t(double(arrived_) * faults_.host_rate);
    }

    Faults faults_;
    std::mt19937 rng_;
    std::int64_t now_ = 0, arrived_ = 0, lost_until_ = 0;
    bool gap_ = false;
    DavisSensor sensor_;
    SensorInfo info_;
    std::unique_ptr<DavisModel> model_;
};

/// How far off each event is from the time its number says.
struct Errors final : DataObserver {
    explicit Errors(int width) : width_(width) {}
    void see(const Batch& batch) override {
        for (const Event& event : batch.events) {
            const std::int64_t true_us = (std::int64_t(event.y) * width_ + event.x) * kMs;
            const std::int64_t error = to_us(event.t) - true_us;
            ++events;
            ahead = std::max(ahead, error);
            behind = std::min(behind, error);
            far_off += std::abs(error) > 20 * kMs ? 1 : 0;
            stepped_back = stepped_back || to_us(event.t) < before_;
            before_ = to_us(event.t);
            last = error;
        }
    }
    std::uint64_t events = 0, far_off = 0;
    std::int64_t ahead = 0, behind = 0, last = 0;
    bool stepped_back = false;

private:
    int width_;
    std::int64_t before_ = 0;
};

struct Minute {
    Errors errors;
    Snapshot counters;
};

Minute run(const Faults& faults) {
    LossyCamera camera{faults};
    Errors errors{camera.info().width};
    Counters counters;
    EventWindows frames{camera, {}, nullptr, &errors, counters};
    RawPacket packet;
    while (camera.read(packet) == ReadStatus::data) {
        frames.take(packet);
        for (EventWindow event_window; frames.next(event_window);) continue;
    }
    return {errors, counters.snapshot()};
}

TEST(LossyClock, WithoutALossNothingIsSetRight) {
    const Minute minute = run({.late_us = 40'000, .stall_us = 200'000, .host_rate = 1.0001});
    EXPECT_EQ(minute.errors.events, 48'000U - 1);
    EXPECT_EQ(minute.errors.ahead, 0);
    EXPECT_EQ(minute.errors.behind, 0);
    EXPECT_EQ(minute.counters.damaged.total(), 0U);
}

TEST(LossyClock, StaysWithinTwentyMillisecondsHoweverBytesAreLost) {
    std::uint64_t corrected = 0;
    for (unsigned seed = 1; seed <= 8; ++seed)
        for (const double host_rate : {0.9999, 1.0, 1.0001}) {
            const Minute minute = run(
                {.seed = seed, .cut_per_1000 = 50, .lost_per_1000 = 10, .host_rate = host_rate});
            SCOPED_TRACE(testing::Message() << "seed " << seed << ", host's clock " << host_rate);
            EXPECT_GT(minute.counters.gaps, 1000U);
            EXPECT_GT(minute.errors.events, 15'000U);
            EXPECT_LT(minute.errors.ahead, 20 * kMs);
            EXPECT_GT(minute.errors.behind, -20 * kMs);
            EXPECT_FALSE(minute.errors.stepped_back);
            corrected += minute.counters.damaged[DamageReason::time_corrected];
        }
    EXPECT_GT(corrected, 100U);
}

/// Where the host itself is late, a loss cannot be told from the delay at once: what was guessed is
/// taken back as soon as packets come on time again.
TEST(LossyClock, ComesBackFromWhatALateHostMadeItGuess) {
    for (unsigned seed = 1; seed <= 8; ++seed) {
        const Minute minute = run({.seed = seed,
                                   .late_us = 30'000,
                                   .cut_per_1000 = 50,
                                   .lost_per_1000 = 5,
                                   .stall_us = 120'000});
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        EXPECT_LT(minute.errors.far_off, minute.errors.events / 3);
        EXPECT_LT(minute.errors.ahead, 150 * kMs);
        EXPECT_GT(minute.errors.behind, -150 * kMs);
        EXPECT_LT(std::abs(minute.errors.last), 40 * kMs);
        EXPECT_FALSE(minute.errors.stepped_back);
        EXPECT_GT(minute.counters.damaged[DamageReason::time_corrected], 1U);
    }
}

}  // namespace
}  // namespace eventide::test
