// The implicit decoder in blocks of pixels: layer 1 is kept per latent map (first_layer_cache.h),
// the layers behind it run while their numbers are in cache, and tiles whose inputs are those of a
// frame rendered before are copied from it (kept_frames.h).
#pragma once

#include "src/model/render/first_layer_cache.h"
#include "src/model/render/frame_layout.h"
#include "src/model/render/kept_frames.h"
#include "src/model/render/window_end.h"

#include <array>
#include <vector>

namespace eventide {

class FastRenderer final : public RendererCore {
public:
    FastRenderer(const Model& model, int sensor_width, int sensor_height,
                 const EngineOptions& options, const Backend& backend);

    std::string description() const override;
    void make_room(const FrameGeometry& geometry) override { lay_out(geometry); }
    void push(std::int64_t k, const LatentCodes& latent) noexcept override;
    void take(std::int64_t k, LatentCodes& latent) noexcept override;
    void reset() noexcept override;
    void render(const CodeChoice& codes, const FrameGeometry& geometry, SigmaRule rule,
                Array2<float>& intensity, Array2<float>* sigma) noexcept override;
    std::uint64_t pixels_rendered() const override { return pixels_rendered_; }

private:
    /// Pixels that go through the layers together: two maps of 56 x 64 numbers, 28 KiB,
    /// lie in a first-level cache; a multiple of the kernels' 14 and near one of their 6.
    static constexpr int kBlock = 56;
    /// A stretch of a row to be rendered: that of the tiles first <= c < last.
    struct Span {
        int row, first, last;
        bool is_still;  ///< shown at the window's end, whatever the frame's time (still_pixels.h)
        bool has_end;   ///< the window's end it begins with is there (window_end.h)
    };
    /// What the two maps of a frame are written to.
    struct Target {
        float* intensity;
        float* sigma;  ///< may be null
    };
    /// Everything about a frame but its pixels.
    /// sums[0] is of event window k + t.index, sums[1] of the one after it.
    struct Job {
        const FrameGeometry& geometry;
        SigmaRule rule;
        AxisSamples t, still_t;  ///< of its time, and of the window's end
        bool keeps_end;          ///< what windows show at their ends is kept
        std::array<const FirstLayerCache::WindowSums*, 2> sums;  ///< of the samples with a weight

        const AxisSamples& time(bool is_still) const { return is_still ? still_t : t; }
    };
    /// One member of the local ensemble for a whole row: a sample row, and what its offset adds.
    struct Member {
        const float* sums;     // the sample row, as layers read it
        std::ptrdiff_t ahead;  // units to the sums of the next row; 0: none
        const float* base;     // [H_1], the time and row part of layer 1's offset term
        float weight;          // of time and row
        std::size_t side;      // left or right
    };

    /// A size of frames: how they lie among the samples, and what was rendered of it. Two are held,
    /// so that nothing is rendered anew because frames of another size came between
    /// (FusedRenderer).
    struct Size {
        FrameGeometry geometry;
        FrameLayout layout;
        KeptFrames kept;
        WindowEnd end;
    };

    Job job_of(const CodeChoice& codes, const FrameGeometry& geometry, SigmaRule rule) noexcept;
    const FrameLayout& layout() const { return sizes_[size_].layout; }
    void lay_out(const FrameGeometry& geometry);
    std::array<const FirstLayerCache::WindowSums*, 2> bring_sums(const CodeChoice& codes,
                                                                 const AxisSamples& t) noexcept;
    FrameKind kind_of(const CodeChoice& codes, const Job& job, bool has_sigma) const noexcept;
    /// Fills spans_ with what of the kept frame is out of date, and stamps it.
    void find_outdated(const CodeChoice& codes, const Job& job, KeptFrame& kept) noexcept;
    bool is_still(int row, int column, std::int64_t from, std::int64_t to) const noexcept;
    /// Whether the end of an event window that a tile's pixels begin with is there; from now on it
    /// is.
    bool note_end(std::size_t tile, std::int64_t k) noexcept;
    /// `fraction` of the window that the tile shows.
    bool is_up_to_date(const KeptFrame& kept, int row, int column, const CodeChoice& codes,
                       double fraction) const noexcept;
    /// Spans are shared among workers; no two write the same pixels.
    void render_spans(const Job& job, const Target& target) noexcept;
    void render_span(const Job& job, const Span& span, const Target& target,
                     std::size_t worker) noexcept;
    /// Three numbers of each pixel: of a row of the frame, or without gaps of the pixels of a span
    /// that have a sample on one side.
    struct Rows {
        float *mu, *log_sigma, *square;  // sigma^2 + mu^2; null where not needed
    };
    enum class RowsOf : std::uint8_t { frame, member, end };
    Rows rows(std::size_t worker, RowsOf which) noexcept;
    void clear(const Rows& rows, const Span& span) const noexcept;
    /// The frame's rows become what an event window shows at its end, times the weight of that
    /// sample in time.
    void begin_with_end(const Job& job, const Span& span, std::size_t sample,
                        std::size_t worker) noexcept;
    /// Adds what the members of a sample in time give, with its weight or another.
    void add_sample(const Job& job, const Span& span, std::size_t sample, double weight,
                    const Rows& to, std::size_t worker) noexcept;
    void put(const Job& job, const Span& span, const Rows& blended,
             const Target& target) const noexcept;
    /// Adds a member's part to every pixel of the span; `outputs` has room for it alone.
    void evaluate(const Member& member, const Span& span, const Rows& to, const Rows& outputs,
                  float* scratch) const noexcept;
    void run_blocks(const OffsetRows& all, const Rows& out, float* scratch) const noexcept;
    void add(const Member& member, std::size_t begin, int pixels, const Rows& outputs,
             const Rows& to) const noexcept;
    /// The hidden layers behind the first; `room` holds 2 kBlock widest_ numbers. Returns where the
    /// result is, float32.
    const float* run_layers(const float* activations, int pixels, float* room) const noexcept;

    ModelConfig config_;
    EngineOptions options_;
    Backend backend_;
    Numbers numbers_;
    int first_ = 0, widest_ = 0;  // outputs of layer 1, of the widest layer
    FirstLayerCache first_layer_;
    std::vector<PackedWeights> layers_;           // hidden layers behind the first
    std::array<std::vector<float>, 3> slope_;     // layer 1's columns for t, x, y
    std::vector<float> last_weight_, last_bias_;  // [2][H], [2]

    std::array<Size, 2> sizes_;  // the two asked for last
    std::size_t size_ = 0;       // the one at hand
    std::vector<Span> spans_;
    std::uint64_t pixels_rendered_ = 0;
    bool needs_squares_ = false;
    std::vector<FloatBuffer> scratch_, row_sums_;  // per worker
};

}  // namespace eventide
