// An error in any part of the pipeline comes out, and takes nothing back.
#include "src/core/error.h"
#include "tests/pipeline/toy_pipeline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

namespace eventide {
namespace {

using namespace test;

struct FailingFilter final : EventFilter {
    void process(std::vector<Event>& events) override {
        seen += events.size();
        if (seen > 20) throw std::runtime_error("filter");
    }
    std::size_t seen = 0;
};

/// Makes one part of the pipeline fail; returns the sentence it fails with.
std::string break_part(PipelineUnderTest& line, const std::string& part, FailingFilter& filter) {
    const auto fail = [part](auto... at) {
        const bool now = (true && ... && (at == 20));
        if (now) throw std::runtime_error(part);
    };
    if (part == "source") line.source.before_read = fail;
    if (part == "parser") line.source.parser_fails_at_us = 20'000;
    if (part == "filter") line.filter = &filter;
    if (part == "sink") line.sink.before_write = fail;
    if (part == "close") line.sink.before_close = [fail] { fail(); };
    return part;
}

TEST(Pipeline, RethrowsAnErrorOfEachPartAndClosesTheSinks) {
    const auto packets = one_frame_per_packet(200);
    PipelineUnderTest healthy(packets, quick_settings());
    healthy.run();
    for (const std::string part : {"source", "parser", "filter", "sink", "close"})
        for (const bool threaded : {true, false})
            for (int round = 0; round < 20; ++round) {
                SCOPED_TRACE(part + (threaded ? " threaded" : " sequential"));
                FailingFilter filter;
                PipelineUnderTest line(packets, quick_settings());
                line.source.endless = part != "close";
                break_part(line, part, filter);
                try {
                    threaded ? line.run() : line.run_sequential();
                    ADD_FAILURE() << "no error";
                } catch (const std::runtime_error& error) {
                    EXPECT_EQ(error.what(), part);
                }
                EXPECT_EQ(line.sink.closed, 1);
                // What was written before is right: an error takes nothing back.
                ASSERT_LE(line.sink.seen.size(), healthy.sink.seen.size());
                EXPECT_TRUE(std::equal(line.sink.seen.begin(), line.sink.seen.end(),
                                       healthy.sink.seen.begin()));
            }
}

TEST(Pipeline, WritesWhatWasReadBeforeTheSourceFailed) {
    for (const bool threaded : {true, false}) {
        PipelineUnderTest line(one_frame_per_packet(200), quick_settings());
        line.source.before_read = [](std::size_t packet) {
            if (packet == 100) throw Error(ErrorKind::device, "unplugged");
        };
        EXPECT_THROW(threaded ? line.run() : line.run_sequential(), Error);
        EXPECT_EQ(line.sink.seen.back().t_us, 99'000)
            << "the last of the event windows up to 99001";
    }
}

TEST(Pipeline, KeepsTheFirstErrorOfTwo) {
    PipelineUnderTest line(one_frame_per_packet(200), quick_settings());
    line.sink.before_write = [](auto frame) {
        if (frame == 3) throw std::runtime_error("first");
    };
    line.sink.before_close = [] { throw std::runtime_error("second"); };
    try {
        line.run();
        ADD_FAILURE();
    } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), "first");
    }
}

TEST(Pipeline, WritesNoFrameAfterASinkHasFailed) {
    for (const bool threaded : {true, false}) {
        PipelineSettings settings = quick_settings();
        settings.lookahead = 2;  // frames of two windows still wait at the end
        PipelineUnderTest line(one_frame_per_packet(20), settings);
        int asked = 0;
        line.sink.before_write = [&](auto) {
            if (++asked == 3) throw std::runtime_error("disk is full");
        };
        EXPECT_THROW(threaded ? line.run() : line.run_sequential(), std::runtime_error);
        EXPECT_EQ(asked, 3) << (threaded ? "threaded" : "sequential");
    }
}

/// As an error of Python, which knows the functions that it went through and what they hold.
struct HoldingError final : std::runtime_error {
    explicit HoldingError(std::shared_ptr<int> what)
        : std::runtime_error("full"), held(std::move(what)) {}
    std::shared_ptr<int> held;
};

TEST(Pipeline, HoldsNoErrorThatItThrew) {
    for (const bool threaded : {true, false}) {
        auto held = std::make_shared<int>();
        const std::weak_ptr<int> watched = held;
        PipelineUnderTest line(one_frame_per_packet(20), quick_settings());
        line.sink.before_write = [&](auto) { throw HoldingError{std::exchange(held, {})}; };
        EXPECT_THROW(threaded ? line.run() : line.run_sequential(), HoldingError);
        EXPECT_TRUE(watched.expired()) << (threaded ? "threaded" : "sequential");
        EXPECT_FALSE(line.made().is_whole()) << "there was one all the same";
    }
}

}  // namespace
}  // namespace eventide
