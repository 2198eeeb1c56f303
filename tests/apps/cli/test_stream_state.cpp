// What a run remembers beside its networks, as a file: what comes back, and what is refused and
// why.
#include "apps/cli/run/state/stream_state.h"

#include "apps/cli/run/state/state_folder.h"
#include "src/core/error.h"
#include "tests/support/flickering_light.h"
#include "tests/system/process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <random>
#include <string>

namespace eventide::app {
namespace {

using testing::HasSubstr;

constexpr int kWidth = 16, kHeight = 12;

StreamState made_state() {
    std::mt19937 random{1};
    NoiseFilter filter{kWidth, kHeight, {}};
    std::vector<Event> events;
    for (std::int64_t us = 1; us < 3'000'000; us += 500)
        events.push_back({from_us(1'700'000'000'000'000 + us), std::uint16_t(random() % kWidth),
                          std::uint16_t(random() % kHeight),
                          random() % 2 == 0 ? Polarity::on : Polarity::off});
    const Event last = events.back();
    filter.process(events);
    StreamState state;
    state.window = "50ms";
    state.noise_filter = "auto";
    state.filters.noise = filter.state();
    state.lamp_flicker = "16ms";
    FlickerPairs flicker{kWidth, kHeight, SensorDuration{16'000}};
    std::vector<Event> lamp = test::lamp_events({.width = kWidth, .height = kHeight, .share = 1});
    const SensorDuration later = last.t - lamp.back().t;
    for (Event& event : lamp) event.t += later;
    flicker.process(lamp);
    state.filters.flicker = flicker.state();
    EXPECT_FALSE(state.filters.flicker->held.empty());
    state.stream.t = last.t + SensorDuration{7};
    state.stream.slicer = {last.t - SensorDuration{90'000'000'000},
                           last.t - SensorDuration{90'000'000'003},
                           last.t,
                           last.t,
                           last.t + SensorDuration{5},
                           3,
                           2,
                           true,
                           {{last.t - SensorDuration{80'000'000'000}, 15, 11, Polarity::on}, last}};
    state.stream.ages.assign(kWidth * kHeight, 8);
    state.stream.ages[5] = 3;
    return state;
}

TensorFile file_of(const StreamState& state) {
    TensorFile file{{{"format", "eventide-state"}}, {{"h.0", {{2}, {1, 2}}}}};
    put_stream_state(state, kWidth, file);
    return parse_safetensors(format_safetensors(file), "made");
}

std::string refusal(TensorFile file, int width = kWidth) {
    try {
        static_cast<void>(take_stream_state(file, "kept", width, kHeight));
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        return error.what();
    }
    return {};
}

TEST(StreamState, ComesBackAsItWas) {
    const StreamState kept = made_state();
    TensorFile file = file_of(kept);
    const auto back = take_stream_state(file, "kept", kWidth, kHeight);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->window, kept.window);
    EXPECT_EQ(back->noise_filter, kept.noise_filter);
    EXPECT_EQ(back->stream.t, kept.stream.t);
    EXPECT_EQ(back->stream.slicer, kept.stream.slicer);
    EXPECT_EQ(back->stream.ages, kept.stream.ages);
    EXPECT_EQ(back->filters.noise, kept.filters.noise);
    EXPECT_EQ(back->lamp_flicker, kept.lamp_flicker);
    EXPECT_EQ(back->filters.flicker, kept.filters.flicker);
    ASSERT_EQ(file.tensors.size(), 1U) << "the network's are left";
    EXPECT_TRUE(file.tensors.contains("h.0"));
}

TEST(StreamState, OfARunWithoutFilters) {
    StreamState kept = made_state();
    kept.filters.noise.reset();
    kept.filters.flicker.reset();
    TensorFile file = file_of(kept);
    const auto back = take_stream_state(file, "kept", kWidth, kHeight);
    ASSERT_TRUE(back);
    EXPECT_FALSE(back->filters.noise);
    EXPECT_FALSE(back->filters.flicker);
}

TEST(StreamState, TheNetworksAloneIsNone) {
    TensorFile file{{}, {{"h.0", {{2}, {1, 2}}}}};
    EXPECT_FALSE(take_stream_state(file, "kept", kWidth, kHeight));
}

TEST(StreamState, DamageIsNamed) {
    const TensorFile good = file_of(made_state());
    EXPECT_EQ(refusal(good), "") << "the whole file is accepted";
    EXPECT_THAT(refusal(good, kWidth + 1), HasSubstr("expected shape [12, 17], found [12, 16]"));
    for (const auto& [key, value] : good.metadata)
        if (key.starts_with("stream.")) {
            TensorFile bad = good;
            bad.metadata.erase(key);
            EXPECT_THAT(refusal(bad), HasSubstr("kept: state: expected '" + key + "'"));
            if (key == "stream.window" || key == "stream.noise_filter" ||
                key == "stream.lamp_flicker")
                continue;
            bad = good;
            bad.metadata[key] = "many";
            EXPECT_THAT(refusal(bad), HasSubstr("expected a whole number, found 'many'"));
        }
    for (const auto& [key, tensor] : good.tensors)
        if (key.starts_with("stream.")) {
            TensorFile bad = good;
            bad.tensors[key].values[0] = -7;
            EXPECT_THAT(refusal(bad), HasSubstr("tensor '" + key + "': expected whole numbers"));
            bad = good;
            bad.tensors[key].values[0] = 0.5;
            EXPECT_THAT(refusal(bad), HasSubstr("tensor '" + key + "': expected whole numbers"));
        }
    TensorFile outside = good;
    outside.tensors["stream.events"].values[2] = 16;
    EXPECT_THAT(refusal(outside), HasSubstr("found one at 16, 11"));
    outside.tensors["stream.events"].values[2] = 15;
    outside.tensors["stream.events"].values[3] = 12;
    EXPECT_THAT(refusal(outside), HasSubstr("found one at 15, 12"));
    TensorFile far = good;
    far.metadata["stream.begin_us"] = "9223372036854775807";
    EXPECT_THAT(refusal(far), HasSubstr("expected a time that a clock can have"));
}

TEST(StreamState, WhatIsNotKeptIsRefused) {
    const auto refused = [](auto change, bool live = false) -> std::string {
        RunSettings settings;
        settings.source = "a.aedat4";
        settings.frames = CameraFrames::ignore;
        change(settings);
        try {
            check_stream_state(settings, "--states-out", live);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            return error.what();
        }
        return {};
    };
    EXPECT_EQ(refused([](RunSettings&) {}), "");
    EXPECT_THAT(refused([](RunSettings&) {}, true), HasSubstr("expected a recording"));
    const test::TempFolder temp;
    const std::string pipe = temp / "pipe";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    for (const std::string& source : {std::string{"-"}, pipe})
        EXPECT_THAT(refused([&](RunSettings& s) { s.source = source; }),
                    HasSubstr("expected a recording that is a file, found " + source));
    EXPECT_THAT(refused([](RunSettings& s) { s.frames = CameraFrames::automatic; }),
                HasSubstr("--frames ignore"));
    EXPECT_THAT(refused([](RunSettings& s) { s.colour = true; }), HasSubstr("--colour"));
    EXPECT_THAT(refused([](RunSettings& s) { s.adjust.auto_hdr = true; }),
                HasSubstr("--states-out: expected frames without --auto-hdr"));
    EXPECT_THAT(refused([](RunSettings& s) { s.filter = {"region:0,0,8,8"}; }),
                HasSubstr("no --filter, found 'region:0,0,8,8'"));
    EXPECT_THAT(refused([](RunSettings& s) { s.hot_pixels = "learn"; }), HasSubstr("--hot-pixels"));
}

}  // namespace
}  // namespace eventide::app
