// A small source, model and sink, with handles to make them slow or fail: the pipeline is tested
// with them.
#pragma once

#include "pipeline/sink.h"
#include "pipeline/source.h"
#include "pipeline/stages.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

namespace eventide::test {

constexpr int kToyHeight = 6, kToyWidth = 8;

// ---- the toy wire format: records of 14 bytes --------------------------------------------------

enum class ToyKind : std::uint8_t { event, clock, image };

void append_record(std::vector<std::byte>& bytes, ToyKind kind, std::int64_t t_us, int x = 0,
                   int y = 0, bool on = true);

std::vector<std::byte> bytes_of(const std::vector<Event>& events);

/// Events everywhere, bursts and pauses; the same for the same seed.
std::vector<Event> toy_events(std::size_t n, unsigned seed = 1, std::int64_t begin_us = 1000);

class ToyParser final : public Parser {
public:
    explicit ToyParser(std::optional<std::int64_t> fails_at_us = {}) : fails_at_us_(fails_at_us) {}
    void parse(std::span<const std::byte> bytes, Batch& into) override;
    void finish(Batch& into) override;
    void resync() override { held_.clear(); }
    std::optional<SensorTime> clock() const override { return clock_; }
    const Damage& damaged() const override { return damaged_; }

private:
    void take_record(const std::byte* record, Batch& into);

    std::optional<std::int64_t> fails_at_us_;
    std::vector<std::byte> held_;  // less than a record
    std::optional<SensorTime> clock_;
    SensorTime newest_event_ = SensorTime::min();
    Damage damaged_;
};

// ---- the ends ----------------------------------------------------------------------------------

/// Gives packets made before. Thread: as Source says; `before_read` runs on the source thread.
class ToySource final : public Source {
public:
    explicit ToySource(std::vector<std::vector<std::byte>> packets, bool live = false,
                       int height = kToyHeight, int width = kToyWidth);

    /// The events in packets of so many bytes, or with `rng` of 0 to 2 n bytes.
    static std::vector<std::vector<std::byte>> packets_of(std::span<const std::byte> bytes,
                                                          std::size_t n, std::mt19937* rng = {});

    const SensorInfo& info() const override { return info_; }
    bool is_live() const noexcept override { return live_; }
    ReadStatus read(RawPacket& into) override;
    void stop() noexcept override { stopped_ = true; }
    std::unique_ptr<Parser> make_parser() const override;

    bool is_stopped() const { return stopped_; }

    std::function<void(std::size_t packet)> before_read;  ///< may throw, wait, stop
    std::optional<std::int64_t> parser_fails_at_us;
    bool endless = false;  ///< the last packet again and again

private:
    SensorInfo info_;
    std::vector<std::vector<std::byte>> packets_;
    bool live_;
    std::size_t next_ = 0;
    std::atomic<bool> stopped_{false};
};

/// Keeps what it is given.
class ToySink final : public Sink {
public:
    struct Seen {
        std::int64_t t_us, begin_us, end_us;
        std::uint64_t index, events;
        bool gap;
        std::vector<float> intensity, sigma, preview;
        friend bool operator==(const Seen&, const Seen&) = default;
    };

    void write(const Frame& frame) override;
    void lookahead_is(int windows) override { lookahead = windows; }
    void close() override;
    bool wants_more() const override { return count < wants; }

    std::vector<Seen> seen;
    bool keeps = true;  ///< false: only counts, and does not allocate
    std::uint64_t count = 0, wants = UINT64_MAX;
    int closed = 0;
    int lookahead = -1;  ///< that was told last
    std::function<void(std::uint64_t frame)> before_write;
    std::function<void()> before_close;
};

// ---- the model ---------------------------------------------------------------------------------

/// Each pixel's latent remembers all grids before.
class ToyEncoder final : public EncodeStage {
public:
    explicit ToyEncoder(int height = kToyHeight, int width = kToyWidth)
        : state_(height, width, 2) {}
    LatentMap make_output() const override;
    void reset() noexcept override;

    std::function<void()> before_encode;
    int resets = 0;

private:
    void step(const VoxelGrid& grid, LatentMap& latent) noexcept override;

    Array3<float> state_;
};

/// Frames depend on t and on every latent map pushed, so that one too few or too many shows.
class ToyRenderer final : public RenderStage {
public:
    explicit ToyRenderer(int height = kToyHeight, int width = kToyWidth)
        : height_(height), width_(width) {
        kept_.fill(Array3<float>(height, width, 2));
    }
    Frame make_output() const override;
    void take(LatentMap& latent) noexcept override;
    void finish() noexcept override { finished = true; }
    void render(SensorTime t, const Window& window, Frame& frame) noexcept override;
    void reset() noexcept override;

    bool change_lookahead(int) override { return changeable; }

    bool finished = false, changeable = true;
    std::size_t pushed() const { return count_; }  ///< since the last reset

private:
    int height_, width_;
    std::array<Array3<float>, 4> kept_;  // [y][x][2], a ring
    std::size_t count_ = 0;
};

}  // namespace eventide::test
