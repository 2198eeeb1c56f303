// A batch cut where images came among its events.
#pragma once

#include "src/core/event.h"

#include <cstddef>
#include <iterator>
#include <utility>
#include <vector>

namespace eventide {

/// So that whoever takes events and images in the order of the stream need not know that they came
/// at once, and what it makes of them is the same however the stream was split into batches:
///
///     for (BatchPieces pieces{batch}; pieces.next(piece);) ...
///
/// The images of a piece came before its events. Inertial samples and triggers are in the piece
/// with the events of their time, or in the last.
class BatchPieces {
public:
    BatchPieces() = default;
    explicit BatchPieces(Batch& batch) { put(batch); }

    /// Takes what `batch` holds, and leaves it empty. After the last piece.
    void put(Batch& batch) {
        std::swap(whole_, batch);
        batch.clear();
        image_ = events_ = imu_ = triggers_ = 0;
    }

    /// The next piece, in place of what `piece` held; false where there is none.
    bool next(Batch& piece) {
        piece.clear();
        if (whole_.empty()) return false;
        const std::size_t images = images_until_here();
        const bool is_last = images == whole_.images.size();
        if (is_last && events_ == 0) {
            std::swap(piece, whole_);
            piece.image_places.clear();
            return true;
        }
        take(whole_.images, image_, images, piece.images);
        const std::size_t end = is_last ? whole_.events.size() : whole_.place_of_image(images);
        take(whole_.events, events_, end, piece.events);
        const SensorTime until = is_last ? SensorTime::max() : piece.events.back().t;
        take(whole_.imu, imu_, end_of(whole_.imu, imu_, until), piece.imu);
        take(whole_.triggers, triggers_, end_of(whole_.triggers, triggers_, until), piece.triggers);
        if (is_last) whole_.clear();
        return true;
    }

private:
    /// How many of the images came before the next event.
    std::size_t images_until_here() const {
        std::size_t i = image_;
        while (i < whole_.images.size() && whole_.place_of_image(i) <= events_) ++i;
        return i;
    }
    template <typename T>
    static std::size_t end_of(const std::vector<T>& items, std::size_t from, SensorTime until) {
        while (from < items.size() && items[from].t <= until) ++from;
        return from;
    }
    template <typename T>
    static void take(std::vector<T>& items, std::size_t& from, std::size_t end,
                     std::vector<T>& into) {
        const auto at = items.begin();
        into.assign(std::make_move_iterator(at + std::ptrdiff_t(from)),
                    std::make_move_iterator(at + std::ptrdiff_t(end)));
        from = end;
    }

    Batch whole_;
    std::size_t image_ = 0, events_ = 0, imu_ = 0, triggers_ = 0;  // the next of each
};

}  // namespace eventide
