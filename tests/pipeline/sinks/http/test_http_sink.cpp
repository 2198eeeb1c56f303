// What the page tells beside its frames, and to whom.
#include "src/core/error.h"
#include "tests/pipeline/sinks/http/served.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace eventide::test {
namespace {

using testing::HasSubstr;

TEST(HttpSink, TellsCountersAsServerSentEvents) {
    HttpSettings settings;
    settings.stats = [](double) { return R"({"frames":7})"; };
    const auto sink = open_page(std::move(settings));
    auto client = client_of(*sink);
    std::string text;
    client.Get("/stats", [&](const char* bytes, std::size_t size) {
        text.append(bytes, size);
        return text.find("\n\n", text.find("\n\n") + 2) == text.npos;
    });
    ASSERT_TRUE(text.starts_with("data: ")) << text;
    const auto json = nlohmann::json::parse(text.substr(6, text.find("\n\n") - 6));
    EXPECT_EQ(json["run"]["frames"], 7);
    EXPECT_EQ(json["controls"].back()["name"], "pause");
    EXPECT_THAT(json["camera_incidents"].get<std::vector<std::string>>(),
                testing::ElementsAre("dropped_events", "lost_transfers", "damaged_transfers",
                                     "cut_transfers", "stalls", "reconnects"));
}

TEST(HttpSink, CountsWhatItRefused) {
    const auto sink = open_page();
    EXPECT_THAT(client_of(*sink).Get("/metrics")->body,
                HasSubstr("\neventide_http_refused_total 0\n"));
    EXPECT_EQ(client_of(*sink).Post("/controls", "{}", "text/plain")->status, 415);
    EXPECT_THAT(client_of(*sink).Get("/metrics")->body,
                HasSubstr("\neventide_http_refused_total 1\n"));
}

TEST(HttpSink, TellsCountersAsPrometheusReadsThem) {
    HttpSettings settings;
    settings.snapshot = [] {
        Snapshot now;
        now.events = 12'345'678'901;
        now.lost_packets = 3;
        now.lost_bytes = 500;
        now.frames = 2;
        now.newest_frame = from_us(1'500'000);
        now.camera.emplace();
        now.camera->set(CameraCount::dropped_events, 7);
        return now;
    };
    const auto sink = open_page(std::move(settings));
    const auto answer = client_of(*sink).Get("/metrics");
    EXPECT_THAT(answer->get_header_value("Content-Type"), HasSubstr("version=0.0.4"));
    EXPECT_THAT(answer->body, HasSubstr("\neventide_events_total 12345678901\n"));
    EXPECT_THAT(answer->body, HasSubstr("\neventide_lost_packets_total 3\n"));
    EXPECT_THAT(answer->body, HasSubstr("\neventide_lost_bytes_total 500\n"));
    EXPECT_THAT(answer->body, HasSubstr("\neventide_newest_frame_seconds 1.5\n"));
    EXPECT_THAT(answer->body, HasSubstr("\neventide_camera_dropped_events_total 7\n"));
    EXPECT_THAT(answer->body, HasSubstr("\neventide_camera_reconnects_total 0\n"));
    const std::regex comment{"# (HELP|TYPE) eventide_[a-z_]+ .+"},
        sample{R"re(eventide_[a-z_]+(\{[a-z]+="[a-z0-9_.]+"\})? [0-9.e+-]+)re"};
    std::istringstream lines{answer->body};
    for (std::string line; std::getline(lines, line);)
        EXPECT_TRUE(std::regex_match(line, line.front() == '#' ? comment : sample)) << line;
}

TEST(HttpSink, CopiesNothingWhileNobodyLooks) {
    const auto sink = open_page();
    for (int n = 0; n < 1000; ++n) sink->write(ramp_frame(64, 48, n, odd_time(n)));
    EXPECT_EQ(sink->copied(), 0U);
    const Frames frames{*sink};
    EXPECT_EQ(client_of(*sink).Get("/frame.png")->status, 200);
    const auto copied = sink->copied();
    EXPECT_GE(copied, 1U) << "the counter counts";
    const int written = frames.written();
    ASSERT_TRUE(becomes_true([&] { return frames.written() > written + 200; }));
    EXPECT_EQ(sink->copied(), copied);
}

TEST(HttpSink, RefusesWhatItCannotShow) {
    HttpSettings settings;
    settings.uncertainty = Uncertainty::alpha;
    EXPECT_THROW(open_page(settings), Error);
    settings = {};
    settings.address.host = "no-such-host.invalid";
    EXPECT_THROW(open_page(settings), Error);
}

TEST(HttpSink, AsksForItsToken) {
    HttpSettings settings;
    settings.token = "abc";
    const auto sink = open_page(std::move(settings));
    const Frames frames{*sink};
    auto client = client_of(*sink);
    EXPECT_EQ(client.Get("/")->status, 401);
    EXPECT_EQ(client.Get("/frame.png")->status, 401);
    EXPECT_EQ(client.Get("/?token=abc")->status, 200);
    EXPECT_EQ(client.Get("/frame.png?token=abc")->status, 200);
    EXPECT_EQ(client.Get("/metrics", {{"Authorization", "Bearer abc"}})->status, 200);
    EXPECT_EQ(client.Post("/controls", "{}", "application/json")->status, 401);
    EXPECT_EQ(client.Post("/controls?token=abc", "{}", "application/json")->status, 200);
}

TEST(HttpSink, PageLoadsNothingFromElsewhereAndSourceNamesAreText) {
    HttpSettings settings;
    settings.title = "<script>alert(1)</script>.aedat4";
    const auto sink = open_page(std::move(settings));
    const auto page = client_of(*sink).Get("/");
    EXPECT_EQ(page->body.find("<script>alert"), std::string::npos);
    EXPECT_EQ(page->body.find("@TITLE@"), std::string::npos);
    EXPECT_EQ(page->body.find("://"), std::string::npos);
    EXPECT_THAT(page->get_header_value("Content-Security-Policy"), HasSubstr("default-src 'none'"));
    EXPECT_THAT(client_of(*sink).Get("/page.js")->body, HasSubstr("watchFrames()"));
    EXPECT_THAT(client_of(*sink).Get("/page.css")->body, HasSubstr("--accent"));
}

}  // namespace
}  // namespace eventide::test
