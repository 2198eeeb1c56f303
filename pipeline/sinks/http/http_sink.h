// Frames on a page in the browser, and for programs that read HTTP: MJPEG, PNG, TIFF, counters.
#pragma once

#include "pipeline/counters.h"
#include "pipeline/sink.h"
#include "pipeline/sinks/draw_frame.h"
#include "pipeline/sinks/http/control.h"
#include "pipeline/sinks/http/http_address.h"

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace eventide {

struct HttpSettings {
    HttpAddress address = {};
    std::string token = {};               ///< empty: nobody is asked for one
    std::vector<std::string> names = {};  ///< under which browsers may reach us, as GuardSettings'
    std::string title = "eventide";       ///< of the page: the source
    Uncertainty uncertainty = Uncertainty::automatic;  ///< of /stream: none, side or overlay
    float sigma_white = kSigmaWhite;
    std::vector<HttpControl> controls = {};  ///< beside the pause, which is the sink's own
    /// A pause ends by itself when nobody has looked for so long.
    std::chrono::milliseconds forgotten_after{10'000};

    // Any thread; each may be empty.
    std::function<Snapshot()> snapshot = {};
    /// The counters as one JSON object, with the events per second of host time lately.
    std::function<std::string(double event_rate)> stats = {};
    std::function<bool()> give_up = {};  ///< true ends a pause: the run is being stopped
};

/// Each viewer has a thread, and the newest frame when he is ready for it: a slow one sees fewer
/// frames and holds up nobody. While nobody looks, nothing is copied or encoded.
///
/// A pause holds the render thread: a recording waits; the windows of a live source are merged, and
/// their frames come late or are skipped.
class HttpSink : public Sink {
public:
    /// Viewers of images at once, and as many again of statistics; more are told 503.
    static constexpr int kMaxViewers = 16;

    /// Where it listens: where port 0 was asked for, with the port that the system gave.
    virtual const HttpAddress& address() const = 0;
    virtual std::size_t connections() const = 0;  ///< open now
    virtual std::uint64_t copied() const = 0;     ///< frames, for viewers
};

/// Listens from now on. Throws Error: usage for an uncertainty it cannot show, a host that is not
/// known, or a build without cpp-httplib; failed for a port that cannot be had.
std::unique_ptr<HttpSink> open_http(HttpSettings settings);

}  // namespace eventide
