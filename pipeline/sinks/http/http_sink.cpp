#include "pipeline/sinks/http/http_sink.h"

#include "pipeline/sinks/http/http_answers.h"
#include "pipeline/sinks/http/http_server.h"
#include "src/core/error.h"
#include "src/io/image_codecs.h"

#include <atomic>
#include <utility>

namespace eventide {

namespace {

class HttpSinkInThreads final : public HttpSink {
public:
    explicit HttpSinkInThreads(HttpSettings settings)
        : settings_{std::move(settings)},
          newest_{settings_.sigma_white},
          answers_{settings_, newest_},
          server_{settings_.address,
                  {[this](const auto& request, auto& response) {
                       return answers_.answer(request, response);
                   },
                   HttpAnswers::kPostPath,
                   [this](const auto& request, auto& response) {
                       answers_.answer_post(request, response);
                   }}} {
        load_image_codecs();
        settings_.controls.push_back(pause());
        server_.start();
    }
    ~HttpSinkInThreads() override { close(); }

    void write(const Frame& frame) override {
        newest_.offer(frame);
        const auto shown = NewestFrame::Clock::now();
        looked_ = shown;
        while (paused_ && !is_forgotten() && !(settings_.give_up && settings_.give_up()))
            newest_.offer_while_held(frame, std::chrono::milliseconds{20});
        held_ = NewestFrame::Clock::now() - shown;
    }
    HostTime::duration held() const override { return held_; }
    void close() override {
        newest_.close();
        server_.stop();
    }
    const HttpAddress& address() const override { return server_.address(); }
    std::size_t connections() const override { return server_.connections(); }
    std::uint64_t copied() const override { return newest_.copied(); }

private:
    HttpControl pause() {
        return {.name = "pause",
                .label = "Pause",
                .unit = "",
                .get = [this] { return paused_ ? 1.0 : 0.0; },
                .set = [this](double on) { paused_ = on != 0; }};
    }

    /// Nobody is left who could end the pause.
    bool is_forgotten() {
        const auto now = NewestFrame::Clock::now();
        if (answers_.has_viewers()) looked_ = now;
        if (now - looked_ < settings_.forgotten_after) return false;
        paused_ = false;
        return true;
    }

    HttpSettings settings_;
    std::atomic<bool> paused_{false};
    HostTime::duration held_{};                // render thread
    NewestFrame::Clock::time_point looked_{};  // somebody did; render thread
    NewestFrame newest_;
    HttpAnswers answers_;
    HttpServer server_;  // last: its threads use the others
};

}  // namespace

std::unique_ptr<HttpSink> open_http(HttpSettings settings) {
    const Uncertainty how = settings.uncertainty;
    if (how == Uncertainty::alpha || how == Uncertainty::separate)
        throw Error(ErrorKind::usage,
                    "--out http: expected --uncertainty none, side or overlay, "
                    "found " +
                        std::string{name_of(how)});
    return std::make_unique<HttpSinkInThreads>(std::move(settings));
}

}  // namespace eventide
