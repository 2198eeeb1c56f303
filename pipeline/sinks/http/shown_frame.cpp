#include "pipeline/sinks/http/shown_frame.h"

#include "src/core/error.h"
#include "src/core/words.h"
#include "src/io/image_codecs.h"

#include <algorithm>

namespace eventide {

namespace {

constexpr int kJpegQuality = 85;
constexpr int kQuickly = 1;  // of zlib's levels

void encode(const char* extension, const cv::Mat& image, const std::vector<int>& options,
            ShownFrame::Bytes& bytes) {
    try {
        if (encode_image(extension, image, bytes, options)) return;
    } catch (const cv::Exception& error) {
        throw Error(ErrorKind::failed,
                    std::string{"a frame cannot be made a "} + extension + ": " + error.what());
    }
    throw Error(ErrorKind::failed, std::string{"a frame cannot be made a "} + extension);
}

cv::Mat drawn(const Frame& frame, Show show, float sigma_white) {
    cv::Mat image;
    switch (show) {
        case Show::sigma:
            draw_sigma(frame, sigma_white, image);
            break;
        case Show::side:
            draw(frame, Uncertainty::side, sigma_white, image);
            break;
        case Show::overlay:
            draw(frame, Uncertainty::overlay, sigma_white, image);
            break;
        case Show::intensity:
            draw(frame, Uncertainty::none, sigma_white, image);
            break;
    }
    return image;
}

/// Numbers in the order of their bytes that JavaScript's DataView is told: little end first.
class Head {
public:
    explicit Head(ShownFrame::Bytes& into) : into_(into) {}
    void number(std::uint64_t value, int bytes) {
        for (int i = 0; i < bytes; ++i) into_.push_back(static_cast<unsigned char>(value >> 8 * i));
    }

private:
    ShownFrame::Bytes& into_;
};

}  // namespace

std::optional<Show> parse_show(std::string_view word) {
    static const std::vector<Word<Show>> kWords{{Show::intensity, "intensity"},
                                                {Show::sigma, "sigma"},
                                                {Show::side, "side"},
                                                {Show::overlay, "overlay"}};
    return find_word(word, kWords);
}

ShownFrame::ShownFrame(Frame frame, float sigma_white, std::chrono::nanoseconds latency)
    : frame_{std::move(frame)}, sigma_white_{sigma_white}, latency_{latency} {}

const ShownFrame::Bytes& ShownFrame::made(Made& made,
                                          const std::function<void(Bytes&)>& make) const {
    std::call_once(made.once, [&] { make(made.bytes); });
    return made.bytes;
}

const ShownFrame::Bytes& ShownFrame::jpeg(Show show) const {
    return made(jpegs_[std::size_t(show)], [&](Bytes& bytes) {
        encode(".jpg", drawn(frame_, show, sigma_white_), {cv::IMWRITE_JPEG_QUALITY, kJpegQuality},
               bytes);
    });
}

const ShownFrame::Bytes& ShownFrame::png(Show show) const {
    return made(pngs_[std::size_t(show)], [&](Bytes& bytes) {
        encode(".png", drawn(frame_, show, sigma_white_), {}, bytes);
    });
}

const ShownFrame::Bytes& ShownFrame::tiff() const {
    return made(tiff_, [&](Bytes& bytes) {
        if (frame_.sigma.empty()) return;
        constexpr int kUncompressed = 1;
        const cv::Mat sigma(frame_.sigma.height(), frame_.sigma.width(), CV_32FC1,
                            const_cast<float*>(frame_.sigma.values().data()));
        encode(".tiff", sigma, {cv::IMWRITE_TIFF_COMPRESSION, kUncompressed}, bytes);
    });
}

const ShownFrame::Bytes& ShownFrame::events() const {
    return made(events_, [&](Bytes& bytes) {
        const Array2<float>& sums = frame_.event_preview;
        if (sums.empty()) return;
        cv::Mat image(sums.height(), sums.width(), CV_8UC1);
        for (int y = 0; y < image.rows; ++y)
            std::ranges::transform(sums.row(y), image.ptr<std::uint8_t>(y), [](float sum) {
                return std::uint8_t(sum > 0 ? 255 : sum < 0 ? 0 : 128);
            });
        encode(".png", image, {cv::IMWRITE_PNG_COMPRESSION, kQuickly}, bytes);
    });
}

const ShownFrame::Bytes& ShownFrame::message() const {
    return made(message_, [&](Bytes& bytes) {
        static const Bytes kNothing;
        const Bytes& intensity = jpeg(Show::intensity);
        const Bytes& sigma = frame_.sigma.empty() ? kNothing : jpeg(Show::sigma);
        const Bytes& preview = events();
        Head head{bytes};
        head.number(0x45545645, 4);  // "EVTE"
        head.number(64, 4);          // bytes of this head
        head.number(frame_.index, 8);
        head.number(std::uint64_t(to_us(frame_.t)), 8);
        head.number(frame_.events, 8);
        head.number(std::uint64_t(std::max<std::int64_t>(latency_.count(), 0)) / 1000, 8);
        head.number(std::uint64_t((frame_.window.end - frame_.window.begin).count()), 8);
        head.number(intensity.size(), 4);
        head.number(sigma.size(), 4);
        head.number(preview.size(), 4);
        head.number(frame_.gap_before ? 1 : 0, 4);
        for (const Bytes* part : {&intensity, &sigma, &preview})
            bytes.insert(bytes.end(), part->begin(), part->end());
    });
}

}  // namespace eventide
