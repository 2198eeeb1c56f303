// Filters that put events and images elsewhere.
#include "pipeline/filters/placing_filters.h"

#include "src/core/bayer.h"

#include <utility>

namespace eventide {

namespace {

int width_of(const ReferenceImage& image) {
    return image.pixels.width() / image.channels;
}

/// The image of width x height px whose pixel (x, y) is that of `image` at place(x, y).
template <typename Place>
Array2<std::uint16_t> placed(const ReferenceImage& image, int width, int height, Place place) {
    Array2<std::uint16_t> pixels(height, width * image.channels);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const auto [from_x, from_y] = place(x, y);
            for (int c = 0; c < image.channels; ++c)
                pixels(y, x * image.channels + c) =
                    image.pixels(from_y, from_x * image.channels + c);
        }
    return pixels;
}

/// That of pixels whose (x, y) lay at place(x, y).
template <typename Place>
ColourFilter pattern_of_places(ColourFilter before, Place place) {
    if (before == ColourFilter::none) return before;
    return filter_with([&](int x, int y) {
        const auto [from_x, from_y] = place(x, y);
        return channel_at(before, from_x, from_y);
    });
}

}  // namespace

ColourFilter FlipFilter::pattern(ColourFilter before) const {
    return pattern_of_places(before, [this](int x, int y) {
        return across_ ? std::pair{size_.width - 1 - x, y} : std::pair{x, size_.height - 1 - y};
    });
}

void FlipFilter::process(Batch& batch) {
    for (Event& event : batch.events) {
        if (across_)
            event.x = std::uint16_t(size_.width - 1 - event.x);
        else
            event.y = std::uint16_t(size_.height - 1 - event.y);
    }
    for (ReferenceImage& image : batch.images) {
        const int width = width_of(image), height = image.pixels.height();
        image.pixels = placed(image, width, height, [&](int x, int y) {
            return across_ ? std::pair{width - 1 - x, y} : std::pair{x, height - 1 - y};
        });
        if (across_)
            image.x0 = size_.width - image.x0 - width;
        else
            image.y0 = size_.height - image.y0 - height;
        image.filter = pattern(image.filter);
    }
}

ColourFilter TransposeFilter::pattern(ColourFilter before) const {
    return pattern_of_places(before, [](int x, int y) { return std::pair{y, x}; });
}

void TransposeFilter::process(Batch& batch) {
    for (Event& event : batch.events) std::swap(event.x, event.y);
    for (ReferenceImage& image : batch.images) {
        image.pixels = placed(image, image.pixels.height(), width_of(image), [](int x, int y) {
            return std::pair{y, x};
        });
        std::swap(image.x0, image.y0);
        image.filter = pattern(image.filter);
    }
}

ColourFilter ThinningFilter::pattern(ColourFilter before) const {
    return pattern_of_places(before, [this](int x, int y) {
        return std::pair{x * columns_, y * rows_};
    });
}

void ThinningFilter::process(Batch& batch) {
    std::erase_if(batch.events, [this](const Event& event) {
        return event.x % columns_ != 0 || event.y % rows_ != 0;
    });
    for (Event& event : batch.events) {
        event.x = std::uint16_t(event.x / columns_);
        event.y = std::uint16_t(event.y / rows_);
    }
    for (ReferenceImage& image : batch.images) {
        // The first pixel of the image that lies at such multiples.
        const auto first = [](int at, int step) { return (step - at % step) % step; };
        const int dx = first(image.x0, columns_), dy = first(image.y0, rows_);
        const auto kept = [](int n, int skipped, int step) {
            return n <= skipped ? 0 : (n - skipped + step - 1) / step;
        };
        const int width = kept(width_of(image), dx, columns_),
                  height = kept(image.pixels.height(), dy, rows_);
        image.pixels = placed(image, width, height, [&](int x, int y) {
            return std::pair{dx + x * columns_, dy + y * rows_};
        });
        image.x0 = (image.x0 + dx) / columns_;
        image.y0 = (image.y0 + dy) / rows_;
        image.filter = pattern(image.filter);
    }
    std::erase_if(batch.images, [](const ReferenceImage& image) { return image.pixels.empty(); });
}

}  // namespace eventide
