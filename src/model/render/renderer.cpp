// Renderer: requests checked, times located, then handed over to the engine that was chosen.
#include "src/model/render/renderer.h"

#include "src/core/error.h"
#include "src/core/frame_stamp.h"
#include "src/core/sensor_limits.h"
#include "src/model/cores.h"

#include <algorithm>

namespace eventide {

FrameGeometry geometry_of(const RenderRequest& request, int sensor_width, int sensor_height) {
    FrameGeometry geometry;
    geometry.sensor_width = sensor_width;
    geometry.sensor_height = sensor_height;
    geometry.width = request.width != 0 ? request.width : sensor_width;
    geometry.height = request.height != 0 ? request.height : sensor_height;
    geometry.x = request.region.x;
    geometry.y = request.region.y;
    geometry.part_width =
        request.region.width != 0 ? request.region.width : geometry.width - geometry.x;
    geometry.part_height =
        request.region.height != 0 ? request.region.height : geometry.height - geometry.y;
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
    const auto size = [](int width, int height) {
        return std::to_string(width) + "x" + std::to_string(height);
    };
    throw Error(ErrorKind::usage, "--roi exceeds the " + size(g.width, g.height) +
                                      " frame: expected a part of it, found " +
                                      size(g.part_width, g.part_height) + " from " +
                                      std::to_string(g.x) + "," + std::to_string(g.y));
}

void fit(Array2<float>& map, int height, int width) {
    if (map.height() != height || map.width() != width) map = {height, width};
}

}  // namespace

Renderer::Renderer(const Model& model, int sensor_width, int sensor_height,
                   const EngineOptions& options)
    : config_(model.config), sensor_width_(sensor_width), sensor_height_(sensor_height) {
    check_side("width of the sensor", sensor_width);
    check_side("height of the sensor", sensor_height);
    check_model(model, "renderer");
    core_ = options.engine == Engine::plain
                ? make_plain_renderer(model)
                : make_fast_renderer(model, sensor_width, sensor_height, options);
}

Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

std::string Renderer::description() const {
    return core_->description();
}

std::uint64_t Renderer::pixels_rendered() const noexcept {
    return core_->pixels_rendered();
}

void Renderer::push(const LatentMap& latent) noexcept {
    core_->push(window_.push(latent), latent);
}

void Renderer::take(LatentMap& latent) noexcept {
    core_->take(window_.push(latent), latent);
}

void Renderer::finish() noexcept {
    window_.finish();
}

void Renderer::reset() noexcept {
    window_.reset();
    core_->reset();
}

Readiness Renderer::readiness(SensorTime t, int lookahead) const noexcept {
    return window_.readiness(t, lookahead);
}

Frame Renderer::make_output(const RenderRequest& request) const {
    const FrameGeometry geometry = geometry_of(request, sensor_width_, sensor_height_);
    check_side("width", geometry.width);
    check_side("height", geometry.height);
    check_part(geometry);
    if (request.lookahead < 0 || request.lookahead > kMaxLookahead)
        throw Error(ErrorKind::usage,
                    "lookahead: expected 0, 1 or 2, found " + std::to_string(request.lookahead));
    Frame frame;
    frame.intensity = {geometry.part_height, geometry.part_width};
    if (request.want_sigma) frame.sigma = {geometry.part_height, geometry.part_width};
    core_->make_room(geometry);
    return frame;
}

void Renderer::render(const RenderRequest& request, Frame& frame) noexcept {
    if (window_.newest() == 0) return;
    FramePosition at = window_.locate(request.t);
    // A time that is not ready() shows the nearest event window kept: wrong, but never unsafe.
    if (at.k > window_.newest()) at = {window_.newest(), 1};
    if (at.k == 0)
        // The oldest k whose z_{k-2} is still kept.
        at = {std::max<std::int64_t>(1, window_.newest() - LatentWindow::kLatentsKept + 3), 0};
    const FrameGeometry geometry = geometry_of(request, sensor_width_, sensor_height_);
    const CodeChoice codes{at.k,
                           at.fraction,
                           {window_.known(at.k + 1, at.k, request.lookahead),
                            window_.known(at.k + 2, at.k, request.lookahead)}};
    fit(frame.intensity, geometry.part_height, geometry.part_width);
    if (request.want_sigma)
        fit(frame.sigma, geometry.part_height, geometry.part_width);
    else
        frame.sigma = {};
    core_->render(codes, geometry, request.sigma_rule.value_or(config_.sigma_rule), frame.intensity,
                  request.want_sigma ? &frame.sigma : nullptr);
    stamp_frame(request.t, 0, window_.stamp(at.k), frame);
    // Of the newest event window that the frame may read.
    frame.arrived = window_.stamp(std::min(window_.newest(), at.k + request.lookahead)).arrived;
}

}  // namespace eventide
