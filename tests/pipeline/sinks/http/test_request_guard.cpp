// Who may ask, what may be changed, where it listens: without a connection.
#include "pipeline/sinks/http/control.h"
#include "pipeline/sinks/http/http_address.h"
#include "pipeline/sinks/http/request_guard.h"
#include "src/core/error.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace eventide {
namespace {

RequestHead get(const std::string& host) {
    RequestHead head;
    head.method = "GET";
    head.path = "/";
    head.hosts = 1;
    head.host = host;
    return head;
}

RequestHead post(const std::string& origin) {
    RequestHead head = get("127.0.0.1:8080");
    head.method = "POST";
    head.path = "/controls";
    head.origin = origin;
    head.content_type = "application/json";
    head.has_length = true;
    return head;
}

int status(const RequestHead& head, const GuardSettings& settings = {}) {
    const auto refusal = judge(head, settings);
    return refusal ? refusal->status : 200;
}

TEST(RequestGuard, KnowsThisMachineByAddressesAndLocalhost) {
    for (const char* host : {"127.0.0.1", "127.0.0.1:8080", "localhost", "LocalHost:9000", "[::1]",
                             "[::1]:8080", "192.168.1.20:8080"})
        EXPECT_EQ(status(get(host)), 200) << host;
}

TEST(RequestGuard, RefusesNamesThatSomebodyElseGaveThisMachine) {
    for (const char* host :
         {"evil.example", "evil.example:8080", "127.0.0.1.evil.example", "localhost.evil.example",
          "", ":8080", "127.0.0.1:80a", "[::1", "[evil.example]", "127.0.0.1:8080:9", "[::1]x",
          "127.0.0.1/", "user@127.0.0.1", "2130706433", "0x7f.1", " 127.0.0.1"})
        EXPECT_EQ(status(get(host)), 421) << host;
    EXPECT_EQ(status(get(std::string{"127.0.0.1\0.evil.example", 23})), 421);
    EXPECT_EQ(status(get(std::string{"[::1\0x]", 7})), 421);
    RequestHead two = get("127.0.0.1");
    two.hosts = 2;
    EXPECT_EQ(status(two), 421);
    two.hosts = 0;
    EXPECT_EQ(status(two), 421);
}

TEST(RequestGuard, KnowsTheNamesItWasGiven) {
    const GuardSettings settings{"", {"Camera.Lab.example"}};
    EXPECT_EQ(status(get("camera.lab.example:443"), settings), 200);
    EXPECT_EQ(status(get("lab.example"), settings), 421);
}

TEST(RequestGuard, RefusesPagesOfOtherSites) {
    EXPECT_EQ(status(post("http://127.0.0.1:8080")), 200);
    EXPECT_EQ(status(post("https://127.0.0.1:8080")), 200) << "a proxy speaks HTTPS for us";
    EXPECT_EQ(status(post("")), 200) << "no browser: those always say it";
    for (const char* origin : {"http://evil.example", "null", "http://127.0.0.1:3000",
                               "http://127.0.0.1:80801", "http://localhost:8080", "file://"})
        EXPECT_EQ(status(post(origin)), 403) << origin;
    RequestHead image = get("127.0.0.1:8080");
    image.path = "/stream";
    image.fetch_site = "cross-site";
    EXPECT_EQ(status(image), 403);
    image.fetch_site = "same-site";
    EXPECT_EQ(status(image), 403) << "another port of this machine";
    image.fetch_site = "same-origin";
    EXPECT_EQ(status(image), 200);
    image.path = "/";
    image.fetch_site = "cross-site";
    EXPECT_EQ(status(image), 200) << "a link to the page";
}

TEST(RequestGuard, PostsAreJson) {
    RequestHead head = post("");
    for (const char* type : {"", "text/plain", "application/x-www-form-urlencoded",
                             "multipart/form-data; boundary=x", "application/jsonx"}) {
        head.content_type = type;
        EXPECT_EQ(status(head), 415) << type;
    }
    head.content_type = "Application/JSON ; charset=utf-8";
    EXPECT_EQ(status(head), 200);
}

TEST(RequestGuard, PostsSayHowLongTheyAre) {
    RequestHead head = post("");
    head.has_length = false;
    EXPECT_EQ(status(head), 411);
    head.method = "GET";
    EXPECT_EQ(status(head), 200) << "nothing follows its head";
}

/// 600 MB of zeros are 481 bytes of Brotli's.
TEST(RequestGuard, PostsAreNotPacked) {
    RequestHead head = post("");
    head.content_type = "application/json";
    for (const char* encoding : {"br", "gzip", "deflate", "identity, br", "GZIP"}) {
        head.content_encoding = encoding;
        EXPECT_EQ(status(head), 415) << encoding;
    }
    head.content_encoding = "Identity";
    EXPECT_EQ(status(head), 200);
}

TEST(RequestGuard, OtherMethodsAreRefused) {
    for (const char* method : {"PUT", "DELETE", "OPTIONS", "TRACE", "CONNECT", "get"}) {
        RequestHead head = get("localhost");
        head.method = method;
        EXPECT_EQ(status(head), 405) << method;
    }
}

TEST(RequestGuard, AsksForTheToken) {
    const GuardSettings settings{"abc123", {}};
    RequestHead head = get("localhost");
    EXPECT_EQ(status(head, settings), 401);
    head.token = "abc12";
    EXPECT_EQ(status(head, settings), 401);
    head.token = "abc1234";
    EXPECT_EQ(status(head, settings), 401);
    head.token = "abc123";
    EXPECT_EQ(status(head, settings), 200);
    head.token = "";
    head.authorization = "Bearer abc123";
    EXPECT_EQ(status(head, settings), 200);
    head.authorization = "Basic abc123";
    EXPECT_EQ(status(head, settings), 401);
    head.authorization = "";
    head.path = "/page.css";
    EXPECT_EQ(status(head, settings), 200) << "no secret";
    EXPECT_EQ(make_token().size(), 32U);
    EXPECT_NE(make_token(), make_token());
}

TEST(HttpAddress, IsWrittenInFewOrManyWords) {
    const auto text = [](const char* address) { return url_of(parse_http_address(address)); };
    EXPECT_EQ(text(""), "http://127.0.0.1:8080/");
    EXPECT_EQ(text("9000"), "http://127.0.0.1:9000/");
    EXPECT_EQ(text(":0"), "http://127.0.0.1:0/");
    EXPECT_EQ(text("0.0.0.0:80"), "http://0.0.0.0:80/");
    EXPECT_EQ(text("[::1]:8080"), "http://[::1]:8080/");
    EXPECT_EQ(text("localhost:1"), "http://localhost:1/");
    for (const char* wrong : {"65536", "127.0.0.1", "127.0.0.1:", "127.0.0.1:-1", "::1:8080",
                              "[::1:80", "[x]:80", "//127.0.0.1:80", "a b:80", "host:8080x"})
        EXPECT_THROW(parse_http_address(wrong), Error) << wrong;
}

TEST(HttpAddress, KnowsWhatOthersCannotReach) {
    for (const char* own : {"127.0.0.1", "127.1.2.3", "::1", "localhost"})
        EXPECT_TRUE(is_loopback(own)) << own;
    for (const char* open : {"0.0.0.0", "::", "192.168.0.1", "example.org", "127.0.0.1.example"})
        EXPECT_FALSE(is_loopback(open)) << open;
}

class Controls : public testing::Test {
protected:
    std::string refusal(const std::string& body) const {
        try {
            parse_changes(body, controls_);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            return error.what();
        }
        return "";
    }

