// Colours out of a mosaic: each network sees the pixels of its colour, and frames put them where
// they are.
#include "pipeline/colour_stages.h"
#include "tests/support/allocation_counter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <optional>
#include <utility>

namespace eventide {
namespace {

constexpr int kHeight = 8, kWidth = 12, kBins = 2;

/// Its codes are the grid's first number, and its frames the newest codes, of any size, cut where
/// the request says: corners on corners.
class EchoEncoder final : public EncodeStage {
public:
    EchoEncoder(int height, int width) : height_(height), width_(width) {}
    LatentMap make_output() const override {
        LatentMap latent;
        latent.values = Array3<float>(height_, width_, 1);
        return latent;
    }
    void reset() noexcept override { ++resets; }
    int resets = 0;
    Array2<std::uint8_t> touched;  // of the newest grid

private:
    void step(const VoxelGrid& grid, LatentMap& latent) noexcept override {
        touched = grid.touched;
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x) latent.values(y, x, 0) = grid.values(y, x, 0);
    }

    int height_, width_;
};

class EchoRenderer final : public RenderStage {
public:
    EchoRenderer(int height, int width, int out_height, int out_width)
        : height_(height), width_(width), out_height_(out_height), out_width_(out_width) {}
    Frame make_output() const override {
        Frame frame;
        frame.intensity = frame.sigma = Array2<float>(out_height_, out_width_);
        return frame;
    }
    void take(LatentMap& latent) noexcept override {
        newest_ = latent.values;
        stamp = latent;
        events_per_pixel = latent.events_per_pixel;
    }
    void finish() noexcept override { ++ends; }
    void reset() noexcept override { ++resets; }
    bool change_lookahead(int to) override {
        lookahead = to;
        return can_change_lookahead;
    }
    void render(SensorTime, const Window&, Frame& frame) noexcept override {
        for (int y = 0; y < out_height_; ++y)
            for (int x = 0; x < out_width_; ++x) {
                const double v = double(y) * (height_ - 1) / (out_height_ - 1),
                             u = double(x) * (width_ - 1) / (out_width_ - 1);
                frame.intensity(y, x) = newest_(int(std::lround(v)), int(std::lround(u)), 0);
                frame.sigma(y, x) = .125F;
            }
    }
    bool change_size(int width, int height, Frame& frame) override {
        if (!can_change_size) return false;
        out_width_ = width;
        out_height_ = height;
        frame = make_output();
        if (takes_the_last_memory) shortage.emplace(1);
        return true;
    }
    WindowStamp stamp;
    Array2<float> events_per_pixel;
    int ends = 0, resets = 0, lookahead = 0;
    bool can_change_lookahead = true, can_change_size = true;
    bool takes_the_last_memory = false;
    std::optional<test::MemoryShortage> shortage;

private:
    int height_, width_, out_height_, out_width_;
    Array3<float> newest_;
};

/// Intensity of each colour, slanted so that places can be told.
float shown(ColourChannel channel, double x, double y) {
    switch (channel) {
        case ColourChannel::blue:
            return float(.2 + .010 * x);
        case ColourChannel::green:
            return float(.5 + .008 * y);
        case ColourChannel::red:
            break;
    }
    return float(.9 - .012 * x - .004 * y);
}

/// The encoders of all pixels and of each colour, and the stage of them.
struct Encoders {
    explicit Encoders(ColourFilter filter)
        : encode{all, {&blue, &green, &red}, filter, kWidth, kHeight, kBins} {}

    EchoEncoder all{kHeight, kWidth}, blue{kHeight / 2, kWidth / 2}, green{kHeight / 2, kWidth / 2},
        red{kHeight / 2, kWidth / 2};
    ColourEncodeStage encode;
};

/// Their renderers. Frames of all pixels are of `width` and `height`.
struct Renderers {
    Renderers(ColourFilter filter, const ColourRenderStage::View& view, int height, int width,
              const LatentMap& latent)
        : whole{kHeight, kWidth, height, width}, render{whole,   {&parts[0], &parts[1], &parts[2]},
                                                        filter,  kWidth,
                                                        kHeight, view,
                                                        latent} {}

