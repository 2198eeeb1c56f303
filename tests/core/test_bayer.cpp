// Which pixel sees which colour, and the pixels of one colour out of an image.
#include "src/core/bayer.h"

#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <string>
#include <utility>

namespace eventide {
namespace {

constexpr std::array kChannels{ColourChannel::blue, ColourChannel::green, ColourChannel::red};

class ColourFilters : public testing::TestWithParam<ColourFilter> {};

TEST_P(ColourFilters, TakeImagesApartByTheirPlaceOnTheSensor) {
    for (const int x0 : {0, 3, -1, -2})
        for (const int y0 : {0, 1, -3, -4}) {
            ReferenceImage mosaic;
            mosaic.x0 = x0;
            mosaic.y0 = y0;
            mosaic.t = from_us(5);
            mosaic.exposure_begin = from_us(3);
            mosaic.exposure_end = from_us(7);
            mosaic.pixels = Array2<std::uint16_t>(5, 7);
            ReferenceImage bgr = mosaic;
            bgr.channels = 3;
            bgr.pixels = Array2<std::uint16_t>(5, 21);
            for (int y = 0; y < 5; ++y)
                for (int x = 0; x < 7; ++x)
                    for (int c = 0; c < 3; ++c) {
                        const auto value = std::uint16_t(500 + 1000 * c + 50 * (y + y0) + x + x0);
                        bgr.pixels(y, 3 * x + c) = value;
                        if (int(channel_at(GetParam(), x + x0, y + y0)) == c)
                            mosaic.pixels(y, x) = value;
                    }
            for (const ColourChannel channel : kChannels) {
                const BayerSite site = site_of(GetParam(), channel);
                const auto part = image_of_site(mosaic, site, channel);
                ASSERT_TRUE(part);
                EXPECT_EQ(part->t, from_us(5));
                EXPECT_EQ(part->exposure_begin, from_us(3));
                EXPECT_EQ(part->exposure_end, from_us(7));
                for (int y = 0; y < part->pixels.height(); ++y)
                    for (int x = 0; x < part->pixels.width(); ++x)
                        EXPECT_EQ(part->pixels(y, x), 500 + 1000 * int(channel) +
                                                          50 * (2 * (y + part->y0) + site.y) +
                                                          2 * (x + part->x0) + site.x);
                EXPECT_EQ(image_of_site(bgr, site, channel)->pixels, part->pixels);
            }
        }
}

TEST_P(ColourFilters, AnImageOfOneRowOrColumnHoldsHalfOfTheColours) {
    for (const auto& [height, width] : {std::pair{1, 8}, {8, 1}}) {
        ReferenceImage mosaic;
        mosaic.pixels = Array2<std::uint16_t>(height, width);
        for (const ColourChannel channel : kChannels) {
            const BayerSite site = site_of(GetParam(), channel);
            const bool holds_it = (height == 1 ? site.y : site.x) == 0;
            EXPECT_EQ(image_of_site(mosaic, site, channel).has_value(), holds_it);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(AllFilters, ColourFilters,
                         testing::Values(ColourFilter::rggb, ColourFilter::grbg, ColourFilter::gbrg,
                                         ColourFilter::bggr),
                         [](const auto& filter) { return std::string{name_of(filter.param)}; });

TEST(ColourFilterNumbers, AreThoseOfLibcaer) {
    // 1 is RGBG: red and green above, green and blue below.
    const ColourFilter first = *colour_filter_of_number(1);
    EXPECT_EQ(channel_at(first, 0, 0), ColourChannel::red);
    EXPECT_EQ(channel_at(first, 1, 0), ColourChannel::green);
    EXPECT_EQ(channel_at(first, 0, 1), ColourChannel::green);
    EXPECT_EQ(channel_at(first, 1, 1), ColourChannel::blue);
    EXPECT_EQ(channel_at(*colour_filter_of_number(4), 2, 2), ColourChannel::blue);
    EXPECT_EQ(colour_filter_of_number(5), std::nullopt);
}

}  // namespace
}  // namespace eventide
