// Images of the camera between the thread that finds them and the one that shows frames.
#pragma once

#include "src/core/event.h"

#include <cstdint>
#include <deque>
#include <limits>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace eventide {

/// Images on their way from the bin thread to the render thread, by their number in the stream. All
/// arrive: of a recording, whose bin thread waits for the render thread's buffers, there are never
/// more than belong to the event windows between the two. A live source does not wait.
class ImagesOnTheWay {
public:
    static constexpr std::size_t kKeptLive = 64, kAll = std::numeric_limits<std::size_t>::max();

    /// At most so many are kept, and the oldest are dropped. Call it before the first put().
    void keep_at_most(std::size_t images) { most_ = images; }
    std::size_t most() const { return most_; }

    void put(std::vector<ReferenceImage> images) {
        const std::lock_guard lock{mutex_};
        for (ReferenceImage& image : images) images_.push_back(std::move(image));
        given_ += images.size();
        for (; images_.size() > most_; ++dropped_) images_.pop_front();
    }

    /// The next one of those before number `end`.
    std::optional<ReferenceImage> take(std::uint64_t end) {
        const std::lock_guard lock{mutex_};
        if (images_.empty() || given_ - images_.size() >= end) return std::nullopt;
        std::optional<ReferenceImage> image{std::move(images_.front())};
        images_.pop_front();
        return image;
    }

    std::uint64_t dropped() const {
        const std::lock_guard lock{mutex_};
        return dropped_;
    }

private:
    std::size_t most_ = kAll;
    mutable std::mutex mutex_;
    std::deque<ReferenceImage> images_;
    std::uint64_t given_ = 0, dropped_ = 0;
};

}  // namespace eventide
