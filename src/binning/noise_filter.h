// Leaves out the events that nothing around them supports: a sensor's noise.
#pragma once

#include "src/binning/hot_pixels.h"
#include "src/binning/newest_events.h"
#include "src/core/event.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace eventide {

/// Within which time neighbours support an event; from `shortest` to `longest`, as noisy as the
/// sensor is. Equal: always that, whatever fires how much.
struct NoiseFilterSettings {
    SensorDuration shortest{10'000}, longest{500'000};
    friend bool operator==(const NoiseFilterSettings&, const NoiseFilterSettings&) = default;
};

/// An event stays where at least kSupport of the eight pixels around its own had one, of either
/// polarity, a short time before it; those left out support others all the same. What moves makes
/// neighbours fire, noise (shot noise, leak, hot pixels) stands alone. The idea is the background
/// activity filter of Delbruck (Frame-free dynamic digital vision, 2008), which asks for one
/// neighbour within a constant time. Hot pixels (HotPixels, kHotHz) are left out and support
/// nothing.
///
/// Here the time adapts: it is chosen so that of events which come at random as often as the
/// sensor's noise, kSupport are rarely together (6 %). In the dark it is short; where there is no
/// noise it is long, and slow motion and fine texture, whose events come one by one too, stay.
/// Noise is what fires in those parts of the sensor (tiles of kTile x kTile px) in which least
/// does. Where a tile fires little more than noise does, nothing moves there or begins to: an event
/// then needs kQuietSupport neighbours of its own polarity, which noise has at random, within two
/// thirds of the time, so that an hour of noise does not wear off what is known of a still scene.
///
/// Deterministic: what is left out depends on the events, not on how they are split. The first
/// event of a stream stays, and the first after its clock was reset, so that they tell whoever
/// comes next; events from before a reset, or from after the present, support nothing. One thread
/// at a time.
class NoiseFilter {
public:
    static constexpr int kSupport = 2, kQuietSupport = 4;
    static constexpr double kHotHz = 5;
    static constexpr SensorDuration kMaxTime = NewestEvents::kLongest;

    /// Sensor of width x height px, which events must lie on. Throws Error (usage) for times that
    /// are not from 1 us to kMaxTime.
    NoiseFilter(int width, int height, const NoiseFilterSettings& settings);

    /// Removes events in place; the order stays.
    void process(std::vector<Event>& events) noexcept;

    void reset() noexcept;  ///< as constructed

    /// Noise events per pixel and second, as known at the newest event; before the first 250 ms of
    /// a stream are over, what DVS pixels often have.
    double noise_hz() const { return noise_hz_; }
    /// Within which time neighbours support an event now; and where nothing moves.
    SensorDuration within() const { return within_; }
    SensorDuration quiet_within() const { return quiet_within_; }

    /// What it knows of a part of the sensor.
    struct Tile {
        std::uint32_t events = 0, before = 0;  ///< in this interval, less hot pixels'; in the last
        std::uint32_t supported = 0;           ///< of them, as quiet tiles ask for
        double noise = 0;                      ///< events per interval
        friend bool operator==(const Tile&, const Tile&) = default;
    };
    /// All that it has learned, to go on from elsewhere: with the same settings it leaves out what
    /// this one would have.
    struct State {
        /// [y + 1][x + 1], with a rim of one pixel; of each pixel's newest event, SensorTime::min()
        /// and off where there was none within kMaxTime
        std::vector<SensorTime> newest;
        std::vector<Polarity> polarity;  ///< as `newest`
        std::vector<Tile> tiles;         ///< [row][column]
        std::optional<SensorTime> interval, last;
        double noise_hz = 0;
        bool measured = false;
        HotPixels::State hot_pixels;
        friend bool operator==(const State&, const State&) = default;
    };
    State state() const;
    /// Throws Error (input) for the state of another sensor, and is then as it was.
    void restore(const State& state);

private:
    static constexpr int kTile = 8;
    bool measure(const Event& event, bool hot, bool supported) noexcept;
    void advance(SensorTime t) noexcept;
    void begin_stream(SensorTime t) noexcept;
    bool is_quiet(const Tile& tile, double intervals) const noexcept;
    static bool is_alone(const Tile& tile) noexcept;
    void end_interval() noexcept;
    void set_noise(double hz) noexcept;

    NoiseFilterSettings settings_;
    HotPixels hot_pixels_;
    NewestEvents newest_;
    int tile_rows_, tile_columns_;
    double tile_pixels_;
    std::vector<Tile> tiles_;             // [row][column]
    std::vector<std::uint32_t> sorted_;   // scratch
    std::optional<SensorTime> interval_;  // its begin
    std::optional<SensorTime> last_;      // event
    double noise_hz_ = 0;
    bool measured_ = false;  // the noise, once; before, nothing is taken for quiet
    SensorDuration within_, quiet_within_;
};

/// "auto" or the constant time.
std::string noise_filter_text(const NoiseFilterSettings& settings);

/// "off"; "auto"; "model": auto where the model was trained so, else off; or a constant time such
/// as "10ms". Throws Error (usage).
std::optional<NoiseFilterSettings> parse_noise_filter(std::string_view text, bool models);

}  // namespace eventide
