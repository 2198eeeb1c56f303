// Renderer: requests checked, times located, then handed over to the engine that was chosen.
#include "src/model/render/renderer.h"

#include "src/core/error.h"
#include "src/core/frame_stamp.h"
#include "src/core/number_text.h"
#include "src/core/sensor_limits.h"
#include "src/model/cores.h"
#include "src/model/mirrors.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstdint>
#include <functional>

namespace eventide {

namespace {

/// px from `at` to the end of a side; of numbers that nobody checked yet.
int rest_of(int side, int at) {
    const std::int64_t rest = std::int64_t{side} - at;
    return int(std::clamp<std::int64_t>(rest, INT_MIN, INT_MAX));
}

}  // namespace

FrameGeometry geometry_of(const RenderRequest& request, int sensor_width, int sensor_height) {
    FrameGeometry geometry;
    geometry.sensor_width = sensor_width;
    geometry.sensor_height = sensor_height;
    geometry.width = request.width != 0 ? request.width : sensor_width;
    geometry.height = request.height != 0 ? request.height : sensor_height;
    geometry.x = request.region.x;
    geometry.y = request.region.y;
    geometry.part_width =
        request.region.width != 0 ? request.region.width : rest_of(geometry.width, geometry.x);
    geometry.part_height =
        request.region.height != 0 ? request.region.height : rest_of(geometry.height, geometry.y);
    return geometry;
}

namespace {

void check_side(const char* name, int size) {
    if (size < 1 || size > kLargestFrameSide)
        throw Error(ErrorKind::usage, std::string{"frame "} + name + ": expected 1 to " +
                                          std::to_string(kLargestFrameSide) + " px, found " +
                                          std::to_string(size));
}

bool lies_within(int size, int at, int part) {
    return at >= 0 && part >= 1 && at <= size - part;
}

void check_part(const FrameGeometry& g) {
    if (lies_within(g.width, g.x, g.part_width) && lies_within(g.height, g.y, g.part_height))
        return;
    throw Error(ErrorKind::usage, "region (roi) exceeds the " + size_text(g.width, g.height) +
                                      " frame: expected a part of it, found " +
                                      size_text(g.part_width, g.part_height) + " from " +
                                      std::to_string(g.x) + "," + std::to_string(g.y));
}

void fit(const FrameGeometry& geometry, Array2<float>& map) {
    if (map.height() != geometry.part_height || map.width() != geometry.part_width)
        map = {geometry.part_height, geometry.part_width};
}

void fit(const FrameGeometry& geometry, bool want_sigma, Frame& frame) {
    fit(geometry, frame.intensity);
    if (want_sigma)
        fit(geometry, frame.sigma);
    else
        frame.sigma = {};
}

}  // namespace

Renderer::Renderer(const Model& model, int sensor_width, int sensor_height,
                   const EngineOptions& options)
    : config_(model.config), sensor_width_(sensor_width), sensor_height_(sensor_height) {
    check_side("width of the sensor", sensor_width);
    check_side("height of the sensor", sensor_height);
    check_model(model, "renderer");
    check_self_ensemble(options.self_ensemble);
    for (int view = 0; view < options.self_ensemble; ++view)
        cores_.push_back(options.engine == Engine::plain
                             ? make_plain_renderer(model)
                             : make_fast_renderer(model, sensor_width, sensor_height, options));
}

Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

std::string Renderer::description() const {
    return cores_.front()->description();
}

std::uint64_t Renderer::pixels_rendered() const noexcept {
    std::uint64_t pixels = 0;
    for (const auto& core : cores_) pixels += core->pixels_rendered();
    return pixels;
}

void Renderer::push(const LatentMap& latent) noexcept {
    const std::int64_t k = window_.push(latent);
    cores_.front()->push(k, latent);
    for (std::size_t view = 1; view < cores_.size(); ++view)
        cores_[view]->push(k, latent.mirrored[view - 1]);
}

void Renderer::take(LatentMap& latent) noexcept {
    const std::int64_t k = window_.push(latent);
    cores_.front()->take(k, latent);
    for (std::size_t view = 1; view < cores_.size(); ++view)
        cores_[view]->take(k, latent.mirrored[view - 1]);
}

void Renderer::finish() noexcept {
    window_.finish();
}

void Renderer::reset() noexcept {
    window_.reset();
    for (const auto& core : cores_) core->reset();
}

Readiness Renderer::readiness(SensorTime t, int lookahead) const noexcept {
    return window_.readiness(t, lookahead);
}

Frame Renderer::make_output(const RenderRequest& request) {
    Frame frame;
    make_room(request, frame);
    return frame;
}

void Renderer::make_room(const RenderRequest& request, Frame& frame) {
    const FrameGeometry geometry = geometry_of(request, sensor_width_, sensor_height_);
    check_side("width", geometry.width);
    check_side("height", geometry.height);
    check_part(geometry);
    if (request.lookahead < 0 || request.lookahead > kMaxLookahead)
        throw Error(ErrorKind::usage,
                    "lookahead: expected 0, 1 or 2, found " + std::to_string(request.lookahead));
    fit(geometry, request.want_sigma, frame);
    for (std::size_t view = 0; view < cores_.size(); ++view)
        cores_[view]->make_room(mirror(geometry, kMirrors[view]));
    if (cores_.size() == 1) return;
    fit(geometry, request.want_sigma, view_);
}

/// mu = mean of mu_i,  sigma = e sqrt(mean of sigma_i^2), e = error_of_mean()
void Renderer::render_views(const CodeChoice& codes, const FrameGeometry& geometry, SigmaRule rule,
                            Frame& frame) noexcept {
    Array2<float>* sigma = frame.sigma.empty() ? nullptr : &frame.sigma;
    cores_.front()->render(codes, geometry, rule, frame.intensity, sigma);
    if (cores_.size() == 1) return;
    fit(geometry, sigma != nullptr, view_);
    if (sigma != nullptr)
        for (float& s : sigma->values()) s *= s;
    for (std::size_t view = 1; view < cores_.size(); ++view) {
        const Mirror axes = kMirrors[view];
        cores_[view]->render(codes, mirror(geometry, axes), rule, view_.intensity,
                             sigma != nullptr ? &view_.sigma : nullptr);
        mirror(view_.intensity, axes);
        std::ranges::transform(frame.intensity.values(), view_.intensity.values(),
                               frame.intensity.values().begin(), std::plus{});
        if (sigma == nullptr) continue;
        mirror(view_.sigma, axes);
        std::ranges::transform(sigma->values(), view_.sigma.values(), sigma->values().begin(),
                               [](float sum, float s) { return sum + s * s; });
    }
    const auto views = int(cores_.size());
    const float share = 1 / float(views), error = float(error_of_mean(views));
    for (float& mu : frame.intensity.values()) mu *= share;
    if (sigma != nullptr)
        for (float& s : sigma->values()) s = error * std::sqrt(share * s);
}

void Renderer::render(const RenderRequest& request, Frame& frame) noexcept {
    if (window_.newest() == 0) return;
    FramePosition at = window_.locate(request.t);
    // A time that is not ready() shows the nearest event window that can be: wrong, but never
    // unsafe.
    if (at.k > window_.newest()) at = {window_.newest(), 1};
    if (at.k == 0) at = window_.locate(window_.oldest());
    const FrameGeometry geometry = geometry_of(request, sensor_width_, sensor_height_);
    const CodeChoice codes{at.k,
                           at.fraction,
                           {window_.known(at.k + 1, at.k, request.lookahead),
                            window_.known(at.k + 2, at.k, request.lookahead)}};
    fit(geometry, request.want_sigma, frame);
    render_views(codes, geometry, request.sigma_rule.value_or(config_.sigma_rule), frame);
    stamp_frame(request.t, 0, window_.stamp(at.k), frame);
    // Of the newest event window that the frame may read.
    frame.arrived = window_.stamp(std::min(window_.newest(), at.k + request.lookahead)).arrived;
}

}  // namespace eventide
