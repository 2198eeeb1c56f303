// Packets of a live source that come while all buffers are in use: which are lost, and who is told.
#include "tests/pipeline/toy_pipeline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <semaphore>
#include <span>
#include <thread>
#include <vector>

namespace eventide {
namespace {

using namespace test;

TEST(Pipeline, HoldsABurstOfALiveSourceHoweverSmallItsPacketsAre) {
    EXPECT_EQ(packets_of_burst(0), 64U);
    EXPECT_EQ(packets_of_burst(std::size_t{128} << 10), 64U);
    EXPECT_EQ(packets_of_burst(std::size_t{8} << 10), 1024U)
        << "8 MiB, a fifth of a second at USB 2";
    EXPECT_EQ(packets_of_burst(1024), 1024U);
}

TEST(Pipeline, ALiveSourceLosesWhatASlowModelCannotTakeAndSaysSo) {
    constexpr std::size_t kPackets = 400, kReleasedAt = 200;
    PipelineSettings settings = quick_settings();
    settings.rate = {};
    settings.buffers = {4, 1, 1};
    PipelineUnderTest line(one_frame_per_packet(kPackets), settings, true);
    std::binary_semaphore released{0}, goes_on{0};
    line.encoder.before_encode = [&, calls = 0]() mutable {
        if (++calls == 1) released.acquire();
        if (calls == 3) goes_on.release();
    };
    line.source.before_read = [&](std::size_t packet) {
        if (packet == kReleasedAt) {
            released.release();
            goes_on.acquire();
        }
    };
    line.run();
    const Snapshot s = line.snapshot();
    EXPECT_EQ(s.packets, kPackets + 1) << "a live source is never made to wait";
    EXPECT_GE(s.lost_packets, kReleasedAt - 10);
    EXPECT_EQ(s.events + s.lost_packets, s.packets) << "one event each: nothing else is missing";
    EXPECT_EQ(s.lost_bytes, 14 * s.lost_packets);
    const auto marked = std::count_if(line.sink.seen.begin(), line.sink.seen.end(),
                                      [](const auto& seen) { return seen.gap; });
    EXPECT_GE(marked, 1);
    EXPECT_LE(std::uint64_t(marked), s.gaps) << "two gaps may fall into one event window";
    EXPECT_EQ(line.encoder.resets, 0) << "state is kept over a gap by default";
}

/// Was opened again before one of its packets; its parser counts how often it is told.
struct ReopenedSource final : Source {
    ReopenedSource(ToySource& toy, std::size_t before) : toy_(toy), before_(before) {}
    const SensorInfo& info() const override { return toy_.info(); }
    bool is_live() const noexcept override { return toy_.is_live(); }
    ReadStatus read(RawPacket& into) override {
        const ReadStatus status = toy_.read(into);
        into.gap_before = into.reopened = next_++ == before_;
        return status;
    }
    void stop() noexcept override { toy_.stop(); }
    std::unique_ptr<Parser> make_parser() const override {
        return std::make_unique<CountingParser>(toy_.make_parser(), told);
    }

    mutable int told = 0;

private:
    struct CountingParser final : Parser {
        CountingParser(std::unique_ptr<Parser> toy, int& told)
            : toy_(std::move(toy)), told_(told) {}
        void parse(std::span<const std::byte> bytes, Batch& into) override {
            toy_->parse(bytes, into);
        }
        void finish(Batch& into) override { toy_->finish(into); }
        void resync() override { toy_->resync(); }
        void reopened() override {
            ++told_;
            resync();
        }
        std::optional<SensorTime> clock() const override { return toy_->clock(); }
        const Damage& damaged() const override { return toy_->damaged(); }

    private:
        std::unique_ptr<Parser> toy_;
        int& told_;
    };

