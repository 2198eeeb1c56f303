// See latent_tiles.h.
#include "src/model/encode/latent_tiles.h"

#include <atomic>

namespace eventide {
namespace {

/// From 1 on, as 0 stands for nothing known; encoders may be made on several threads.
std::uint64_t new_source() {
    static std::atomic<std::uint64_t> sources{0};
    return ++sources;
}

}  // namespace

LatentTiles::LatentTiles(int height, int width) : tiles_(latent_tiles(height, width)) {
    history_.source = new_source();
    history_.changed.resize(tiles_.size());
}

}  // namespace eventide
