// Where a frame shows a scene that stands still: there it shows the end of the event window,
// whatever its time, so that what does not change is shown as it was.
#pragma once

#include "src/core/array.h"
#include "src/model/render/frame_layout.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace eventide {

/// The formula for all engines: a tile of the latent map is still where every code that the frame's
/// samples in it (and in those beside it that they are blended with) read is the same in all event
/// windows the frame reads; docs/model.md, "Renderer".
///
/// `t`: the samples of the frame's own time; `still_t`: those of the time that may be shown in its
/// place. Where they are equal nothing is still; nor is it with the thesis' network, whose codes
/// change for ever.
/// `codes`: z_{k-2} .. z_{k+2}, null where unknown. Returns 1 for the pixels of the frame's part
/// that are in such tiles.
template <typename T>
Array2<std::uint8_t> still_pixels(const ModelConfig& config,
                                  const std::array<const Array3<T>*, 5>& codes,
                                  const AxisSamples& t, const AxisSamples& still_t,
                                  const FrameGeometry& geometry) {
    Array2<std::uint8_t> still(geometry.part_height, geometry.part_width);
    if (config.encoder != EncoderKind::gated || still_t == t) return still;
    const CodesRead read = codes_read(t.index, codes[3] != nullptr, codes[4] != nullptr);
    const Array3<T>& newest = *codes[2];
    const auto tiles = latent_tiles(newest.height(), newest.width());
    const auto is_still = [&](std::size_t n) {
        const Tile near = tiles[n].grown(config.unfold / 2, newest.height(), newest.width());
        for (int dk = read.oldest; dk <= read.newest; ++dk) {
            const Array3<T>* z = codes[std::size_t(2 + dk)];
            if (z == nullptr) return false;
            const Array3<T>& first = *codes[std::size_t(2 + read.oldest)];
            for (int y = near.y0; y < near.y1; ++y)
                for (int x = near.x0; x < near.x1; ++x)
                    if (!std::ranges::equal(z->pixel(y, x), first.pixel(y, x))) return false;
        }
        return true;
    };
    FrameLayout layout;
    layout.make(geometry, config.latent_stride, config.blend, latent_row_edges(newest.height()),
                latent_column_edges(newest.width()));
    for (int r = 0; r < layout.rows.count(); ++r)
        for (int c = 0; c < layout.columns.count(); ++c) {
            if (!layout.all_read(r, c, is_still)) continue;
            for (int y = layout.rows.begin[std::size_t(r)];
                 y < layout.rows.begin[std::size_t(r) + 1]; ++y)
                for (int x = layout.columns.begin[std::size_t(c)];
                     x < layout.columns.begin[std::size_t(c) + 1]; ++x)
                    still(y, x) = 1;
        }
    return still;
}

}  // namespace eventide
