// The noise filter beside one that does the same event by event, as docs/model.md has it.
#include "src/binning/noise_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <utility>

namespace eventide {
namespace {

constexpr int kWidth = 45, kHeight = 27, kRows = 3, kColumns = 5;  // of tiles of 8 x 8 px
constexpr std::int64_t kIntervalUs = 250'000;

class PlainNoiseFilter {
public:
    explicit PlainNoiseFilter(const NoiseFilterSettings& settings) : settings_(settings) {}

    bool keeps(const Event& event) {
        const bool begins = !last_ || event.t < *last_;
        if (begin_us_ && to_us(event.t) < *begin_us_) newest_.clear();  // another stream's
        last_ = event.t;
        const bool hot = hot_pixels_.is_hot(event);
        int near = 0, alike = 0;
        for (int n = 0; n < 9; ++n) {
            const auto at = newest_.find({event.x - 1 + n % 3, event.y - 1 + n / 3});
            if (n == 4 || at == newest_.end() || at->second.t > event.t) continue;
            const SensorDuration age = event.t - at->second.t;
            near += age <= time(1);
            alike += age <= time(2. / 3) && at->second.polarity == event.polarity;
        }
        const bool quiet = count(event, hot, alike >= 4);
        if (!hot) newest_[{event.x, event.y}] = event;
        return begins || (!hot && (quiet ? alike >= 4 : near >= 2));
    }

private:
    struct Tile {
        double now = 0, before = 0, supported = 0, noise = 0;
        bool is_quiet(double intervals) const {
            const double more = now + before - intervals * noise - 1;
            return more <= 0 || more <= 6 * std::sqrt(intervals * noise);
        }
        bool stands_alone() const { return supported <= .02 * now + 1; }
    };

    /// Two neighbours are there by chance for 6 % of the noise's events.
    SensorDuration time(double share) const {
        const double us = 1e6 * .4 / (8 * noise_hz_);
        return std::clamp(SensorDuration{std::int64_t(std::min(1e9, share * us))},
                          settings_.shortest, settings_.longest);
    }
    /// Whether its tile is quiet.
    bool count(const Event& event, bool hot, bool supported) {
        const std::int64_t us = to_us(event.t);
        if (!begin_us_ || us < *begin_us_) {
            tiles_ = {};
            begin_us_ = us;
            measured_ = false;
        }
        for (int ended = 0; us - *begin_us_ >= kIntervalUs; ++ended, *begin_us_ += kIntervalUs) {
            if (ended == 0) end_interval();
            if (ended == 0) continue;
            noise_hz_ = 0;
            for (Tile& tile : tiles_) tile.before = 0;
        }
        Tile& tile = tiles_[std::size_t(std::min(event.y / 8, kRows - 1) * kColumns +
                                        std::min(event.x / 8, kColumns - 1))];
        tile.now += !hot;
        tile.supported += supported;
        return measured_ && settings_.shortest != settings_.longest &&
               tile.is_quiet(1 + double(us - *begin_us_) / double(kIntervalUs));
    }
    void end_interval() {
        std::vector<double> alone;
        for (const Tile& tile : tiles_)
            if (tile.stands_alone()) alone.push_back(tile.now);
        if (!alone.empty()) {
            std::ranges::sort(alone);
            const double least = alone[std::size_t(.1 * double(alone.size()))];
            const double mean = least > 0 ? least + 1.28 * std::sqrt(least) + .5 * 1.28 * 1.28 : 0;
            const double hz = mean / (64 * .25);
            noise_hz_ += (hz > noise_hz_ ? .1 : measured_ ? .5 : 1) * (hz - noise_hz_);
        }
        const double noise = noise_hz_ * 64 * .25;
        for (Tile& tile : tiles_) {
            if (!measured_)
                tile.noise = noise;
            else if (tile.is_quiet(2) || tile.stands_alone())
                tile.noise += (tile.is_quiet(2) ? .1 : .02) * (tile.now - tile.noise);
            tile.noise = std::clamp(tile.noise, noise, 4 * noise);
            tile.before = std::exchange(tile.now, 0);
            tile.supported = 0;
        }
        measured_ = true;
    }

    NoiseFilterSettings settings_;
    HotPixels hot_pixels_{kWidth, kHeight, 5, SensorDuration{2'000'000}};
    std::map<std::pair<int, int>, Event> newest_;
    std::array<Tile, std::size_t(kRows* kColumns)> tiles_{};
    std::optional<std::int64_t> begin_us_;
    std::optional<SensorTime> last_;
    double noise_hz_ = 2;
    bool measured_ = false;
};

/// Noise, three times as much in one corner; a bar that passes now and then; a hot pixel; pauses.
std::vector<Event> lively_events(std::uint32_t seed, double seconds, double noise_hz) {
    std::mt19937 random{seed};
    std::vector<Event> events;
    const auto add = [&](double us, int x, int y, bool on) {
        const bool pauses = (us > 2.98e6 && us < 3.3e6) || (us > 5e6 && us < 6.3e6);
        if (!pauses && x >= 0 && x < kWidth && y >= 0 && y < kHeight)
            events.push_back({from_us(std::int64_t(us)), std::uint16_t(x), std::uint16_t(y),
                              on ? Polarity::on : Polarity::off});
    };
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            std::exponential_distribution<double> pause{noise_hz * (x < 16 && y < 8 ? 3e-6 : 1e-6)};
            for (double us = pause(random); us < seconds * 1e6; us += pause(random))
                add(us, x, y, random() % 2 == 0);
        }
    for (double begin_s = 1; begin_s < seconds; begin_s += 1.7)
        for (int x = 0; x < kWidth; ++x)
            for (int y = 5; y < 22; ++y)
                for (int n = 0; n < 3; ++n)
                    add(begin_s * 1e6 + 9'000 * x + double(random() % 20'000), x + n % 2, y, n < 2);
    for (double us = 0; us < seconds * 1e6; us += 30'000) add(us, 30, 3, true);
    std::ranges::stable_sort(events, {}, &Event::t);
    return events;
}

TEST(NoiseFilterFormula, SaysWhichEventsStay) {
    for (const NoiseFilterSettings& settings :
         {NoiseFilterSettings{}, NoiseFilterSettings{SensorDuration{7000}, SensorDuration{7000}}})
        for (const double noise_hz : {.3, 2., 6.}) {
            NoiseFilter filter{kWidth, kHeight, settings};
            PlainNoiseFilter plain{settings};
            std::vector<Event> events = lively_events(7, 9, noise_hz);
            // The clock begins anew, before and within the interval.
            for (const std::int64_t us : {2'000'000, 1'950'000}) {
                const auto more = lively_events(8, 4, noise_hz);
                const auto from = std::ranges::lower_bound(more, from_us(us), {}, &Event::t);
                events.insert(events.end(), from, more.end());
            }
            std::vector<Event> kept, expected;
            for (const Event& event : events)
                if (plain.keeps(event)) expected.push_back(event);
            kept = events;
            filter.process(kept);
            EXPECT_GT(kept.size(), 1000U);
            const auto differ = std::ranges::mismatch(kept, expected);
            EXPECT_EQ(kept.size(), expected.size()) << noise_hz;
            EXPECT_TRUE(differ.in1 == kept.end())
                << noise_hz << " Hz: differ from "
                << (differ.in1 == kept.end() ? 0 : to_us(differ.in1->t)) << " us on";
        }
}

}  // namespace
}  // namespace eventide