    EchoRenderer whole;
    std::array<EchoRenderer, 3> parts{
        EchoRenderer{kHeight / 2, kWidth / 2, kHeight / 2, kWidth / 2},
        EchoRenderer{kHeight / 2, kWidth / 2, kHeight / 2, kWidth / 2},
        EchoRenderer{kHeight / 2, kWidth / 2, kHeight / 2, kWidth / 2}};
    ColourRenderStage render;
};

class ColourStages : public testing::TestWithParam<ColourFilter> {
protected:
    VoxelGrid grid() const {
        VoxelGrid grid;
        grid.values = Array3<float>(kHeight, kWidth, 4 * kBins + 1);
        grid.touched = Array2<std::uint8_t>(kHeight, kWidth);
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x)
                grid.values(y, x, 0) = shown(channel_at(GetParam(), x, y), x, y);
        return grid;
    }
};

TEST_P(ColourStages, PutEachColourWhereItsPixelsAre) {
    Encoders encoders{GetParam()};
    auto& [all, blue, green, red, encode] = encoders;
    // Frames may be given another size between two of them.
    for (const auto& [first_scale, scale] : {std::pair{1, 1}, {3, 3}, {1, 3}, {3, 1}}) {
        const auto across = [](int factor) { return (kWidth - 1) * factor + 1; };
        const auto down = [](int factor) { return (kHeight - 1) * factor + 1; };
        LatentMap latent = encode.make_output();
        Renderers renderers{GetParam(),
                            {across(first_scale), down(first_scale), 0, 0},
                            down(first_scale),
                            across(first_scale),
                            latent};
        auto& [whole, parts, render] = renderers;
        encode.encode(grid(), latent);
        render.take(latent);
        Frame frame = render.make_output();
        const int width = across(scale), height = down(scale);
        if (scale != first_scale) {
            render.render({}, {}, frame);
            ASSERT_TRUE(render.change_size(width, height, frame));
        }
        render.render({}, {}, frame);
        ASSERT_EQ(frame.colour[0].width(), width);
        EXPECT_EQ(frame.sigma(0, 0), .125F) << "one map, that of all pixels";
        // Inside, where every colour has pixels on both sides, differences of colours are exact.
        for (int y = scale; y < height - scale; ++y)
            for (int x = scale; x < width - scale; ++x) {
                const double u = double(x) / scale, v = double(y) / scale;
                const float b = shown(ColourChannel::blue, u, v),
                            g = shown(ColourChannel::green, u, v),
                            r = shown(ColourChannel::red, u, v);
                EXPECT_NEAR(frame.colour[2](y, x) - frame.colour[0](y, x), r - b, 1e-5);
                EXPECT_NEAR(frame.colour[1](y, x) - frame.colour[0](y, x), g - b, 1e-5);
                // And the luma is the intensity of all pixels.
                EXPECT_NEAR(.114F * frame.colour[0](y, x) + .587F * frame.colour[1](y, x) +
                                .299F * frame.colour[2](y, x),
                            frame.intensity(y, x), 1e-5);
            }
    }
    encode.reset();
    EXPECT_EQ(all.resets + blue.resets + green.resets + red.resets, 4);
}

/// A part of a frame shows what the whole frame shows there; beyond the outermost pixels of a
/// colour theirs goes on.
TEST_P(ColourStages, ShowPartsOfFramesAndTheirEdges) {
    Encoders encoders{GetParam()};
    auto& [all, blue, green, red, encode] = encoders;
    LatentMap latent = encode.make_output();
    encode.encode(grid(), latent);
    const auto shown_at = [&](const ColourRenderStage::View& view, int height, int width) {
        Renderers renderers{GetParam(), view, height, width, latent};
        auto& [whole, parts, render] = renderers;
        render.take(latent);
        Frame frame = render.make_output();
        render.render({}, {}, frame);
        return frame;
    };
    /// Red less blue, which the frame of all pixels has no part in.
    const auto difference = [](const Frame& frame, int y, int x) {
        return frame.colour[2](y, x) - frame.colour[0](y, x);
    };
    const Frame whole = shown_at({kWidth, kHeight, 0, 0}, kHeight, kWidth);
    const Frame part = shown_at({kWidth, kHeight, 5, 3}, 4, 6);
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 6; ++x)
            EXPECT_NEAR(difference(part, y, x), difference(whole, y + 3, x + 5), 1e-6);
    const Frame one = shown_at({1, 1, 0, 0}, 1, 1);
    EXPECT_NEAR(difference(one, 0, 0), difference(whole, 0, 0), 1e-6);
    /// Of every second pixel from `site` on.
    const auto nearest = [](int at, int size, int site) {
        return std::clamp(at, site, size - 2 + site);
    };
    for (const int y : {0, kHeight - 1})
        for (const int x : {0, kWidth - 1}) {
            const auto seen = [&](ColourChannel channel) {
                const BayerSite site = site_of(GetParam(), channel);
                return shown(channel, nearest(x, kWidth, site.x), nearest(y, kHeight, site.y));
            };
            EXPECT_NEAR(difference(whole, y, x),
                        seen(ColourChannel::red) - seen(ColourChannel::blue), 1e-5);
        }
}

