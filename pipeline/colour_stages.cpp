// Colour out of a sensor with a colour filter.
#include "pipeline/colour_stages.h"

#include "src/core/grey.h"

#include <algorithm>
#include <cassert>

namespace eventide {

namespace {

/// Every second row and column, from the site on.
void take_site(const VoxelGrid& grid, const BayerSite& site, VoxelGrid& part) {
    const int height = part.values.height(), width = part.values.width();
    assert(part.values.channels() == grid.values.channels());
    const bool tracked = !grid.touched.empty();
    copy_stamp(grid, part);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const int from_y = 2 * y + site.y, from_x = 2 * x + site.x;
            std::ranges::copy(grid.values.pixel(from_y, from_x), part.values.pixel(y, x).begin());
            if (tracked) part.touched(y, x) = grid.touched(from_y, from_x);
        }
}

void take_site(const Array2<float>& map, const BayerSite& site, Array2<float>& part) {
    for (int y = 0; y < part.height(); ++y)
        for (int x = 0; x < part.width(); ++x) part(y, x) = map(2 * y + site.y, 2 * x + site.x);
}

}  // namespace

ColourEncodeStage::ColourEncodeStage(EncodeStage& all, std::array<EncodeStage*, 3> channels,
                                     ColourFilter filter, int sensor_width, int sensor_height,
                                     int bins)
    : all_(all), channels_(channels), filter_(filter) {
    part_.values = Array3<float>(sensor_height / 2, sensor_width / 2, 4 * bins + 1);
    part_.touched = Array2<std::uint8_t>(sensor_height / 2, sensor_width / 2);
}

LatentMap ColourEncodeStage::make_output() const {
    LatentMap latent = all_.make_output();
    for (const EncodeStage* stage : channels_) {
        LatentMap codes = stage->make_output();
        latent.channels.push_back(std::move(static_cast<LatentCodes&>(codes)));
    }
    return latent;
}

void ColourEncodeStage::step(const VoxelGrid& grid, LatentMap& latent) noexcept {
    all_.encode(grid, latent);
    for (std::size_t c = 0; c < channels_.size(); ++c) {
        take_site(grid, site_of(filter_, kColourChannels[c]), part_);
        LatentCodes& codes = codes_;
        std::swap(codes, latent.channels[c]);
        channels_[c]->encode(part_, codes_);
        std::swap(codes, latent.channels[c]);
    }
}

void ColourEncodeStage::reset() noexcept {
    all_.reset();
    for (EncodeStage* stage : channels_) stage->reset();
}

ColourRenderStage::ColourRenderStage(RenderStage& all, std::array<RenderStage*, 3> channels,
                                     ColourFilter filter, int sensor_width, int sensor_height,
                                     const View& view, const LatentMap& codes)
    : all_(all),
      channels_(channels),
      filter_(filter),
      sensor_width_(sensor_width),
      sensor_height_(sensor_height),
      view_(view) {
    for (std::size_t c = 0; c < channels_.size(); ++c) {
        parts_[c] = channels_[c]->make_output();
        static_cast<LatentCodes&>(codes_[c]) = codes.channels[c];
        codes_[c].events_per_pixel = Array2<float>(sensor_height / 2, sensor_width / 2);
    }
    const Frame frame = all_.make_output();
    make_taps(frame.intensity.height(), frame.intensity.width(), view_, rows_, columns_);
}

Frame ColourRenderStage::make_output() const {
    Frame frame = all_.make_output();
    for (Array2<float>& plane : frame.colour)
        plane = Array2<float>(frame.intensity.height(), frame.intensity.width());
    return frame;
}

/// Corners of frames lie on corners of the sensor (docs/model.md).
std::vector<ColourRenderStage::Tap> ColourRenderStage::taps(int count, int offset, int whole,
                                                            int sensor, int site) {
    const double scale = whole > 1 ? double(sensor - 1) / (whole - 1) : 0;
    const int last = sensor / 2 - 1;
    std::vector<Tap> taps(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        const double at = std::clamp(((offset + i) * scale - site) / 2, 0.0, double(last));
        const int first = int(at);
        taps[std::size_t(i)] = {first, std::min(first + 1, last), float(at - first)};
    }
    return taps;
}

void ColourRenderStage::make_taps(int height, int width, const View& view, Taps& rows,
                                  Taps& columns) const {
    for (std::size_t c = 0; c < channels_.size(); ++c) {
        const BayerSite site = site_of(filter_, kColourChannels[c]);
        rows[c] = taps(height, view.top, view.height, sensor_height_, site.y);
        columns[c] = taps(width, view.left, view.width, sensor_width_, site.x);
    }
}

void ColourRenderStage::take(LatentMap& latent) noexcept {
    for (std::size_t c = 0; c < channels_.size(); ++c) {
        LatentMap& codes = codes_[c];
        copy_stamp(latent, codes);
        std::swap(static_cast<LatentCodes&>(codes), latent.channels[c]);
        if (!latent.events_per_pixel.empty())
            take_site(latent.events_per_pixel, site_of(filter_, kColourChannels[c]),
                      codes.events_per_pixel);
        channels_[c]->take(codes);
        std::swap(static_cast<LatentCodes&>(codes), latent.channels[c]);
    }
    all_.take(latent);
}

void ColourRenderStage::finish() noexcept {
    all_.finish();
    for (RenderStage* stage : channels_) stage->finish();
}

void ColourRenderStage::reset() noexcept {
    all_.reset();
    for (RenderStage* stage : channels_) stage->reset();
}

void ColourRenderStage::render(SensorTime t, const Window& window, Frame& frame) noexcept {
    all_.render(t, window, frame);
    for (std::size_t c = 0; c < channels_.size(); ++c) channels_[c]->render(t, window, parts_[c]);
    const int height = frame.intensity.height(), width = frame.intensity.width();
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            std::array<float, 3> colour;
            float luma = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                const Tap &row = rows_[c][std::size_t(y)], &column = columns_[c][std::size_t(x)];
                const Array2<float>& part = parts_[c].intensity;
                const auto across = [&](int r) {
                    const float left = part(r, column.first), right = part(r, column.second);
                    return left + column.share * (right - left);
                };
                const float above = across(row.first);
                colour[c] = above + row.share * (across(row.second) - above);
                luma += kLumaBgr[c] * colour[c];
            }
            for (std::size_t c = 0; c < 3; ++c)
                frame.colour[c](y, x) = frame.intensity(y, x) + colour[c] - luma;
        }
}

bool ColourRenderStage::change_lookahead(int lookahead) {
    bool all = all_.change_lookahead(lookahead);
    for (RenderStage* stage : channels_) all = stage->change_lookahead(lookahead) && all;
    return all;
}

bool ColourRenderStage::change_size(int width, int height, Frame& frame) {
    // Memory first: once the stage for all pixels has changed, nothing fails.
    Taps rows, columns;
    View view = view_;
    view.width = width;
    view.height = height;
    make_taps(height, width, view, rows, columns);
    std::array<Array2<float>, 3> colour;
    for (Array2<float>& plane : colour) plane = Array2<float>(height, width);
    if (!all_.change_size(width, height, frame)) return false;
    view_ = view;
    rows_ = std::move(rows);
    columns_ = std::move(columns);
    frame.colour = std::move(colour);
    return true;
}

}  // namespace eventide