    ToySource& toy_;
    std::size_t before_, next_ = 0;
};

TEST(Pipeline, ThatACameraWasOpenedAgainIsNotLostWithAPacket) {
    constexpr std::size_t kPackets = 400, kReopenedAt = 100, kReleasedAt = 200;
    PipelineSettings settings = quick_settings();
    settings.rate = {};
    settings.buffers = {4, 1, 1};
    ToySource toy(one_frame_per_packet(kPackets), true);
    ReopenedSource source(toy, kReopenedAt);
    ToyEncoder encoder;
    ToyRenderer renderer;
    ToySink sink;
    Pipeline pipeline({source, encoder, renderer, {&sink}}, settings);
    std::binary_semaphore begun{0}, released{0}, goes_on{0};
    encoder.before_encode = [&, calls = 0]() mutable {
        if (++calls == 1) {
            begun.release();
            released.acquire();
        }
        if (calls == 3) goes_on.release();
    };
    std::uint64_t lost = 0;
    toy.before_read = [&](std::size_t packet) {
        // The encoder holds its window, and the binner has the next: nothing is taken any more.
        if (packet == kReopenedAt / 2) {
            begun.acquire();
            while (pipeline.snapshot().events < 3) std::this_thread::yield();
        }
        if (packet == kReopenedAt) lost = pipeline.snapshot().lost_packets;
        if (packet == kReopenedAt + 1) lost = pipeline.snapshot().lost_packets - lost;
        if (packet != kReleasedAt) return;
        released.release();
        goes_on.acquire();
    };
    pipeline.run();
    ASSERT_EQ(lost, 1U) << "the packet itself";
    EXPECT_EQ(source.told, 1);
}

/// Passes on everything, and waits with the events of one packet, the first.
struct WaitingFilter final : EventFilter {
    void process(std::vector<Event>&) override {
        if (calls++ == waits_at) goes_on.acquire();
        if (calls == 2) second_packet.release();
    }

    int calls = 0, waits_at = 0;
    std::binary_semaphore goes_on{0}, second_packet{0};
};

TEST(Pipeline, APacketOfALiveSourceIsNotLostWhereABufferIsFreeByTheTimeItIsThere) {
    PipelineSettings settings = quick_settings();
    settings.buffers.packets = 2;
    PipelineUnderTest line(one_frame_per_packet(2), settings, true);
    WaitingFilter filter;
    line.filter = &filter;
    line.source.before_read = [&](std::size_t packet) {
        if (packet != 2) return;  // both buffers are lent
        filter.goes_on.release();
        filter.second_packet.acquire();
    };
    line.run();
    EXPECT_EQ(line.snapshot().lost_packets, 0U);
    EXPECT_EQ(line.snapshot().events, 3U);
}

TEST(Pipeline, AGapIsToldOnceAndOnlyWhereBytesWereLost) {
    constexpr std::size_t kBuffers = 2, kReleasedAt = 10, kPackets = 15;
    for (const bool silent : {false, true}) {
        auto packets = one_frame_per_packet(kPackets - 1);
        packets[kReleasedAt - 1].clear();  // a timeout
        for (std::size_t i = kBuffers; silent && i < kReleasedAt; ++i) packets[i].clear();
        PipelineSettings settings = quick_settings();
        settings.buffers.packets = kBuffers;
        PipelineUnderTest line(packets, settings, true);
        WaitingFilter filter;
        line.filter = &filter;
        line.source.before_read = [&](std::size_t packet) {
            if (packet < kReleasedAt) return;  // from the third on there is no buffer
            if (packet == kReleasedAt) filter.goes_on.release();
            // From now on a packet comes when the one before is in the binner's hands.
            const std::size_t taken = packet - (kReleasedAt - kBuffers);
            while (line.made().snapshot().events < taken) std::this_thread::yield();
        };
        line.run();
        EXPECT_EQ(line.snapshot().lost_packets, silent ? 0U : kReleasedAt - 1 - kBuffers);
        EXPECT_EQ(line.snapshot().gaps, silent ? 0U : 1U);
    }
}

TEST(Pipeline, LearnsWhatAPacketTakesAndTakesNoneThatWouldBeLate) {
    constexpr std::size_t kPackets = 8;
    PipelineSettings settings = quick_settings();
    settings.latency = std::chrono::nanoseconds{1};  // any packet that waits would be late
    PipelineUnderTest line(one_frame_per_packet(kPackets - 1), settings, true);
    WaitingFilter filter;
    filter.waits_at = 1;
    line.filter = &filter;
    line.source.before_read = [&](std::size_t packet) {
        while (packet == 2 && line.made().snapshot().events < 2) std::this_thread::yield();
        if (packet == kPackets) filter.goes_on.release();
    };
    line.run();
    EXPECT_EQ(line.snapshot().events, 3U) << "one waits behind the one that is parsed";
    EXPECT_EQ(line.snapshot().lost_packets, kPackets - 3);
}

}  // namespace
}  // namespace eventide
