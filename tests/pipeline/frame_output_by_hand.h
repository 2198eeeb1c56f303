// Frames from latent maps that are given one by one.
#pragma once

#include "pipeline/frame_output.h"
#include "tests/support/toy_stages.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace eventide::test {

/// Event windows of 10 us from `begin_us` on, given one by one.
struct FrameOutputByHand {
    explicit FrameOutputByHand(int lookahead, FrameRate rate = {200'000, 1},  // a frame each 5 us
                               bool allow_silence = false)
        : output(
              renderer, {&sink}, {rate, {}, lookahead, false, 1, allow_silence, &changes},
              [] { return 0; }, stop, counters, keeper) {
        sink.before_write = [this](auto) {
            pushed.push_back(renderer.pushed());
            lookaheads.push_back(sink.lookahead);
        };
    }
    void give_after_gap(std::int64_t begin_us) { give(begin_us, false, true); }
    void give(std::int64_t begin_us, bool reset_before = false, bool gap_before = false) {
        Encoded encoded;
        encoded.latent.values = Array3<float>(kToyHeight, kToyWidth, 2);
        encoded.latent.window = {from_us(begin_us), from_us(begin_us + 10)};
        encoded.latent.events = 1;
        encoded.latent.reset_before = reset_before;
        encoded.latent.gap_before = gap_before;
        output.take(encoded);
    }
    void give_silence(std::int64_t begin_us, std::int64_t end_us) {
        Encoded encoded;
        encoded.latent.values = Array3<float>(kToyHeight, kToyWidth, 2);
        encoded.latent.window = {from_us(begin_us), from_us(end_us)};
        output.take(encoded);
    }
    std::vector<std::int64_t> times() const {
        std::vector<std::int64_t> times;
        for (const auto& seen : sink.seen) times.push_back(seen.t_us);
        return times;
    }

    ToyRenderer renderer;
    ToySink sink;
    std::vector<std::size_t> pushed;  // latent maps the renderer had, per frame
    std::vector<int> lookaheads;      // what the sink had been told, per frame
    StopRequest stop;
    Counters counters;
    LatencyKeeper keeper{{}};
    LiveChanges changes;
    FrameOutput output;
};

}  // namespace eventide::test
