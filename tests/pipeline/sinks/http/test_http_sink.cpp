// What the page gives to clients that behave.
#include "pipeline/sinks/http/shown_frame.h"
#include "src/core/error.h"
#include "tests/pipeline/sinks/http/served.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include <regex>
#include <sstream>
#include <vector>

namespace eventide::test {
namespace {

using testing::HasSubstr;

cv::Mat decoded(const std::string& bytes) {
    return cv::imdecode(std::vector<char>(bytes.begin(), bytes.end()), cv::IMREAD_UNCHANGED);
}

/// The frame that an answer is of.
Frame frame_of(const httplib::Result& answer) {
    const int n = std::stoi(answer->get_header_value("X-Frame-Index"));
    return ramp_frame(64, 48, n, odd_time(n));
}

TEST(HttpSink, GivesAFrameAsPngAndItsSigmaAsTiff) {
    const auto sink = open_page();
    const Frames frames{*sink};
    auto client = client_of(*sink);
    const auto png = client.Get("/frame.png");
    ASSERT_TRUE(png && png->status == 200);
    EXPECT_EQ(png->get_header_value("Content-Type"), "image/png");
    Frame frame = frame_of(png);
    EXPECT_EQ(png->get_header_value("X-Time-Us"), std::to_string(to_us(frame.t)));
    cv::Mat expected;
    draw(frame, Uncertainty::none, kSigmaWhite, expected);
    EXPECT_EQ(cv::norm(decoded(png->body), expected, cv::NORM_INF), 0);

    const auto tiff = client.Get("/sigma.tiff");
    ASSERT_TRUE(tiff && tiff->status == 200);
    frame = frame_of(tiff);
    const cv::Mat sigma = decoded(tiff->body);
    ASSERT_EQ(sigma.type(), CV_32FC1);
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x) ASSERT_EQ(sigma.at<float>(y, x), frame.sigma(y, x));
}

TEST(HttpSink, PromisesNoPartsOfWhatIsNewEachTime) {
    const auto sink = open_page();
    const Frames frames{*sink};
    auto client = client_of(*sink);
    EXPECT_EQ(client.Head("/frame.png")->get_header_value("Accept-Ranges"), "none");
    const auto part = client.Get("/page.js", {httplib::make_range_header({{0, 9}})});
    EXPECT_EQ(part->status, 200);
    EXPECT_EQ(part->body, client.Get("/page.js")->body);
}

TEST(HttpSink, ShowsSigmaInTheWaysOfTheOtherSinks) {
    const auto sink = open_page();
    const Frames frames{*sink};
    auto client = client_of(*sink);
    EXPECT_EQ(decoded(client.Get("/frame.jpg?show=side")->body).cols, 128);
    EXPECT_EQ(decoded(client.Get("/frame.jpg?show=overlay")->body).channels(), 3);
    EXPECT_EQ(decoded(client.Get("/frame.jpg?show=sigma")->body).channels(), 1);
    const auto png = client.Get("/frame.png?show=side");
    cv::Mat expected;
    draw(frame_of(png), Uncertainty::side, kSigmaWhite, expected);
    EXPECT_EQ(cv::norm(decoded(png->body), expected, cv::NORM_INF), 0);
    EXPECT_EQ(client.Get("/frame.jpg?show=everything")->status, 400);
    EXPECT_EQ(client.Get("/stream?fps=0")->status, 400);
    EXPECT_EQ(client.Get("/stream?fps=1001")->status, 400);
    EXPECT_EQ(client.Get("/nothing")->status, 404);
}

TEST(HttpSink, RefusesToShowASigmaThatIsNotThere) {
    HttpSettings settings;
    settings.uncertainty = Uncertainty::none;
    const auto sink = open_page(std::move(settings));
    const Frames frames{*sink};
    auto client = client_of(*sink);
    for (const char* path :
         {"/frame.png?show=sigma", "/frame.jpg?show=side", "/stream?show=overlay"}) {
        std::string words;
        const auto answer = client.Get(path, [&](const char* bytes, std::size_t size) {
            words.append(bytes, size);
            return words.size() < 200;  // of a stream there is no end
        });
        ASSERT_TRUE(answer) << path;
        EXPECT_EQ(answer->status, 400) << path;
        EXPECT_THAT(words, HasSubstr("no sigma (--uncertainty none)")) << path;
    }
    EXPECT_EQ(client.Get("/frame.png?show=intensity")->status, 200);
}

TEST(HttpSink, AStreamsTimesKeepTheirSign) {
    const auto sink = open_page();
    // The first frame of a recording from 0 shows the microsecond before it.
    const std::jthread frames{[&sink](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            sink->write(ramp_frame(16, 16, 0, from_us(-1)));
            std::this_thread::yield();
        }
    }};
    std::string stream;
    client_of(*sink).Get("/stream", [&](const char* bytes, std::size_t size) {
        stream.append(bytes, size);
        return stream.find("\r\n\r\n") == stream.npos;
    });
    EXPECT_NE(stream.find("X-Timestamp: -0.000001\r\n"), std::string::npos) << stream;
}

