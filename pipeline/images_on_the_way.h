// Images of the camera between the thread that finds them and the one that shows frames.
#pragma once

#include "src/core/event.h"

#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace eventide {

/// Images on their way from the bin thread to the render thread, by their number in the stream. Of
/// more than kKept the oldest are dropped.
class ImagesOnTheWay {
public:
    static constexpr std::size_t kKept = 64;

    void put(const std::vector<ReferenceImage>& images) {
        const std::lock_guard lock{mutex_};
        for (const ReferenceImage& image : images) images_.push_back(image);
        given_ += images.size();
        while (images_.size() > kKept) images_.pop_front();
    }

    /// The next one of those before number `end`.
    std::optional<ReferenceImage> take(std::uint64_t end) {
        const std::lock_guard lock{mutex_};
        if (images_.empty() || given_ - images_.size() >= end) return std::nullopt;
        std::optional<ReferenceImage> image{std::move(images_.front())};
        images_.pop_front();
        return image;
    }

private:
    std::mutex mutex_;
    std::deque<ReferenceImage> images_;
    std::uint64_t given_ = 0;
};

}  // namespace eventide
