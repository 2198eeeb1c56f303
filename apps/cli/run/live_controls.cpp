#include "apps/cli/run/live_controls.h"

#include "apps/cli/settings/sink_name.h"
#include "src/binning/tile_activity.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <optional>

namespace eventide::app {

namespace {

using Value = std::shared_ptr<std::atomic<double>>;

Value made(double value) {
    return std::make_shared<std::atomic<double>>(value);
}

HttpControl control(std::string name, std::string label, std::string unit, const Value& value) {
    HttpControl made;
    made.name = std::move(name);
    made.label = std::move(label);
    made.unit = std::move(unit);
    made.get = [value] { return value->load(); };
    return made;
}

HttpControl fps_control(const LiveControlsPlan& plan, const std::string& why_not) {
    const Value value = made(plan.fps);
    HttpControl fps = control("fps", "Frame rate", "frames/s", value);
    fps.least = 1;
    fps.fixed = why_not;
    // The slider's end, where the run began beyond it; in slow motion what slowed() takes.
    constexpr double kUsual = 1000, kMostOfSensor = 1e6;
    fps.most = std::min(std::max(kUsual, std::ceil(plan.fps)),
                        std::floor(kMostOfSensor / plan.settings.slow));
    if (!why_not.empty()) return fps;
    fps.set = [value, &changes = plan.changes, slow = plan.settings.slow](double wanted) {
        changes.set_rate(slowed({std::llround(wanted), 1}, slow));
        *value = wanted;
    };
    return fps;
}

HttpControl scale_control(const LiveControlsPlan& plan, std::string why_not) {
    constexpr double kMax = 4, kMaxSide = 4096, kStep = 0.25;
    const Size now = plan.settings.size.of(plan.sensor);
    const Value value = made(double(now.width) / double(plan.sensor.width));
    HttpControl scale = control("scale", "Scale", "x sensor", value);
    if (why_not.empty() && plan.settings.size.exact) why_not = "--size gives pixels, not a factor";
    if (why_not.empty() && plan.settings.region) why_not = "--roi is in pixels of the frame";
    const double side = std::max(plan.sensor.width, plan.sensor.height);
    scale.least = scale.step = kStep;
    scale.most = std::max({std::min(kMax, std::floor(kMaxSide / side / kStep) * kStep), kStep,
                           std::ceil(*value / kStep) * kStep});
    scale.fixed = why_not;
    if (!why_not.empty()) return scale;
    scale.set = [value, &changes = plan.changes, sensor = plan.sensor](double wanted) {
        changes.set_size(std::max(1, int(std::lround(sensor.width * wanted))),
                         std::max(1, int(std::lround(sensor.height * wanted))));
        *value = wanted;
    };
    return scale;
}

HttpControl lookahead_control(const LiveControlsPlan& plan) {
    const Value value = made(plan.lookahead);
    HttpControl lookahead = control("lookahead", "Lookahead", "event windows", value);
    lookahead.most = 2;
    lookahead.set = [value, &changes = plan.changes](double wanted) {
        changes.set_lookahead(int(wanted));
        *value = wanted;
    };
    return lookahead;
}

HttpControl speed_control(const LiveControlsPlan& plan) {
    const Value value = made(plan.speed);
    HttpControl speed = control("speed", "Speed", "x real time", value);
    speed.least = speed.step = 0.05;
    speed.most = 8;
    if (plan.speed > 0) {
        speed.least = std::min(speed.least, plan.speed);
        speed.most = std::max(speed.most, plan.speed);
    }
    if (plan.live) {
        speed.fixed = "a camera has one speed";
        speed.text = "live";
    } else if (!plan.set_speed || plan.speed <= 0) {
        speed.fixed = "as fast as possible (--speed max)";
        speed.text = "max";
    } else {
        speed.set = [value, set = plan.set_speed](double wanted) {
            set(wanted);
            *value = wanted;
        };
    }
    return speed;
}

/// What the slider of the event window moves, by its rule.
struct WindowRange {
    const char* unit;
    double least, most, step, now;
    std::function<void(SlicerSettings&, double)> put;
};

WindowRange window_range(const SlicerSettings& slicer) {
    const auto put_epp = [](SlicerSettings& to, double value) { to.events_per_pixel = value; };
    if (slicer.rule == WindowRule::duration)
        return {
            "ms", 1, 500, 1, double(slicer.width.count()) / 1e3, [](SlicerSettings& to, double ms) {
                to.width = SensorDuration{std::max(1LL, std::llround(ms * 1e3))};
            }};
    if (slicer.rule == WindowRule::content)
        return {"events per pixel where most moves",
                0.05,
                double(TileActivity::kMostOfAPixel),
                0.05,
                slicer.events_per_pixel,
                put_epp};
    if (slicer.events_per_pixel > 0)
        return {"events per pixel", 0.01, 10, 0.01, slicer.events_per_pixel, put_epp};
    return {"events", 100, 1'000'000, 100, double(slicer.events), [](SlicerSettings& to, double n) {
                to.events = std::uint64_t(std::llround(n));
            }};
}

HttpControl window_control(const LiveControlsPlan& plan) {
    if (plan.slicer.rule == WindowRule::reference) {
        HttpControl window;
        window.name = "window";
        window.label = "Event window";
        window.text = window_text(plan.slicer);
        window.fixed = "cut at the camera's images (--window aps)";
        return window;
    }
    const WindowRange range = window_range(plan.slicer);
    const Value value = made(range.now);
    HttpControl window = control("window", "Event window", range.unit, value);
    // The slider's ends, where the run began beyond them.
    window.least = std::min(range.least, range.now);
    window.most = std::max(range.most, range.now);
    window.step = range.step;
    window.set = [value, &changes = plan.changes, slicer = plan.slicer, put = range.put,
                  min_window = plan.min_window](double wanted) {
        SlicerSettings now = slicer;
        // Windows as short as at the start could be more than can be encoded.
        if (const SensorDuration least = min_window(); least.count() > 0) now.min_width = least;
        put(now, wanted);
        changes.set_window(now);
        *value = wanted;
    };
    return window;
}

}  // namespace

std::optional<std::string> rigid_sink(const RunSettings& settings) {
    const auto found = std::ranges::find_if(settings.out, [](const std::string& text) {
        const SinkKind kind = parse_sink(text).kind;
        return kind != SinkKind::http && kind != SinkKind::window && kind != SinkKind::nothing;
    });
    if (found == settings.out.end()) return std::nullopt;
    return *found;
}

std::vector<HttpControl> live_controls(const LiveControlsPlan& plan) {
    std::string why_not;
    if (const auto sink = rigid_sink(plan.settings))
        why_not = "--out " + *sink + " has frames that are all alike";
    return {fps_control(plan, why_not), scale_control(plan, why_not), lookahead_control(plan),
            speed_control(plan), window_control(plan)};
}

}  // namespace eventide::app
