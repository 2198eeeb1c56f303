// The whole pipeline over toy parts, for tests of it.
#pragma once

#include "pipeline/pipeline.h"
#include "tests/support/toy_stages.h"

#include <memory>
#include <utility>
#include <vector>

namespace eventide::test {

inline PipelineSettings quick_settings() {
    PipelineSettings settings;
    settings.bins = 3;
    settings.event_windows.slicer.width = SensorDuration{1000};
    settings.rate = {2000, 1};
    return settings;
}

/// One run of the pipeline over toy parts.
struct PipelineUnderTest {
    PipelineUnderTest(std::vector<std::vector<std::byte>> packets,
                      const PipelineSettings& line_settings, bool live = false)
        : source(std::move(packets), live), settings(line_settings) {}

    Pipeline& made() {
        if (!pipeline)
            pipeline = std::make_unique<Pipeline>(
                PipelineParts{source, encoder, renderer, {&sink}, filter}, settings);
        return *pipeline;
    }
    void run() { made().run(); }
    void run_sequential() { made().run_sequential(); }
    Snapshot snapshot() const { return pipeline->snapshot(); }

    ToySource source;
    ToyEncoder encoder;
    ToyRenderer renderer;
    ToySink sink;
    EventFilter* filter = nullptr;
    PipelineSettings settings;
    std::unique_ptr<Pipeline> pipeline;
};

/// One event in each of n event windows of 1000 us, one packet each, and one packet that ends them.
inline std::vector<std::vector<std::byte>> one_frame_per_packet(std::size_t n) {
    std::vector<std::vector<std::byte>> packets(n + 1);
    for (std::size_t i = 0; i <= n; ++i)
        append_record(packets[i], ToyKind::event, std::int64_t(1000 * i + 1), int(i % kToyWidth));
    return packets;
}

}  // namespace eventide::test
