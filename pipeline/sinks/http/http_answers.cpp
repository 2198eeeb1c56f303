#include "pipeline/sinks/http/http_answers.h"

#include "pipeline/camera_counters.h"
#include "pipeline/sinks/http/frame_streams.h"
#include "pipeline/sinks/http/page_files.h"
#include "src/core/error.h"

#include <algorithm>
#include <charconv>
#include <string>
#include <string_view>
#include <utility>

namespace eventide {

namespace {

using Clock = NewestFrame::Clock;

/// How long a request for a single frame waits for one.
constexpr std::chrono::seconds kFrameTime{5};
constexpr const char* kNothing = "there is no such thing here";
constexpr const char* kNoSigma = "these frames have no sigma (--uncertainty none)";

void say(httplib::Response& response, int status, const std::string& words) {
    response.status = status;
    response.set_content(words + "\n", "text/plain; charset=utf-8");
}

template <typename Body>
void guarded(httplib::Response& response, Body body) {
    try {
        body();
    } catch (const Error& error) {
        say(response, error.kind() == ErrorKind::usage ? 400 : 500, error.what());
    } catch (const std::exception& error) {
        say(response, 500, error.what());
    }
}

/// Pages of other sites may neither show nor read any of this, and the page itself loads nothing
/// from elsewhere. Nothing of it is kept or resumed.
void protect(httplib::Response& response) {
    response.set_header("Content-Security-Policy",
                        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' "
                        "blob:; connect-src 'self'; frame-ancestors 'none'; base-uri 'none'; "
                        "form-action 'none'");
    response.set_header("X-Content-Type-Options", "nosniff");
    response.set_header("Cross-Origin-Resource-Policy", "same-origin");
    response.set_header("Referrer-Policy", "no-referrer");
    response.set_header("Cache-Control", "no-store");
    // Each request of a frame is answered with another one, of which no part is of use.
    response.set_header("Accept-Ranges", "none");
}

RequestHead head_of(const httplib::Request& request) {
    RequestHead head;
    head.method = request.method;
    head.path = request.path;
    head.hosts = request.get_header_value_count("Host");
    head.host = request.get_header_value("Host");
    head.has_length = request.get_header_value_count("Content-Length") > 0 ||
                      request.get_header_value_count("Transfer-Encoding") > 0;
    head.origin = request.get_header_value("Origin");
    head.fetch_site = request.get_header_value("Sec-Fetch-Site");
    head.content_type = request.get_header_value("Content-Type");
    head.content_encoding = request.get_header_value("Content-Encoding");
    head.authorization = request.get_header_value("Authorization");
    head.token = request.get_param_value("token");
    return head;
}

std::string_view text_of(const ShownFrame::Bytes& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Letters that mean something in HTML are none of ours.
std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
        if (c == '<' || c == '>' || c == '&' || c == '"' || c == '\'')
            out += "&#" + std::to_string(int(c)) + ";";
        else
            out += c;
    }
    return out;
}

/// What went wrong between a camera and the machine: beside it only traffic is counted.
std::string incident_names() {
    std::string names;
    for (const CameraCountWords& words : kCameraCountWords)
        if (words.kind != CameraCountKind::traffic)
            names += (names.empty() ? "\"" : ",\"") + std::string{words.name} + "\"";
    return "[" + names + "]";
}

std::string page_of(const std::string& title) {
    constexpr std::string_view kMark = "@TITLE@";
    std::string page{kPageHtml};
    const std::string words = escaped(title);
    for (std::size_t at = 0; (at = page.find(kMark, at)) != page.npos; at += words.size())
        page.replace(at, kMark.size(), words);
    return page;
}

}  // namespace

HttpAnswers::HttpAnswers(const HttpSettings& settings, NewestFrame& newest)
    : settings_{settings}, newest_{newest}, guard_{settings.token, settings.names} {}

HttpCounters HttpAnswers::counters() const {
    HttpCounters now;
    now.viewers = std::uint64_t(viewers_.taken());
    now.listeners = std::uint64_t(listeners_.taken());
    now.requests = requests_;
    now.refused = refused_;
    now.copied = newest_.copied();
    return now;
}

bool HttpAnswers::answer(const Request& request, Response& response) {
    ++requests_;
    protect(response);
    response.status = 200;
    if (refuse(request, response)) return true;
    if (request.method == "POST") {
        if (request.path == kPostPath) return false;
        say(response, 404, kNothing);
        return true;
    }
    guarded(response, [&] { get(request, response); });
    return true;
}

/// Each answer has the controls as they stand afterwards.
void HttpAnswers::answer_post(const Request& request, Response& response) {
    guarded(response, [&] {
        for (const auto& [control, value] : parse_changes(request.body, settings_.controls))
            control->set(value);
        response.status = 200;
        response.set_content(controls_json(settings_.controls), "application/json");
    });
}

bool HttpAnswers::refuse(const Request& request, Response& response) {
    const auto refusal = judge(head_of(request), guard_);
    if (!refusal) return false;
    ++refused_;
    if (refusal->status == 401) response.set_header("WWW-Authenticate", "Bearer");
    if (refusal->status == 405) response.set_header("Allow", "GET, HEAD, POST");
    say(response, refusal->status, refusal->words);
    return true;
}