TEST(HttpSink, StreamsWholeJpegsWithTheirTimes) {
    const auto sink = open_page();
    const Frames frames{*sink};
    auto client = client_of(*sink);
    std::string stream, type;
    client.Get(
        "/stream",
        [&](const httplib::Response& answer) {
            type = answer.get_header_value("Content-Type");
            return answer.status == 200;
        },
        [&](const char* bytes, std::size_t size) {
            stream.append(bytes, size);
            return stream.size() < 30'000;
        });
    EXPECT_EQ(type, "multipart/x-mixed-replace; boundary=frame");
    const std::regex head{
        "^--frame\r\nContent-Type: image/jpeg\r\nContent-Length: ([0-9]+)\r\n"
        "X-Timestamp: ([0-9.]+)\r\n\r\n"};
    int parts = 0;
    double before = 0;
    std::smatch found;
    for (std::string rest = stream; std::regex_search(rest, found, head); ++parts) {
        const auto length = std::size_t(std::stoi(found[1]));
        const double time = std::stod(found[2]);
        const auto begin = std::size_t(found.length());
        if (rest.size() < begin + length + 2) break;
        EXPECT_EQ(decoded(rest.substr(begin, length)).cols, 64);
        EXPECT_GT(time, before);
        EXPECT_EQ(rest.substr(begin + length, 2), "\r\n");
        before = time;
        rest = rest.substr(begin + length + 2);
    }
    EXPECT_GT(parts, 3);
}

/// Of a stream of JPEGs.
int parts(const std::string& stream) {
    int parts = 0;
    for (std::size_t at = 0; (at = stream.find("--frame\r\n", at)) != stream.npos; ++at) ++parts;
    return parts;
}

TEST(HttpSink, AStreamGoesOnWithItsLastFrameWhileThereIsNoNewOne) {
    const auto sink = open_page();
    const RawClient viewer{*sink};
    viewer.send(request("GET /stream"));
    ASSERT_TRUE(becomes_true([&] {
        sink->write(ramp_frame(16, 16, 0, odd_time(0)));
        return sink->copied() > 0;
    }));
    std::string stream = viewer.receive(100);
    EXPECT_EQ(status_of(stream), 200);
    while (parts(stream) < 3) stream += viewer.receive(10);
}

TEST(HttpSink, AStreamHasNoMoreFramesASecondThanWereAskedFor) {
    const auto sink = open_page();
    const RawClient slow{*sink}, fast{*sink};
    slow.send(request("GET /stream?fps=0.1"));
    fast.send(request("GET /stream?fps=1000"));
    {
        const Frames frames{*sink};
        EXPECT_EQ(status_of(slow.receive(100)), 200);
        EXPECT_GT(parts(fast.receive(200'000)), 20);
    }
    sink->close();
    EXPECT_LE(parts(slow.receive_all()), 2) << "one, where all this takes less than 10 s";
}

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
    ASSERT_TRUE(becomes_true([&] {
        return client_of(*sink).Get("/frame.png")->status == 200 && sink->copied() > 1;
    })) << "the frame comes again to those who come";
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

TEST(ShownFrame, EventsAreWhiteBlackOrGrey) {
    Frame frame = ramp_frame(8, 8, 0, odd_time(0));
    frame.event_preview = Array2<float>{1, 3};
    frame.event_preview(0, 0) = 2;
    frame.event_preview(0, 2) = -1;
    const ShownFrame shown{frame, kSigmaWhite, {}};
    const auto& png = shown.events();
    const cv::Mat image = decoded({png.begin(), png.end()});
    ASSERT_EQ(image.size(), cv::Size(3, 1));
    EXPECT_EQ(image.at<std::uint8_t>(0, 0), 255);
    EXPECT_EQ(image.at<std::uint8_t>(0, 1), 128);
    EXPECT_EQ(image.at<std::uint8_t>(0, 2), 0);
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
