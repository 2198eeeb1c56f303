// A run that goes on where another kept its state.
#include "tests/pipeline/toy_pipeline.h"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

namespace eventide {
namespace {

using namespace test;

/// Keeps what it is given: all that the network would know.
class GridsSeen final : public EncodeStage {
public:
    struct Seen {
        std::int64_t begin_us, end_us;
        std::vector<float> values;
        friend bool operator==(const Seen&, const Seen&) = default;
    };
    LatentMap make_output() const override { return ToyEncoder{}.make_output(); }
    void reset() noexcept override {}

    std::vector<Seen> seen;

private:
    void step(const VoxelGrid& grid, LatentMap&) noexcept override {
        const auto values = grid.values.values();
        seen.push_back(
            {to_us(grid.window.begin), to_us(grid.window.end), {values.begin(), values.end()}});
    }
};

struct GridRun {
    explicit GridRun(const std::vector<Event>& events, const PipelineSettings& given)
        : source{ToySource::packets_of(bytes_of(events), 700)}, settings{given} {}

    void run(bool threaded) {
        Pipeline pipeline{PipelineParts{source, encoder, renderer, {&sink}}, settings};
        threaded ? pipeline.run() : pipeline.run_sequential();
    }

    ToySource source;
    GridsSeen encoder;
    ToyRenderer renderer;
    ToySink sink;
    PipelineSettings settings;
};

class PipelineResume : public testing::TestWithParam<bool> {};

TEST_P(PipelineResume, GridsAreThoseOfOneRun) {
    // In bursts and pauses, so that pixels have had their last events in different windows.
    const std::vector<Event> events = toy_events(3000);
    const SensorTime middle = events[events.size() / 2].t;
    std::optional<PipelineState> kept;
    std::size_t encoded_then = 0;
    GridRun whole{events, quick_settings()};
    whole.settings.state_stops = {{middle}, [&](const PipelineState& state) {
                                      kept = state;
                                      encoded_then = whole.encoder.seen.size();
                                  }};
    whole.run(false);  // states are kept by runs of one thread alone
    ASSERT_TRUE(kept.has_value());
    EXPECT_EQ(kept->t, middle);
    ASSERT_GT(encoded_then, 10U);
    ASSERT_LT(encoded_then + 10, whole.encoder.seen.size());

    GridRun rest{events, quick_settings()};  // what is known already is left out
    rest.settings.resume = &*kept;
    rest.run(GetParam());
    whole.encoder.seen.erase(whole.encoder.seen.begin(),
                             whole.encoder.seen.begin() + std::ptrdiff_t(encoded_then));
    EXPECT_TRUE(rest.encoder.seen == whole.encoder.seen);
}

INSTANTIATE_TEST_SUITE_P(Run, PipelineResume, testing::Bool(),
                         [](const auto& each) { return each.param ? "Threaded" : "Sequential"; });

}  // namespace
}  // namespace eventide
