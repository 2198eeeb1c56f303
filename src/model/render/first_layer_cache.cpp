// See first_layer_cache.h; docs/model.md has the formulas.
#include "src/model/render/first_layer_cache.h"

#include "src/kernels/vector_kernels.h"

#include <algorithm>
#include <cstring>

namespace eventide {
namespace {

/// Layer 1 as a convolution over the first `codes` of the three codes, joined per pixel.
///
///     renderer    [out][dt][dy dx][d], then 3 offsets; of D = 16, unfold 1: 32 x (48 + 3)
///     here        [out][code, d][dy dx], code = dt + 1: 32 x 32 x 1 or 32 x 48 x 1
plain::ConvWeights<float> first_layer_weights(const Model& model, int codes) {
    const Tensor& first = model.weights.at("renderer.mlp.0.weight");
    const int outputs = int(first.shape[0]), inputs = int(first.shape[1]);
    const int depth = model.config.latent, side = model.config.unfold, taps = side * side;
    plain::ConvWeights<float> weights{
        outputs, codes * depth, {}, model.weights.at("renderer.mlp.0.bias").values, side};
    for (int o = 0; o < outputs; ++o)
        for (int code = 0; code < codes; ++code)
            for (int d = 0; d < depth; ++d)
                for (int tap = 0; tap < taps; ++tap)
                    weights.weight.push_back(
                        first.values[std::size_t(o * inputs + (code * taps + tap) * depth + d)]);
    return weights;
}

/// Asks for so many numbers, to be in the core's own cache soon.
void fetch(const float* from, std::ptrdiff_t numbers) {
    constexpr std::ptrdiff_t kLine = 64 / sizeof(float);
    for (std::ptrdiff_t i = 0; i < numbers; i += kLine) __builtin_prefetch(from + i, 0, 2);
}

}  // namespace

FirstLayerCache::FirstLayerCache(const Model& model, int height, int width,
                                 const EngineOptions& options, const Backend& backend)
    : options_(options),
      height_(height),
      width_(width),
      depth_(model.config.latent),
      outputs_(model.config.mlp[0]),
      reach_(model.config.unfold / 2),
      tiles_(latent_tiles(height, width)),
      tile_columns_(int(std::ranges::count(tiles_, 0, &Tile::y0))),
      numbers_(backend) {
    const auto extents = extents_of(tiles_, 0, height, width);
    past_ = {first_layer_weights(model, 2), 1, false, backend, extents,
             std::vector<int>(2, depth_)};
    whole_ = {first_layer_weights(model, 3), 1, false, backend, extents,
              std::vector<int>(3, depth_)};
    for (PaddedMap& map : codes_) map = {height, width, numbers_.units(depth_), reach_};
    // Read again for each row (a pitch of 0): a tile's width and its rim.
    zeros_ = {1, kLatentSide, numbers_.units(depth_)};
    for (LatentHistory& history : histories_) history.changed.reserve(tiles_.size());
    for (WindowSums& sums : kept_) sums.values = {height, width, numbers_.units(outputs_)};
    // All count as changed until push() says otherwise.
    for (auto& flags : changed_) flags.assign(tiles_.size(), 1);
    newest_change_.assign(tiles_.size(), 0);
    active_.reserve(tiles_.size());
    scratch_.assign(kWorkers, FloatBuffer(std::max({past_.scratch_size(kLatentSide, kLatentSide),
                                                    whole_.scratch_size(kLatentSide, kLatentSide),
                                                    // Two rows of codes, for is_still().
                                                    std::size_t(2 * kLatentSide * depth_)})));
}

void FirstLayerCache::reset() noexcept {
    for (WindowSums& sums : kept_) sums.k = 0;
    newest_ = 0;
}

const PaddedMap* FirstLayerCache::code(std::int64_t k) const noexcept {
    return k >= 1 ? &codes_[LatentWindow::slot(k)] : nullptr;
}

/// Slot k % 5 holds z_{k-5}: only tiles that changed since are written.
void FirstLayerCache::push(std::int64_t k, const LatentCodes& latent) noexcept {
    newest_ = k;
    const std::size_t slot = LatentWindow::slot(k);
    const StaleTiles stale{histories_[slot], latent.history};
    for_each_tile(options_.parallel_for, int(tiles_.size()), [&](int worker, int n) {
        if (stale(std::size_t(n)))
            hold_tile(k, tiles_[std::size_t(n)], latent, scratch_[std::size_t(worker)].data());
    });
    histories_[slot] = latent.history;
    note_changes(k, latent.history);
}

/// Whether layers can read the codes where they lie.
bool FirstLayerCache::is_as_held(const LatentCodes& latent) const noexcept {
    return reach_ == 0 && options_.still_codes == 0 &&
           latent.is_bf16 == (numbers_.bf16() != nullptr);
}

void FirstLayerCache::take(std::int64_t k, LatentCodes& latent) noexcept {
    if (!is_as_held(latent)) {
        push(k, latent);
        return;
    }
    newest_ = k;
    const std::size_t slot = LatentWindow::slot(k);
    codes_[slot].exchange(latent.values);
    std::swap(histories_[slot], latent.history);
    note_changes(k, histories_[slot]);
}

void FirstLayerCache::hold_tile(std::int64_t k, const Tile& tile, const LatentCodes& latent,
                                float* rows) noexcept {
    PaddedMap& mine = codes_[LatentWindow::slot(k)];
    const PaddedMap* before = options_.skip_quiet && k > 1 ? code(k - 1) : nullptr;
    const bool is_held =
        before != nullptr && options_.still_codes > 0 && is_still(*before, tile, latent, rows);
    const auto width = std::size_t(tile.width());
    const std::size_t bytes = width * std::size_t(mine.channels()) * sizeof(float);
    const bool is_as_read = latent.is_bf16 == (numbers_.bf16() != nullptr);
    for (int y = tile.y0; y < tile.y1; ++y) {
        const float* given = latent.values.pixel(y, tile.x0).data();
        float* to = mine.at(y, tile.x0);
        if (is_held)
            std::memcpy(to, before->at(y, tile.x0), bytes);
        else if (is_as_read)
            std::memcpy(to, given, bytes);
        else if (latent.is_bf16)
            pixels_from_bf16(given, width, depth_, to);
        else
            numbers_.from_float(given, width, depth_, to);
    }
}

bool FirstLayerCache::is_still(const PaddedMap& before, const Tile& tile, const LatentCodes& latent,
                               float* rows) const noexcept {
    const auto width = std::size_t(tile.width()), count = width * std::size_t(depth_);
    float* held = rows;
    float* decoded = rows + count;
    for (int y = tile.y0; y < tile.y1; ++y) {
        numbers_.to_float(before.at(y, tile.x0), width, depth_, held);
        const float* given = latent.values.pixel(y, tile.x0).data();
        if (latent.is_bf16) pixels_from_bf16(given, width, depth_, decoded);
        if (!numbers_.kernels().are_near(latent.is_bf16 ? decoded : given, held,
                                         float(options_.still_codes), count))
            return false;
    }
    return true;
}

/// Compares z_k with z_{k-1}, where the encoder's own account does not already say they are alike.
void FirstLayerCache::note_changes(std::int64_t k, const LatentHistory& history) noexcept {
    const PaddedMap& mine = *code(k);
    const PaddedMap* before = code(k - 1);
    std::vector<std::uint8_t>& changed = changed_[std::size_t(k % kChangesKept)];
    const StaleTiles since{histories_[LatentWindow::slot(k - 1)], history};
    for_each_tile(options_.parallel_for, int(tiles_.size()), [&](int, int n) {
        // A sample at the tile's edge may read codes beyond it.
        const Tile near = tiles_[std::size_t(n)].grown(reach_, height_, width_);
        const auto bytes = std::size_t(near.width()) * std::size_t(mine.channels()) * sizeof(float);
        bool same = before != nullptr;
        const bool may_differ = same && around(n, since);
        for (int y = near.y0; may_differ && same && y < near.y1; ++y)
            same = std::memcmp(mine.at(y, near.x0), before->at(y, near.x0), bytes) == 0;
        changed[std::size_t(n)] = std::uint8_t(!same);
        if (!same) newest_change_[std::size_t(n)] = k;
    });
}

/// Whether a tile, or one beside it that its samples read, too, may have changed.
bool FirstLayerCache::around(int tile, const StaleTiles& since) const noexcept {
    if (reach_ == 0) return since(std::size_t(tile));
    const int rows = int(tiles_.size()) / tile_columns_, columns = tile_columns_;
    const int row = tile / columns, column = tile % columns;
    for (int r = std::max(0, row - 1); r <= std::min(row + 1, rows - 1); ++r)
        for (int c = std::max(0, column - 1); c <= std::min(column + 1, columns - 1); ++c)
            if (since(std::size_t(r * columns + c))) return true;
    return false;
}

/// Whether a tile of `from` already holds what event window k would give: every code it reads is
/// the one read then.
bool FirstLayerCache::unchanged(const WindowSums& from, std::int64_t k, bool whole,
                                std::size_t tile) const noexcept {
    if (!options_.skip_quiet || from.k < 1 || from.whole != whole || k < from.k) return false;
    return still(tile, from.k - 1, whole ? k + 1 : k);
}

bool FirstLayerCache::still(std::size_t tile, std::int64_t from, std::int64_t to) const noexcept {
    // z_0, before the first, reads as zeros, and z_1 counts as another.
    if (from < 0) return false;
    if (newest_change_[tile] <= from) return true;
    if (from <= newest_ - kChangesKept) return false;
    for (std::int64_t j = from + 1; j <= to; ++j)
        if (changed_[std::size_t(j % kChangesKept)][tile] != 0) return false;
    return true;
}

const FirstLayerCache::WindowSums* FirstLayerCache::find(std::int64_t k,
                                                         bool whole) const noexcept {
    for (const WindowSums& there : kept_)
        if (there.k == k && there.whole == whole) return &there;
    return nullptr;
}

std::array<const FirstLayerCache::WindowSums*, 2> FirstLayerCache::pair(std::int64_t k, bool whole,
                                                                        bool next_whole) noexcept {
    // The later one, if there already, must not be overwritten by the earlier.
    const WindowSums& first = bring(k, whole, find(k + 1, next_whole));
    return {&first, &bring(k + 1, next_whole, &first)};
}

/// Brings one of the two kept maps to event window k; never the one to `keep`.
const FirstLayerCache::WindowSums& FirstLayerCache::bring(std::int64_t k, bool whole,
                                                          const WindowSums* keep) noexcept {
    if (const WindowSums* there = find(k, whole)) return *there;
    // The one that shares most with what is wanted: of the same kind, and newest.
    const auto worth = [&](const WindowSums& there) {
        // Sums of a later event window than wanted tell nothing: unchanged() looks forward only.
        if (&there == keep) return std::int64_t{-2};
        return there.whole == whole && there.k <= k ? there.k : std::int64_t{-1};
    };
    WindowSums& to = worth(kept_[1]) > worth(kept_[0]) ? kept_[1] : kept_[0];
    active_.clear();
    for (std::size_t i = 0; i < tiles_.size(); ++i)
        if (!unchanged(to, k, whole, i)) active_.push_back(int(i));
    to.k = k;
    to.whole = whole;
    for_each_tile(options_.parallel_for, int(active_.size()), [&](int worker, int n) {
        compute_tile(to, tiles_[std::size_t(active_[std::size_t(n)])],
                     scratch_[std::size_t(worker)].data());
    });
    return to;
}

/// The convolution over the codes of a tile and its rim, each read where it lies.
void FirstLayerCache::compute_tile(WindowSums& to, const Tile& tile, float* scratch) noexcept {
    ConvArea call;
    for (std::size_t c = 0; c < (to.whole ? 3 : 2); ++c) {
        // The maps' own borders of zeros are what lies outside.
        if (const PaddedMap* z = code(to.k - 1 + std::int64_t(c)))
            call.in[c] = {z->at(tile.y0 - reach_, tile.x0 - reach_), z->pitch()};
        else
            call.in[c] = {zeros_.at(0, -1), 0};
    }
    call.out = to.values.pixel(tile.y0, tile.x0).data();
    call.out_pitch = std::ptrdiff_t(width_) * to.values.channels();
    call.to_bf16 = true;
    call.height = tile.height();
    call.width = tile.width();
    for (int y = 0; y < tile.height(); ++y) {
        for (const ConvSource& source : call.in)
            if (source.in != nullptr)
                fetch(static_cast<const float*>(source.in) + y * source.pitch,
                      tile.width() * numbers_.units(depth_));
        fetch(static_cast<const float*>(call.out) + y * call.out_pitch,
              tile.width() * to.values.channels());
    }
    (to.whole ? whole_ : past_).run(call, scratch);
}

}  // namespace eventide
