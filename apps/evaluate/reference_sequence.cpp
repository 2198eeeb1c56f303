// Reading a recording into memory, and cutting it.
#include "apps/evaluate/reference_sequence.h"

#include "apps/evaluate/seconds.h"
#include "pipeline/demosaiced.h"
#include "pipeline/stages.h"
#include "replay/formats.h"
#include "replay/left_out.h"
#include "src/binning/push_filtered.h"
#include "src/core/batch_pieces.h"
#include "src/core/error.h"
#include "src/core/grey.h"
#include "src/core/image_clock.h"
#include "src/core/number_text.h"
#include "src/core/sensor_limits.h"

#include <algorithm>
#include <chrono>
#include <system_error>
#include <utility>

namespace eventide {
namespace {

/// What one clock tells; members as ReferenceSequence has them.
struct Part {
    SensorTime first{};
    std::vector<Event> events;
    std::vector<ReferenceImage> images;
};

/// Keeps what lies inside the times asked for, of the part with the most images where the camera's
/// clock began anew.
class Keeper {
public:
    Keeper(std::optional<double> from_s, std::optional<double> to_s)
        : from_s_(from_s), to_s_(to_s) {}

    void take(Batch& batch) {
        image_clock_.see(batch);
        events_ += batch.events.size();
        images_ += batch.images.size();
        if (!begun_ && !batch.events.empty()) begin(batch);
        Batch piece;
        for (BatchPieces pieces{batch}; pieces.next(piece);) take_piece(piece);
    }
    void finish(ReferenceSequence& into) {
        if (part_.images.size() < best_.images.size()) part_ = std::move(best_);
        into.first = part_.first;
        into.events = std::move(part_.events);
        into.images = std::move(part_.images);
    }
    /// By the events that came out: a parser's clock may run ahead of them.
    bool past_end() const {
        // Images may come a while after the events around them.
        return begun_ && to_s_ && last_event_ > to_ + SensorDuration{1'000'000};
    }
    /// Of the recording, inside and outside those times.
    std::uint64_t events() const { return events_; }
    std::uint64_t images() const { return images_; }
    std::uint64_t resets() const { return resets_; }
    const ImageClock& image_clock() const { return image_clock_; }

private:
    void begin(const Batch& batch) {
        SensorTime first = batch.events.front().t;
        if (!part_.images.empty()) first = std::min(first, part_.images.front().t);
        if (!batch.images.empty()) first = std::min(first, batch.images.front().t);
        begin_at(first);
    }
    void begin_at(SensorTime first) {
        begun_ = true;
        part_.first = first;
        if (from_s_) from_ = first + duration_from_seconds(*from_s_);
        if (to_s_) to_ = first + duration_from_seconds(*to_s_);
    }
    /// The images of a piece came before its events.
    void take_piece(Batch& piece) {
        for (ReferenceImage& image : piece.images) part_.images.push_back(std::move(image));
        for (const Event& event : piece.events) {
            if (event.t < last_event_) begin_anew(event.t);
            last_event_ = event.t;
            if (event.t >= from_ && event.t <= to_) part_.events.push_back(event);
        }
        // Images before the first event wait for it to say which are wanted.
        if (begun_) drop_images();
    }
    void begin_anew(SensorTime t) {
        ++resets_;
        Part ended = std::exchange(part_, {});
        // Images that are told by the new clock may have come before its first event.
        while (!ended.images.empty() && is_nearer(ended.images.back().t, t)) {
            part_.images.insert(part_.images.begin(), std::move(ended.images.back()));
            ended.images.pop_back();
        }
        if (best_.images.size() < ended.images.size()) best_ = std::move(ended);
        begin_at(part_.images.empty() ? t : std::min(t, part_.images.front().t));
    }
    /// To the first event of the new clock than to the last one of the old.
    bool is_nearer(SensorTime image, SensorTime t) const {
        return std::chrono::abs(image - t) < std::chrono::abs(image - last_event_);
    }
    void drop_images() {
        std::erase_if(part_.images, [this](const ReferenceImage& image) {
            return image.t < from_ || image.t > to_;
        });
    }

