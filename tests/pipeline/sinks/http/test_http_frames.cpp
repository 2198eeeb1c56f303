// Frames and streams of them, as clients that behave get them.
#include "pipeline/sinks/http/shown_frame.h"
#include "tests/pipeline/sinks/http/served.h"

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

#include <regex>
#include <string>
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

}  // namespace
}  // namespace eventide::test