void HttpAnswers::get(const Request& request, Response& response) {
    const std::string& path = request.path;
    if (path == "/")
        response.set_content(page_of(settings_.title), "text/html; charset=utf-8");
    else if (path == "/page.js")
        response.set_content(std::string{kPageJs}, "text/javascript; charset=utf-8");
    else if (path == "/page.css")
        response.set_content(std::string{kPageCss}, "text/css; charset=utf-8");
    else if (path == "/favicon.ico")
        response.status = 204;
    else if (path == "/frames")
        page_frames(response);
    else if (path == "/stream")
        motion_jpeg(request, response);
    else if (path == "/frame.png" || path == "/frame.jpg" || path == "/sigma.tiff")
        one_frame(request, response);
    else if (path == "/stats")
        statistics(response);
    else if (path == "/controls")
        response.set_content(controls_json(settings_.controls), "application/json");
    else if (path == "/metrics")
        response.set_content(
            metrics_text(settings_.snapshot ? settings_.snapshot() : Snapshot{}, counters()),
            "text/plain; version=0.0.4; charset=utf-8");
    else
        say(response, 404, kNothing);
}

std::shared_ptr<const void> HttpAnswers::place(Slots& slots, const char* of_what,
                                               Response& response) {
    auto held = slots.take();
    if (!held) {
        ++refused_;
        response.set_header("Retry-After", "2");
        say(response, 503,
            std::to_string(HttpSink::kMaxViewers) + " viewers of " + of_what +
                " are here already, which is the most");
    }
    return held;
}

void HttpAnswers::page_frames(Response& response) {
    if (auto held = place(viewers_, "frames", response))
        send_frames(newest_, std::move(held), response);
}

/// Throws Error (usage) for a word that is none, and for a sigma that would be 0 everywhere.
Show HttpAnswers::asked_show(const Request& request, Show otherwise) const {
    if (!request.has_param("show")) return otherwise;
    const Show show = show_named(request.get_param_value("show"));
    if (show != Show::intensity && settings_.uncertainty == Uncertainty::none)
        throw Error(ErrorKind::usage, kNoSigma);
    return show;
}

void HttpAnswers::motion_jpeg(const Request& request, Response& response) {
    MotionJpeg wanted;
    if (settings_.uncertainty == Uncertainty::side) wanted.show = Show::side;
    if (settings_.uncertainty == Uncertainty::overlay) wanted.show = Show::overlay;
    wanted.show = asked_show(request, wanted.show);
    if (request.has_param("fps")) wanted.fps = rate_named(request.get_param_value("fps"));
    if (auto held = place(viewers_, "frames", response))
        send_motion_jpeg(newest_, wanted, std::move(held), response);
}

void HttpAnswers::one_frame(const Request& request, Response& response) {
    const Show show = asked_show(request, Show::intensity);
    const auto held = place(viewers_, "frames", response);
    if (!held) return;
    const auto shown = newest_.next(nullptr, Clock::now() + kFrameTime);
    if (!shown) return say(response, 503, "no frame came within 5 seconds");
    const bool png = request.path == "/frame.png", tiff = request.path == "/sigma.tiff";
    const ShownFrame::Bytes& bytes = png    ? shown->png(show)
                                     : tiff ? shown->tiff()
                                            : shown->jpeg(show);
    if (bytes.empty()) return say(response, 404, kNoSigma);
    response.set_header("X-Time-Us", std::to_string(to_us(shown->frame().t)));
    response.set_header("X-Frame-Index", std::to_string(shown->frame().index));
    response.set_content(std::string{text_of(bytes)}, png    ? "image/png"
                                                      : tiff ? "image/tiff"
                                                             : "image/jpeg");
}

std::string HttpAnswers::statistics_json(double event_rate) const {
    return "{\"run\":" + (settings_.stats ? settings_.stats(event_rate) : "null") +
           ",\"controls\":" + controls_json(settings_.controls) +
           ",\"viewers\":" + std::to_string(viewers_.taken()) +
           ",\"most_viewers\":" + std::to_string(HttpSink::kMaxViewers) +
           ",\"sigma_white\":" + std::to_string(settings_.sigma_white) +
           ",\"camera_incidents\":" + incident_names() + "}";
}

void HttpAnswers::statistics(Response& response) {
    auto held = place(listeners_, "statistics", response);
    if (!held) return;
    EventRate rate;
    response.set_chunked_content_provider(
        "text/event-stream",
        [this, held = std::move(held), rate](std::size_t, httplib::DataSink& sink) mutable {
            const std::uint64_t events = settings_.snapshot ? settings_.snapshot().events : 0;
            const std::string text =
                "data: " + statistics_json(rate.at(Clock::now(), events)) + "\n\n";
            if (!sink.is_writable() || !sink.write(text.data(), text.size())) return false;
            if (!newest_.sleep(Clock::now() + std::chrono::milliseconds{250})) sink.done();
            return true;
        });
}

}  // namespace eventide