    double fps_ = 30;
    std::vector<HttpControl> controls_{
        {"fps", "Rate", "frames/s", 1, 1000, 1, [this] { return fps_; },
         [this](double v) { fps_ = v; }},
        {"scale", "Scale", "x", 0.25, 4, 0.25, [] { return 1.0; }, [](double) {}},
        {"window", "Window", "", 0, 1, 1, {}, {}, "chosen at the start", "50ms"}};
};

TEST_F(Controls, TakeNumbersInRange) {
    const auto changes = parse_changes(R"({"fps": 60, "scale": 1.3})", controls_);
    ASSERT_EQ(changes.size(), 2U);
    EXPECT_EQ(changes[0].first->name, "fps");
    EXPECT_EQ(changes[0].second, 60);
    EXPECT_EQ(changes[1].second, 1.25) << "to the nearest step";
    EXPECT_TRUE(parse_changes("{}", controls_).empty());
}

TEST_F(Controls, SayWhatWasExpected) {
    EXPECT_EQ(refusal(R"({"fps": 0})"), "fps: expected a number from 1 to 1000, found 0");
    EXPECT_EQ(refusal(R"({"fps": "60"})"), "fps: expected a number from 1 to 1000");
    EXPECT_EQ(refusal(R"({"window": 1})"), "window cannot be changed now: chosen at the start");
    EXPECT_EQ(refusal(R"({"fsp": 60})"), "unknown control \"fsp\"");
    for (const char* wrong :
         {"", "[]", "60", "{", "{\"fps\": 60} x", "{\"fps\": NaN}", "{\"fps\": 1e999}",
          "{\"fps\": null}", "{\"fps\": [60]}", "{\"fps\": -1e300}"})
        EXPECT_NE(refusal(wrong), "") << wrong;
    EXPECT_NE(refusal(std::string(kMaxControlBytes + 1, ' ')), "");
    EXPECT_EQ(fps_, 30) << "nothing was changed";
}

TEST_F(Controls, AreToldAsTheyStand) {
    const auto json = nlohmann::json::parse(controls_json(controls_));
    ASSERT_EQ(json.size(), 3U);
    EXPECT_EQ(json[0]["value"], 30);
    EXPECT_EQ(json[0]["changeable"], true);
    EXPECT_EQ(json[2]["changeable"], false);
    EXPECT_EQ(json[2]["fixed"], "chosen at the start");
    EXPECT_EQ(json[2]["text"], "50ms");
}

}  // namespace
}  // namespace eventide
