// Clients that are many, slow, gone, or up to no good: every byte of theirs is ours.
#include "pipeline/sinks/http/http_server.h"
#include "tests/pipeline/sinks/http/served.h"
#include "tests/support/holdings.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <optional>
#include <vector>

namespace eventide::test {
namespace {

std::string answer_to(const HttpSink& sink, const std::string& text) {
    const RawClient client{sink};
    client.send(text);
    return client.receive_all();
}

TEST(HttpConnections, SixteenViewersAndNoMore) {
    const auto sink = open_page();
    const Frames frames{*sink};
    std::vector<RawClient> viewers;
    for (int i = 0; i < HttpSink::kMaxViewers; ++i) {
        viewers.emplace_back(*sink).send(request("GET /stream"));
        ASSERT_EQ(status_of(viewers.back().receive(2000)), 200) << "viewer " << i;
    }
    const std::string refused = answer_to(*sink, request("GET /stream"));
    EXPECT_EQ(status_of(refused), 503);
    EXPECT_NE(refused.find("Retry-After:"), refused.npos);
    EXPECT_EQ(status_of(answer_to(*sink, request("GET /"))), 200) << "the page itself is there";
    EXPECT_EQ(status_of(answer_to(*sink, request("GET /metrics"))), 200);
    viewers.pop_back();
    EXPECT_TRUE(becomes_true([&] {
        const RawClient next{*sink};
        next.send(request("GET /stream"));
        return status_of(next.receive(20)) == 200;
    })) << "a place that was left is free again";
}

TEST(HttpConnections, AViewerWhoLeavesWhileNoFrameComesGivesHisPlaceBack) {
    const auto sink = open_page();
    for (const char* path : {"GET /stream", "GET /frames"}) {
        const RawClient viewer{*sink};
        viewer.send(request(path));
        ASSERT_EQ(status_of(viewer.receive(20)), 200) << path;
    }
    EXPECT_TRUE(becomes_true([&] { return sink->connections() == 0; }));
}

TEST(HttpConnections, AViewerWhoReadsNothingHoldsUpNobody) {
    const auto sink = open_page();
    const RawClient slow{*sink};
    slow.send(request("GET /stream?fps=1000"));
    const Frames frames{*sink, 320, 240};
    const RawClient fast{*sink};
    fast.send(request("GET /stream?fps=1000"));
    // Far more than the slow one's buffers hold.
    EXPECT_EQ(fast.receive(8'000'000).size(), 8'000'000U);
    const int written = frames.written();
    EXPECT_TRUE(becomes_true([&] { return frames.written() > written + 50; }));
}

TEST(HttpConnections, CloseEndsAllOfThem) {
    const auto sink = open_page();
    std::vector<RawClient> clients;
    {
        const Frames frames{*sink};
        for (int i = 0; i < 4; ++i) clients.emplace_back(*sink).send(request("GET /stream"));
        for (int i = 0; i < 4; ++i) clients.emplace_back(*sink).send(request("GET /frames"));
        for (int i = 0; i < 4; ++i) clients.emplace_back(*sink).send(request("GET /stats"));
        for (int i = 0; i < 4; ++i) clients.emplace_back(*sink).send("GET / HT");
        for (int i = 0; i < 12; ++i)
            ASSERT_EQ(status_of(clients[std::size_t(i)].receive(100)), 200) << i;
    }
    sink->close();
    EXPECT_EQ(sink->connections(), 0U);
    for (const RawClient& client : clients) client.receive_all();  // ends
}

TEST(HttpConnections, APageOpenedAndClosedLeavesNothingBehind) {
    expect_nothing_left([] {
        const auto sink = open_page();
        {
            const Frames frames{*sink};
            EXPECT_EQ(status_of(answer_to(*sink, request("GET /frame.png"))), 200);
        }
        sink->close();
    });
}

/// Pieces of this process's memory: an ended thread that nobody joined keeps its stack.
std::size_t mappings() {
    std::ifstream maps{"/proc/self/maps"};
    return std::size_t(std::count(std::istreambuf_iterator<char>{maps}, {}, '\n'));
}

/// More by hand: EVENTIDE_CONNECTIONS=10000 test_http_sink --gtest_filter=*Dropped*.
TEST(HttpConnections, HundredsOpenedAndDroppedLeaveNothingBehind) {
    const char* const asked = std::getenv("EVENTIDE_CONNECTIONS");
    const int connections = asked == nullptr ? 400 : std::atoi(asked);
    const auto sink = open_page();
    const Frames frames{*sink};
    ASSERT_EQ(status_of(answer_to(*sink, request("GET /frame.png"))), 200);
    ASSERT_TRUE(becomes_true([&] { return sink->connections() == 0; }));
    const Holdings before = holdings();
    const std::size_t mapped = mappings();
    const std::string beginnings[]{"",
                                   "GET /stream HTTP/1.1\r\nHo",
                                   request("GET /stream"),
                                   request("GET /frames"),
                                   request("GET /stats"),
                                   request("POST /controls",
                                           "Content-Type: application/json\r\n"
                                           "Content-Length: 100\r\n",
                                           "{"),
                                   "\r\n\r\n",
                                   request("GET /frame.png")};
    for (int i = 0; i < connections; ++i) {
        RawClient client{*sink};
        const std::string& text = beginnings[std::size_t(i) % std::size(beginnings)];
        client.send(text);
        const bool is_whole = text.starts_with("GET") && text.ends_with("\r\n\r\n");
        if (i % 3 == 0 && is_whole) client.receive(1);
        if (i % 2 == 0) client.drop();
    }
    EXPECT_TRUE(becomes_true([&] { return sink->connections() == 0; })) << sink->connections();
    const Holdings after = holdings_down_to(before);
    EXPECT_LE(after.files, before.files);
    EXPECT_LE(after.threads, before.threads);
    EXPECT_EQ(status_of(answer_to(*sink, request("GET /frame.png"))), 200);
    EXPECT_LT(mappings(), mapped + std::size_t(connections) / 2);
}

/// Without a request, in the middle of a request, and after a refusal that nobody reads.
TEST(HttpConnections, WhoeverSendsNoRequestGivesWayToOthers) {
    const auto sink = open_page();
    std::vector<RawClient> idle;
    for (int i = 0; i < 100; ++i) {
        idle.emplace_back(*sink).send(i % 3 == 0   ? ""
                                      : i % 3 == 1 ? "GET / HT"
                                                   : "GET / HTTP/1.1\r\n\r\n");
        EXPECT_LE(sink->connections(), HttpServer::kMaxConnections);
    }
    for (int i = 0; i < 100; ++i)
        ASSERT_EQ(status_of(answer_to(*sink, request("GET /controls"))), 200) << i;
    idle.clear();
    EXPECT_TRUE(becomes_true([&] { return sink->connections() == 0; }));
}

/// A POST that is allowed and whose body is on its way: the server has asked for it.
RawClient posting(const HttpSink& sink) {
    RawClient client{sink};
    client.send(request("POST /controls",
                        "Content-Type: application/json\r\nContent-Length: 2\r\n"
                        "Expect: 100-continue\r\n"));
    EXPECT_EQ(status_of(client.receive(21)), 100);
    return client;
}

TEST(HttpConnections, WhereAllAreAnsweredOneMoreIsTurnedAway) {
    const auto sink = open_page();
    std::vector<RawClient> busy;
    for (std::size_t i = 0; i < HttpServer::kMaxConnections; ++i) busy.push_back(posting(*sink));
    EXPECT_EQ(status_of(answer_to(*sink, request("GET /controls"))), 503);
    for (const RawClient& client : busy) {
        client.send("{}");
        EXPECT_NE(client.receive_all().find("HTTP/1.1 200"), std::string::npos);
    }
    EXPECT_TRUE(becomes_true([&] { return sink->connections() == 0; }));
}

/// Whose end would be where the client closes: "curl -X POST" without data waits for the answer.
TEST(HttpConnections, APostWithoutALengthIsAnsweredAtOnce) {
    const auto sink = open_page();
    const std::string json = "Content-Type: application/json\r\n";
    EXPECT_EQ(status_of(answer_to(*sink, request("POST /controls", json))), 411);
    EXPECT_EQ(status_of(answer_to(*sink,
                                  request("POST /controls", json + "Content-Length: 2\r\n", "{}"))),
              200);
    EXPECT_EQ(status_of(answer_to(*sink,
                                  request("POST /controls", json + "Transfer-Encoding: chunked\r\n",
                                          "2\r\n{}\r\n0\r\n\r\n"))),
              200);
}

TEST(HttpConnections, RefusesWhatBrowsersAreMadeToSay) {
    const auto sink = open_page();
    EXPECT_EQ(status_of(answer_to(*sink, "GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n")), 421);
    EXPECT_EQ(status_of(answer_to(*sink, "GET / HTTP/1.1\r\n\r\n")), 421);
    EXPECT_EQ(status_of(answer_to(*sink, request("GET /controls", "Host: localhost\r\n"))), 421);
    EXPECT_EQ(status_of(answer_to(*sink, request("GET /controls", "Origin: http://a.b\r\n"))), 403);
    EXPECT_EQ(status_of(answer_to(*sink, request("OPTIONS /controls", "Origin: http://a.b\r\n"))),
              405);
    EXPECT_EQ(status_of(answer_to(*sink, request("GET /controls"))), 200);
}

/// A form of another site may send any body: no part of it may ever be taken for a request.
TEST(HttpConnections, TheBodyOfARefusedRequestIsNoRequest) {
    std::atomic<int> changes{0};
    HttpSettings settings;
    settings.controls = {{"fps", "", "", 1, 1000, 1, {}, [&](double) { ++changes; }}};
    const auto sink = open_page(std::move(settings));
    const std::string body = "{\"fps\": 60}";
    const std::string hidden = request(
        "POST /controls",
        "Content-Type: application/json\r\nContent-Length: " + std::to_string(body.size()) + "\r\n",
        body);
    const std::string answers =
        answer_to(*sink, request("POST /controls",
                                 "Origin: http://evil.example\r\nContent-Type: text/plain\r\n"
                                 "Content-Length: " +
                                     std::to_string(hidden.size()) + "\r\n",
                                 hidden));
    EXPECT_EQ(status_of(answers), 403);
    EXPECT_EQ(answers.find("HTTP/1.1", 5), answers.npos) << "a second answer";
    EXPECT_EQ(changes, 0);
    EXPECT_EQ(status_of(answer_to(*sink, hidden)), 200);
    EXPECT_EQ(changes, 1) << "what was hidden would have changed something";
}

TEST(HttpConnections, EndlessRequestsEnd) {
    const auto sink = open_page();
    const std::string json = "Content-Type: application/json\r\n", megabyte(1 << 20, 'x');
    const std::string chunk = "10000\r\n" + std::string(0x10000, ' ') + "\r\n";
    std::string chunks;
    for (int i = 0; i < 16; ++i) chunks += chunk;
    std::string ranges = "Range: bytes=0-0";
    while (ranges.size() < 8000) ranges += ",0-0";
    std::string many;
    for (int i = 0; i < 4000; ++i) many += "X-" + std::to_string(i) + ": y\r\n";
    std::string large;  // more than 24 KiB of lines that are no longer than they may be
    for (int i = 0; i < 5; ++i)
        large += "X-" + std::to_string(i) + ": " + std::string(7000, 'y') + "\r\n";
    const std::vector<std::string> wrong{
        "GET /" + megabyte,
        request("GET /" + std::string(8200, 'x')),
        "GET / HTTP/1.1\r\nX: " + megabyte,
        request("GET /", many),
        request("GET /", large),
        request("POST /controls", json + "Content-Length: 1048576\r\n", megabyte),
        request("POST /controls", json + "Content-Length: 99999999999999999999\r\n", megabyte),
        request("POST /controls", json + "Content-Length: -1\r\n", "{}"),
        request("POST /controls", json + "Transfer-Encoding: chunked\r\n", chunks),
        request("POST /controls", json + "Transfer-Encoding: chunked\r\n", "zzz\r\n{}\r\n"),
        std::string(1000, '\0'),
        "\r\n\r\n\r\n\r\n",
        "GET\r\n\r\n",
        "GET / HTTP/9.9\r\nHost: localhost\r\n\r\n",
        "GET http://evil.example/ HTTP/1.1\r\nHost: evil.example\r\n\r\n"};
    for (const std::string& text : wrong) {
        const RawClient client{*sink};
        client.send(text);
        client.finish();
        const int status = status_of(client.receive_all());
        EXPECT_TRUE(status == 0 || (status >= 400 && status < 500))
            << status << " to " << text.substr(0, 60);
    }
    const int with_ranges = status_of(answer_to(*sink, request("GET /controls", ranges + "\r\n")));
    EXPECT_TRUE(with_ranges == 200 || with_ranges == 416) << with_ranges;
    EXPECT_EQ(status_of(answer_to(*sink, request("GET /controls"))), 200);
    EXPECT_TRUE(becomes_true([&] { return sink->connections() == 0; }));
}

}  // namespace
}  // namespace eventide::test
