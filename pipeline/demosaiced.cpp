// By OpenCV, bilinear.
#include "pipeline/demosaiced.h"

#include "src/core/bayer.h"

#include <opencv2/imgproc.hpp>

#include <utility>

namespace eventide {

namespace {

int opencv_code(ColourFilter filter) {
    switch (filter) {
        case ColourFilter::grbg:
            return cv::COLOR_BayerGRBG2BGR;
        case ColourFilter::gbrg:
            return cv::COLOR_BayerGBRG2BGR;
        case ColourFilter::bggr:
            return cv::COLOR_BayerBGGR2BGR;
        case ColourFilter::none:
        case ColourFilter::rggb:
            break;
    }
    return cv::COLOR_BayerRGGB2BGR;
}

}  // namespace

std::optional<ColourFilter> told_filter(ColourFilter filter, bool is_stated) {
    if (filter == ColourFilter::none && !is_stated) return std::nullopt;
    return filter;
}

ReferenceImage demosaiced(ReferenceImage image, std::optional<ColourFilter> told) {
    const ColourFilter filter = told.value_or(image.filter);
    // Of less than two rows or columns there is nothing to interpolate.
    if (image.channels != 1 || filter == ColourFilter::none || image.pixels.height() < 2 ||
        image.pixels.width() < 2)
        return image;
    Array2<std::uint16_t> colours(image.pixels.height(), 3 * image.pixels.width());
    const cv::Mat mosaic(image.pixels.height(), image.pixels.width(), CV_16UC1,
                         image.pixels.values().data());
    cv::Mat bgr(mosaic.rows, mosaic.cols, CV_16UC3, colours.values().data());
    cv::cvtColor(mosaic, bgr, opencv_code(filter_at(filter, image.x0, image.y0)));
    image.pixels = std::move(colours);
    image.channels = 3;
    image.filter = ColourFilter::none;
    return image;
}

}  // namespace eventide
