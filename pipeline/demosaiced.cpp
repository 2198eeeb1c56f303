// By OpenCV, bilinear.
#include "pipeline/demosaiced.h"

#include "src/core/bayer.h"

#include <opencv2/imgproc.hpp>

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

ReferenceImage demosaiced(const ReferenceImage& image, ColourFilter filter) {
    if (filter == ColourFilter::none) filter = image.filter;
    // Of less than two rows or columns there is nothing to interpolate.
    if (image.channels != 1 || filter == ColourFilter::none || image.pixels.height() < 2 ||
        image.pixels.width() < 2)
        return image;
    ReferenceImage colour = image;
    colour.channels = 3;
    colour.filter = ColourFilter::none;
    colour.pixels = Array2<std::uint16_t>(image.pixels.height(), 3 * image.pixels.width());
    const cv::Mat mosaic(image.pixels.height(), image.pixels.width(), CV_16UC1,
                         const_cast<std::uint16_t*>(image.pixels.values().data()));
    cv::Mat bgr(mosaic.rows, mosaic.cols, CV_16UC3, colour.pixels.values().data());
    cv::cvtColor(mosaic, bgr, opencv_code(filter_at(filter, image.x0, image.y0)));
    return colour;
}

}  // namespace eventide
