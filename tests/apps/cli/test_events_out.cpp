// What a run writes of the data it reconstructs from.
#include "apps/cli/run/events_out.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

namespace eventide::app {
namespace {

/// Keeps what it is given, each call apart.
struct KeptBatches final : ConvertTarget {
    explicit KeptBatches(std::vector<Batch>& all) : batches(all) {}
    const FormatHolds& holds() const override {
        static const FormatHolds kAll{.events = true, .images = true};
        return kAll;
    }
    void write(const Batch& batch) override { batches.push_back(batch); }
    void finish() override {}
    std::uint64_t bytes_written() const override { return 0; }
    std::vector<Batch>& batches;
};

Batch image_at(std::int64_t us) {
    Batch batch;
    batch.images.push_back({});
    batch.images.back().t = from_us(us);
    return batch;
}

TEST(EventsOut, ImagesDoNotWaitForEvents) {
    std::vector<Batch> written;
    EventsOut out{nullptr, std::make_unique<KeptBatches>(written), {}, {}};
    for (int n = 0; n < 3; ++n) {
        out.see(image_at(n));
        EXPECT_EQ(written.size(), std::size_t(n + 1)) << "nothing is kept";
    }
    Batch both = image_at(7);
    both.events.push_back({from_us(8), 1, 1, Polarity::on});
    out.see(both);
    out.process(both.events);
    ASSERT_EQ(written.size(), 4U);
    EXPECT_EQ(written.back().images.size(), 1U);
    EXPECT_EQ(written.back().events.size(), 1U) << "together, as they came";
}

}  // namespace
}  // namespace eventide::app
