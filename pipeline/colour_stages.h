// Colour out of a sensor with a colour filter: the pixels of each colour have a network of their
// own, beside that of all pixels.
#pragma once

#include "pipeline/stages.h"
#include "src/core/bayer.h"

#include <array>
#include <memory>
#include <vector>

namespace eventide {

inline constexpr std::array kColourChannels{ColourChannel::blue, ColourChannel::green,
                                            ColourChannel::red};

/// Grids of the whole sensor, whose sides are even, become LatentMap::values by the stage for all
/// pixels, and LatentMap::channels by those for one colour each, half as wide and high.
class ColourEncodeStage final : public EncodeStage {
public:
    ColourEncodeStage(EncodeStage& all, std::array<EncodeStage*, 3> channels, ColourFilter filter,
                      int sensor_width, int sensor_height, int bins);

    LatentMap make_output() const override;
    void reset() noexcept override;

private:
    void step(const VoxelGrid& grid, LatentMap& latent) noexcept override;

    EncodeStage& all_;
    std::array<EncodeStage*, 3> channels_;
    ColourFilter filter_;
    VoxelGrid part_;
    LatentMap codes_;
};

/// Intensity and sigma are those of the stage for all pixels. Frame::colour has its detail, and the
/// differences between the colours of the stages for one colour each, which render their own size.
class ColourRenderStage final : public RenderStage {
public:
    /// What part of the whole frame is rendered, as RenderRequest says.
    struct View {
        int width = 0, height = 0;  ///< px, of the whole frame
        int left = 0, top = 0;      ///< px, of the part
    };

    /// `codes`: what the encoder's make_output() gives.
    ColourRenderStage(RenderStage& all, std::array<RenderStage*, 3> channels, ColourFilter filter,
                      int sensor_width, int sensor_height, const View& view,
                      const LatentMap& codes);

    Frame make_output() const override;
    void take(LatentMap& latent) noexcept override;
    void finish() noexcept override;
    void reset() noexcept override;
    void render(SensorTime t, const Window& window, Frame& frame) noexcept override;
    bool change_lookahead(int lookahead) override;
    bool change_size(int width, int height, Frame& frame) override;

private:
    /// Where a row or column of the frame lies among those of a channel.
    struct Tap {
        int first = 0, second = 0;
        float share = 0;  ///< of the second
    };
    using Taps = std::array<std::vector<Tap>, 3>;
    void make_taps(int height, int width, const View& view, Taps& rows, Taps& columns) const;
    static std::vector<Tap> taps(int count, int offset, int whole, int sensor, int site);

    RenderStage& all_;
    std::array<RenderStage*, 3> channels_;
    ColourFilter filter_;
    int sensor_width_, sensor_height_;
    View view_;
    std::array<LatentMap, 3> codes_;
    std::array<Frame, 3> parts_;
    Taps rows_, columns_;
};

}  // namespace eventide
