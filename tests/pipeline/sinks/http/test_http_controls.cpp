// Controls of the page, and its pause.
#include "tests/pipeline/sinks/http/served.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <atomic>
#include <string>
#include <thread>

namespace eventide::test {
namespace {

using testing::HasSubstr;

TEST(HttpSink, ChangesControls) {
    std::atomic<double> fps{30};
    HttpSettings settings;
    settings.controls = {{"fps", "Rate", "frames/s", 1, 1000, 1, [&] { return fps.load(); },
                          [&](double wanted) { fps = wanted; }}};
    const auto sink = open_page(std::move(settings));
    auto client = client_of(*sink);
    const auto answer = client.Post("/controls", R"({"fps": 120})", "application/json");
    ASSERT_EQ(answer->status, 200);
    EXPECT_EQ(fps, 120);
    EXPECT_EQ(nlohmann::json::parse(answer->body)[0]["value"], 120);
    const auto refused = client.Post("/controls", R"({"fps": 5000})", "application/json");
    EXPECT_EQ(refused->status, 400);
    EXPECT_EQ(refused->body, "fps: expected a number from 1 to 1000, found 5000\n");
    EXPECT_EQ(client.Post("/controls", R"({"fps": 9})", "text/plain")->status, 415);
    EXPECT_EQ(client.Post("/frame.png", "{}", "application/json")->status, 404);
    EXPECT_EQ(fps, 120);
}

TEST(HttpSink, PauseHoldsOneFrameForAll) {
    const auto sink = open_page();
    const Frames frames{*sink};
    auto client = client_of(*sink);
    ASSERT_EQ(client.Post("/controls", R"({"pause": true})", "application/json")->status, 200);
    std::string index;
    // What was written while the request was on its way is not the held one yet.
    ASSERT_TRUE(becomes_true([&] {
        const std::string before = index;
        index = client.Get("/frame.png")->get_header_value("X-Frame-Index");
        return index == before;
    }));
    const int written = frames.written();
    EXPECT_EQ(client_of(*sink).Get("/sigma.tiff")->get_header_value("X-Frame-Index"), index);
    EXPECT_EQ(frames.written(), written);
    ASSERT_EQ(client.Post("/controls", R"({"pause": 0})", "application/json")->status, 200);
    EXPECT_TRUE(becomes_true([&] { return frames.written() > written + 10; }));
}

TEST(HttpSink, PauseEndsWhenNobodyIsLeftToEndIt) {
    HttpSettings settings;
    settings.forgotten_after = std::chrono::milliseconds{50};
    const auto sink = open_page(std::move(settings));
    ASSERT_EQ(client_of(*sink).Post("/controls", R"({"pause": 1})", "application/json")->status,
              200);
    sink->write(ramp_frame(64, 48, 0, odd_time(0)));  // would never return
    EXPECT_GE(sink->held(), std::chrono::milliseconds{40}) << "no work";
    sink->write(ramp_frame(64, 48, 1, odd_time(1)));
    EXPECT_LT(sink->held(), std::chrono::milliseconds{40});
    EXPECT_THAT(client_of(*sink).Get("/controls")->body, HasSubstr("\"value\":0.0"));
}

TEST(HttpSink, PauseGoesOnForAsLongAsSomebodyWatches) {
    std::atomic<bool> stopping{false};
    HttpSettings settings;
    settings.forgotten_after = std::chrono::milliseconds{1};
    settings.give_up = [&] { return stopping.load(); };
    const auto sink = open_page(std::move(settings));
    const RawClient viewer{*sink};
    viewer.send(request("GET /stream"));
    ASSERT_EQ(status_of(viewer.receive(20)), 200);
    ASSERT_EQ(client_of(*sink).Post("/controls", R"({"pause": 1})", "application/json")->status,
              200);
    const std::jthread writing{[&] { sink->write(ramp_frame(64, 48, 0, odd_time(0))); }};
    EXPECT_TRUE(becomes_true([&] { return client_of(*sink).Get("/frame.png")->status == 200; }));
    for (int i = 0; i < 20; ++i)
        EXPECT_EQ(client_of(*sink).Get("/frame.png")->status, 200) << "again to those who come";
    EXPECT_THAT(client_of(*sink).Get("/controls")->body, HasSubstr("\"value\":1.0"));
    stopping = true;
}

TEST(HttpSink, PauseEndsWhenTheRunIsStopped) {
    std::atomic<bool> stopping{false};
    HttpSettings settings;
    settings.give_up = [&] { return stopping.load(); };
    const auto sink = open_page(std::move(settings));
    ASSERT_EQ(client_of(*sink).Post("/controls", R"({"pause": 1})", "application/json")->status,
              200);
    std::atomic<bool> returned{false};
    const std::jthread writing{[&] {
        sink->write(ramp_frame(64, 48, 0, odd_time(0)));
        returned = true;
    }};
    stopping = true;
    EXPECT_TRUE(becomes_true([&] { return returned.load(); }));
}

}  // namespace
}  // namespace eventide::test
