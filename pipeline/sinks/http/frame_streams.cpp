#include "pipeline/sinks/http/frame_streams.h"

#include "src/core/duration_text.h"
#include "src/core/error.h"
#include "src/core/number_text.h"

#include <algorithm>
#include <string>
#include <utility>

namespace eventide {

namespace {

using Clock = NewestFrame::Clock;
constexpr std::chrono::seconds kTimeout{1};  // between looks whether the viewer is still there

/// One viewer's frames, one for each call.
class Frames {
public:
    Frames(NewestFrame& newest, double fps, std::shared_ptr<const void> place)
        : newest_{newest},
          step_{
              std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / fps))},
          place_{std::move(place)} {}

    /// Null where none came for a while, or it is over.
    std::shared_ptr<const ShownFrame> next() {
        if (!newest_.sleep(next_at_)) return nullptr;
        auto shown = newest_.next(seen_, Clock::now() + kTimeout);
        if (!shown) return nullptr;
        // Steps are kept where the frames' rate is a little lower, too.
        next_at_ = std::max(next_at_ + step_, Clock::now() - step_);
        seen_ = shown;
        return shown;
    }
    const std::shared_ptr<const ShownFrame>& seen() const { return seen_; }
    bool is_over() const { return newest_.is_closed(); }

private:
    NewestFrame& newest_;
    const Clock::duration step_;
    std::shared_ptr<const void> place_;
    std::shared_ptr<const ShownFrame> seen_;
    Clock::time_point next_at_ = Clock::now();
};

bool write(httplib::DataSink& sink, const ShownFrame::Bytes& bytes) {
    return sink.write(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

bool write_part(httplib::DataSink& sink, const ShownFrame& shown, Show show) {
    const ShownFrame::Bytes& jpeg = shown.jpeg(show);
    const std::string head =
        "--frame\r\nContent-Type: image/jpeg\r\nContent-Length: " + std::to_string(jpeg.size()) +
        "\r\nX-Timestamp: " + seconds_text(shown.frame().t) + "\r\n\r\n";
    return sink.write(head.data(), head.size()) && write(sink, jpeg) && sink.write("\r\n", 2);
}

}  // namespace

Show show_named(const std::string& word) {
    if (const auto show = parse_show(word)) return *show;
    throw Error(ErrorKind::usage, "show: expected intensity, sigma, side or overlay");
}

double rate_named(const std::string& word) {
    const double rate = number_in<double>(word).value_or(0);
    if (!(rate >= 0.1 && rate <= 1000))
        throw Error(ErrorKind::usage, "fps: expected a number from 0.1 to 1000");
    return rate;
}

void send_frames(NewestFrame& newest, std::shared_ptr<const void> place,
                 httplib::Response& response) {
    constexpr double kMax = 60;
    response.set_chunked_content_provider(
        "application/octet-stream",
        [frames = std::make_shared<Frames>(newest, kMax, std::move(place))](
            std::size_t, httplib::DataSink& sink) {
            if (frames->is_over()) return sink.done(), true;
            if (!sink.is_writable()) return false;
            const auto shown = frames->next();
            return !shown || write(sink, shown->message());
        });
}

void send_motion_jpeg(NewestFrame& newest, const MotionJpeg& wanted,
                      std::shared_ptr<const void> place, httplib::Response& response) {
    response.set_content_provider(
        "multipart/x-mixed-replace; boundary=frame",
        [frames = std::make_shared<Frames>(newest, wanted.fps, std::move(place)),
         show = wanted.show](std::size_t, httplib::DataSink& sink) {
            if (frames->is_over()) return sink.done(), true;
            if (!sink.is_writable()) return false;
            auto shown = frames->next();
            if (!shown) shown = frames->seen();
            return !shown || write_part(sink, *shown, show);
        });
}

double EventRate::at(std::chrono::steady_clock::time_point now, std::uint64_t events) {
    if (!last_) {
        last_ = now;
        events_ = events;
    }
    const double passed = std::chrono::duration<double>(now - *last_).count();
    if (passed >= 0.5) {
        rate_ = double(events - events_) / passed;
        events_ = events;
        last_ = now;
    }
    return rate_;
}

}  // namespace eventide