TEST_P(ColourStages, TellEachColourWhatIsKnownOfItsPixelsAndOfTheWindow) {
    Encoders encoders{GetParam()};
    auto& [all, blue, green, red, encode] = encoders;
    LatentMap latent = encode.make_output();
    Renderers renderers{GetParam(), {kWidth, kHeight, 0, 0}, kHeight, kWidth, latent};
    auto& [whole, parts, render] = renderers;
    VoxelGrid events = grid();
    events.window = {from_us(5), from_us(9)};
    latent.events_per_pixel = Array2<float>(kHeight, kWidth);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            events.touched(y, x) = std::uint8_t(channel_at(GetParam(), x, y) == ColourChannel::red);
            latent.events_per_pixel(y, x) = float(channel_at(GetParam(), x, y));
        }
    encode.encode(events, latent);
    render.take(latent);
    for (const auto& [encoder, channel] : {std::pair{&blue, ColourChannel::blue},
                                           {&green, ColourChannel::green},
                                           {&red, ColourChannel::red}}) {
        const EchoRenderer& renderer = parts[std::size_t(channel)];
        for (const std::uint8_t touched : encoder->touched.values())
            EXPECT_EQ(touched, channel == ColourChannel::red ? 1 : 0);
        EXPECT_EQ(renderer.stamp.window.end, from_us(9));
        for (const float n : renderer.events_per_pixel.values()) EXPECT_EQ(n, float(channel));
    }
    EXPECT_EQ(whole.stamp.window.end, from_us(9));
    render.finish();
    render.reset();
    parts[1].can_change_lookahead = false;
    EXPECT_FALSE(render.change_lookahead(2)) << "green cannot";
    for (const EchoRenderer* each : {&whole, &parts[0], &parts[1], &parts[2]}) {
        EXPECT_EQ(each->ends, 1);
        EXPECT_EQ(each->resets, 1);
        EXPECT_EQ(each->lookahead, 2);
    }
    parts[1].can_change_lookahead = true;
    EXPECT_TRUE(render.change_lookahead(1));
}

TEST_P(ColourStages, ChangeTheSizeOfAllColoursOrOfNone) {
    if (!test::can_count_allocations()) GTEST_SKIP() << "sanitizers bring their own malloc";
    Encoders encoders{GetParam()};
    auto& [all, blue, green, red, encode] = encoders;
    LatentMap latent = encode.make_output();
    Renderers renderers{GetParam(), {kWidth, kHeight, 0, 0}, kHeight, kWidth, latent};
    auto& [whole, parts, render] = renderers;
    encode.encode(grid(), latent);
    render.take(latent);
    Frame frame = render.make_output();
    {
        const test::MemoryShortage shortage{1};
        EXPECT_THROW(render.change_size(2 * kWidth, 2 * kHeight, frame), std::bad_alloc);
    }
    render.render({}, {}, frame);
    EXPECT_EQ(frame.intensity.width(), kWidth);
    EXPECT_EQ(frame.colour[0].width(), kWidth);
    whole.can_change_size = false;
    EXPECT_FALSE(render.change_size(2 * kWidth, 2 * kHeight, frame));
    render.render({}, {}, frame);
    EXPECT_EQ(frame.colour[0].width(), kWidth);
    whole.can_change_size = true;
    whole.takes_the_last_memory = true;
    EXPECT_TRUE(render.change_size(2 * kWidth, 2 * kHeight, frame));
    whole.shortage.reset();
    render.render({}, {}, frame);
    EXPECT_EQ(frame.intensity.width(), 2 * kWidth);
    EXPECT_EQ(frame.colour[2].width(), 2 * kWidth);
}

INSTANTIATE_TEST_SUITE_P(AllFilters, ColourStages,
                         testing::Values(ColourFilter::rggb, ColourFilter::grbg, ColourFilter::gbrg,
                                         ColourFilter::bggr),
                         [](const auto& filter) { return std::string{name_of(filter.param)}; });

}  // namespace
}  // namespace eventide
