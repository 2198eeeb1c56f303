// What stands around the answers: headers, kinds, and counts of whom they go to.
#include "src/core/error.h"
#include "tests/pipeline/sinks/http/served.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace eventide::test {
namespace {

using testing::HasSubstr;

TEST(HttpAnswers, PagesOfOtherSitesAreKeptFromAllOfThem) {
    HttpSettings settings;
    settings.token = "abc";
    const auto sink = open_page(std::move(settings));
    for (const char* path : {"/?token=abc", "/metrics?token=abc", "/nothing?token=abc", "/"}) {
        const auto answer = client_of(*sink).Get(path);
        EXPECT_EQ(answer->get_header_value("X-Content-Type-Options"), "nosniff") << path;
        EXPECT_EQ(answer->get_header_value("Cross-Origin-Resource-Policy"), "same-origin") << path;
        EXPECT_EQ(answer->get_header_value("Referrer-Policy"), "no-referrer") << path;
        EXPECT_EQ(answer->get_header_value("Cache-Control"), "no-store") << path;
        for (const char* rule : {"default-src 'none'", "frame-ancestors 'none'", "base-uri 'none'",
                                 "form-action 'none'"})
            EXPECT_THAT(answer->get_header_value("Content-Security-Policy"), HasSubstr(rule))
                << path;
    }
}

TEST(HttpAnswers, ARefusalSaysWhatWouldDo) {
    HttpSettings settings;
    settings.token = "abc";
    const auto sink = open_page(std::move(settings));
    EXPECT_EQ(client_of(*sink).Get("/")->get_header_value("WWW-Authenticate"), "Bearer");
    const auto other = client_of(*sink).Delete("/controls");
    EXPECT_EQ(other->status, 405);
    EXPECT_EQ(other->get_header_value("Allow"), "GET, HEAD, POST");
    EXPECT_FALSE(other->has_header("WWW-Authenticate"));
}

TEST(HttpAnswers, SayWhatTheyAre) {
    const auto sink = open_page();
    const Frames frames{*sink};
    auto client = client_of(*sink);
    for (const auto& [path, kind] : {std::pair{"/", "text/html; charset=utf-8"},
                                     {"/page.js", "text/javascript; charset=utf-8"},
                                     {"/page.css", "text/css; charset=utf-8"},
                                     {"/controls", "application/json"},
                                     {"/frame.jpg", "image/jpeg"},
                                     {"/sigma.tiff", "image/tiff"},
                                     {"/nothing", "text/plain; charset=utf-8"}})
        EXPECT_EQ(client.Get(path)->get_header_value("Content-Type"), kind) << path;
    EXPECT_EQ(client.Get("/favicon.ico")->status, 204) << "there is none, and that is no error";
}

TEST(HttpAnswers, OfAFrameWithoutSigmaThereIsNoTiff) {
    const auto sink = open_page();
    const std::jthread frames{[&sink](const std::stop_token& stop) {
        Frame frame = ramp_frame(16, 16, 0, odd_time(0));
        frame.sigma = {};
        while (!stop.stop_requested()) sink->write(frame);
    }};
    const auto answer = client_of(*sink).Get("/sigma.tiff");
    EXPECT_EQ(answer->status, 404);
    EXPECT_THAT(answer->body, HasSubstr("no sigma"));
}

/// The first image of a stream that asks for nothing of its own.
cv::Mat streamed(Uncertainty how) {
    HttpSettings settings;
    settings.uncertainty = how;
    const auto sink = open_page(std::move(settings));
    const Frames frames{*sink};
    std::string stream;
    client_of(*sink).Get("/stream", [&](const char* bytes, std::size_t size) {
        stream.append(bytes, size);
        return stream.find("\r\n--frame") == stream.npos;
    });
    const auto begin = std::ptrdiff_t(stream.find("\r\n\r\n") + 4);
    return cv::imdecode(std::vector<char>(stream.begin() + begin, stream.end()),
                        cv::IMREAD_UNCHANGED);
}

TEST(HttpAnswers, AStreamShowsSigmaAsTheOtherSinksDo) {
    EXPECT_EQ(streamed(Uncertainty::none).cols, 64);
    EXPECT_EQ(streamed(Uncertainty::none).channels(), 1);
    EXPECT_EQ(streamed(Uncertainty::side).cols, 2 * 64);
    EXPECT_EQ(streamed(Uncertainty::overlay).channels(), 3);
}

TEST(HttpAnswers, LettersThatMeanSomethingInHtmlAreWritten) {
    HttpSettings settings;
    settings.title = R"(a<b>&"c'd)";
    const auto sink = open_page(std::move(settings));
    EXPECT_THAT(client_of(*sink).Get("/")->body, HasSubstr("a&#60;b&#62;&#38;&#34;c&#39;d"));
}

TEST(HttpAnswers, AControlThatFailsIsNoMistakeOfWhoAsked) {
    HttpSettings settings;
    settings.controls = {
        {"gain",
         "",
         "",
         0,
         9,
         1,
         {},
         [](double) { throw Error(ErrorKind::failed, "the camera does not answer"); }},
        {"rate", "", "", 0, 9, 1, {}, [](double) { throw std::runtime_error{"no memory"}; }}};
    const auto sink = open_page(std::move(settings));
    const auto post = [&](const char* json) {
        return client_of(*sink).Post("/controls", json, "application/json");
    };
    EXPECT_EQ(post(R"({"gain": 1})")->status, 500);
    EXPECT_EQ(post(R"({"gain": 1})")->body, "the camera does not answer\n");
    EXPECT_EQ(post(R"({"rate": 0})")->status, 500);
}

TEST(HttpAnswers, WhoAsksForOneFrameIsAViewer) {
    const auto sink = open_page();
    std::vector<RawClient> viewers;
    for (int i = 0; i < HttpSink::kMaxViewers; ++i) {
        viewers.emplace_back(*sink).send(request("GET /stream"));
        ASSERT_EQ(status_of(viewers.back().receive(20)), 200) << i;
    }
    const auto refused = client_of(*sink).Get("/frame.png");
    EXPECT_EQ(refused->status, 503);
    EXPECT_EQ(refused->body, "16 viewers of frames are here already, which is the most\n");
}

/// The n-th of the server-sent events.
nlohmann::json statistics(const HttpSink& sink, int n) {
    std::string text;
    client_of(sink).Get("/stats", [&](const char* bytes, std::size_t size) {
        text.append(bytes, size);
        int ends = 0;
        for (std::size_t at = 0; (at = text.find("\n\n", at)) != text.npos; at += 2) ++ends;
        return ends < n;
    });
    std::size_t begin = 0;
    for (int i = 1; i < n; ++i) begin = text.find("\n\n", begin) + 2;
    return nlohmann::json::parse(text.substr(begin + 6, text.find("\n\n", begin) - begin - 6));
}

TEST(HttpAnswers, StatisticsTellWhoLooksAndHowFastEventsCome) {
    std::atomic<std::uint64_t> events{0};
    HttpSettings settings;
    settings.sigma_white = 0.25F;
    settings.snapshot = [&] {
        Snapshot now;
        now.events = events += 1'000'000;
        return now;
    };
    settings.stats = [](double event_rate) { return std::to_string(event_rate); };
    const auto sink = open_page(std::move(settings));
    const RawClient viewer{*sink};
    viewer.send(request("GET /stream"));
    ASSERT_EQ(status_of(viewer.receive(20)), 200);
    const auto first = statistics(*sink, 1);
    EXPECT_EQ(first["viewers"], 1);
    EXPECT_THAT(client_of(*sink).Get("/metrics")->body, HasSubstr("\neventide_http_viewers 1\n"));
    EXPECT_EQ(first["most_viewers"], HttpSink::kMaxViewers);
    EXPECT_EQ(first["sigma_white"], 0.25);
    EXPECT_EQ(first["run"], 0) << "of no time";
    EXPECT_GT(statistics(*sink, 4)["run"], 0);
}

TEST(HttpAnswers, SixteenReadStatisticsAndNoMore) {
    const auto sink = open_page();
    std::vector<RawClient> listeners;
    for (int i = 0; i < HttpSink::kMaxViewers; ++i) {
        listeners.emplace_back(*sink).send(request("GET /stats"));
        ASSERT_EQ(status_of(listeners.back().receive(20)), 200) << i;
    }
    const auto refused = client_of(*sink).Get("/stats");
    EXPECT_EQ(refused->status, 503);
    EXPECT_EQ(refused->body, "16 viewers of statistics are here already, which is the most\n");
    const std::string counts = client_of(*sink).Get("/metrics")->body;
    EXPECT_THAT(counts, HasSubstr("\neventide_http_viewers 0\n"));
    EXPECT_THAT(counts, HasSubstr("\neventide_http_listeners 16\n"));
    EXPECT_THAT(counts, HasSubstr("\neventide_http_refused_total 1\n"));
}

}  // namespace
}  // namespace eventide::test