    std::optional<double> from_s_, to_s_;
    Part part_, best_;  // of the clock at hand; of those before, the one with the most images
    ImageClock image_clock_;
    SensorTime from_ = SensorTime::min(), to_ = SensorTime::max();
    SensorTime last_event_ = SensorTime::min();
    std::uint64_t events_ = 0, images_ = 0, resets_ = 0;
    bool begun_ = false;
};

void read_recording(const std::filesystem::path& path, const OpenOptions& input,
                    std::optional<ColourFilter> bayer, Keeper& keeper, ReferenceSequence& into) {
    const auto recording = open_recording(path.string(), input);
    const auto parser = recording->make_parser();
    into.width = recording->info().width;
    into.height = recording->info().height;
    for (const std::string& remark : recording->remarks())
        into.warnings.push_back(path.string() + ": " + remark);
    RawPacket packet;
    Batch batch;
    while (!keeper.past_end() && recording->read(packet) != ReadStatus::end) {
        parser->parse(packet.bytes, batch);
        keeper.take(batch);
    }
    // Where no more was wanted, half a record in hand is no damage of the recording's.
    if (!keeper.past_end()) parser->finish(batch);
    keeper.take(batch);
    keeper.finish(into);
    const ColourFilter filter = bayer.value_or(recording->info().colour_filter);
    for (ReferenceImage& image : into.images)
        image = demosaiced(std::move(image), told_filter(filter, bayer.has_value()));
    into.damaged = parser->damaged();
    if (std::string text =
            left_out_text(path.string(), recording->info().format, keeper.events(), into.damaged);
        !text.empty())
        into.warnings.push_back(std::move(text));
}

}  // namespace

std::string sequence_name(const std::filesystem::path& path) {
    std::error_code none;
    auto plain = std::filesystem::absolute(path, none).lexically_normal();
    if (!plain.has_filename()) plain = plain.parent_path();
    return (std::filesystem::is_directory(plain, none) ? plain.filename() : plain.stem()).string();
}

ReferenceSequence read_reference_sequence(const std::filesystem::path& path,
                                          std::optional<double> from_s, std::optional<double> to_s,
                                          const OpenOptions& input,
                                          std::optional<ColourFilter> bayer) {
    ReferenceSequence sequence;
    sequence.name = sequence_name(path);
    Keeper keeper{from_s, to_s};
    read_recording(path, input, bayer, keeper, sequence);
    mend_times(sequence.images);
    if (keeper.resets() > 0)
        sequence.warnings.push_back(path.string() + ": its clock began anew " +
                                    counted(keeper.resets(), "time") + "; the part with " +
                                    counted(sequence.images.size(), "image") + " of its " +
                                    std::to_string(keeper.images()) + " is used");

    const auto refuse = [&](const std::string& what) {
        throw Error(ErrorKind::input, path.string() + ": " + what);
    };
    if (const SensorDuration apart = keeper.image_clock().apart(); apart > SensorDuration{0})
        refuse(image_clock_text(apart));
    if (keeper.events() == 0) refuse("expected events, found none");
    if (keeper.images() == 0) refuse("expected reference images to compare with, found none");
    if (sequence.width <= 0 || sequence.height <= 0)
        refuse("does not say the sensor's size; --input-size does");
    check_sensor_size(path.string(), sequence.width, sequence.height);
    return sequence;
}

void mend_times(std::vector<ReferenceImage>& images) {
    for (std::size_t i = 1; i + 1 < images.size(); ++i)
        if (images[i].t > images[i + 1].t)
            images[i].t = images[i - 1].t + (images[i + 1].t - images[i - 1].t) / 2;
    std::ranges::stable_sort(images, {}, &ReferenceImage::t);
}

void check_sensor_size(const std::string& file, std::int64_t width, std::int64_t height) {
    if (width >= 1 && height >= 1 && width <= kLargestSensorSide && height <= kLargestSensorSide)
        return;
    throw Error(ErrorKind::input, file + ": expected a sensor of 1 to " +
                                      std::to_string(kLargestSensorSide) + " px each way, found " +
                                      std::to_string(width) + "x" + std::to_string(height));
}

Array2<float> intensity_of(const ReferenceImage& image) {
    Array2<float> out(image.pixels.height(), image.pixels.width() / image.channels);
    for (int y = 0; y < out.height(); ++y)
        for (int x = 0; x < out.width(); ++x) out(y, x) = grey_at(image, y, x);
    return out;
}

void for_each_reference_window(const ReferenceSequence& sequence,
                               const std::function<void(const EventWindow&)>& use) {
    const std::vector<ReferenceImage>& images = sequence.images;
    const auto after = [&](SensorTime t) {
        return std::ranges::upper_bound(sequence.events, t, {}, &Event::t);
    };
    // The empty frame before the first image is as wide as the one after it.
    const SensorDuration first_width =
        images.size() > 1 ? images[1].t - images[0].t : SensorDuration{50'000};
    for (std::size_t i = 0; i < images.size(); ++i) {
        const SensorTime end = images[i].t;
        const SensorTime begin =
            i == 0 ? end - std::max(first_width, SensorDuration{1}) : images[i - 1].t;
        if (end <= begin) continue;  // an image stored twice
        EventWindow event_window{.window = {begin, end}, .events = {}};
        if (i > 0) event_window.events = {after(begin), after(end)};
        use(event_window);
    }
}

void for_each_cut_window(const ReferenceSequence& sequence, const std::string& window,
                         EventFilter* filter, const std::function<void(const EventWindow&)>& use) {
    Slicer slicer{parse_window(window), sequence.width, sequence.height};
    for (const ReferenceImage& image : sequence.images) slicer.push_reference(image.t);
    constexpr std::size_t kAtATime = 1 << 16;
    const std::span<const Event> events{sequence.events};
    std::vector<Event> left;
    EventWindow event_window;
    for (std::size_t at = 0; at < events.size(); at += kAtATime) {
        const auto some = events.subspan(at, std::min(kAtATime, events.size() - at));
        if (filter == nullptr) {
            slicer.push(some);
        } else {
            left.assign(some.begin(), some.end());
            push_filtered(slicer, left, *filter);
        }
        while (slicer.next(event_window)) use(event_window);
    }
    if (filter != nullptr) flush_filtered(slicer, *filter, left);
    slicer.advance(sequence.images.back().t);
    slicer.finish();
    while (slicer.next(event_window)) use(event_window);
}

}  // namespace eventide
