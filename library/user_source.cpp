#include "library/user_source.h"

#include "library/far_time.h"
#include "library/pushed_images.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>

namespace eventide {
namespace {

static_assert(std::is_trivially_copyable_v<Event>);

/// Of an image in a packet; its pixels follow, row by row.
struct ImageHead {
    SensorTime t{}, exposure_begin{}, exposure_end{};
    int x0 = 0, y0 = 0, channels = 1, width = 0, height = 0;
    ColourFilter filter = ColourFilter::none;
    std::uint64_t place = 0;  // Batch::image_places
};

/// Of a packet. Images follow, then events.
struct Head {
    std::uint64_t images = 0, imu = 0, triggers = 0, events = 0;
    bool has_clock = false;
    SensorTime clock{};
};

template <typename T>
void append(const T* values, std::size_t count, std::vector<std::byte>& out) {
    const auto* begin = reinterpret_cast<const std::byte*>(values);
    out.insert(out.end(), begin, begin + count * sizeof(T));
}

template <typename T>
T taken_from(std::span<const std::byte>& bytes) {
    T value;
    std::memcpy(&value, bytes.data(), sizeof value);
    bytes = bytes.subspan(sizeof value);
    return value;
}

void append_image(const ReferenceImage& image, std::uint64_t place, bool whole,
                  std::vector<std::byte>& out) {
    const ImageHead head{.t = image.t,
                         .exposure_begin = image.exposure_begin,
                         .exposure_end = image.exposure_end,
                         .x0 = image.x0,
                         .y0 = image.y0,
                         .channels = image.channels,
                         .width = whole ? image.pixels.width() : 0,
                         .height = whole ? image.pixels.height() : 0,
                         .filter = image.filter,
                         .place = place};
    append(&head, 1, out);
    if (whole) append(image.pixels.values().data(), image.pixels.values().size(), out);
}

ReferenceImage image_taken_from(std::span<const std::byte>& bytes, std::uint64_t& place) {
    const auto head = taken_from<ImageHead>(bytes);
    place = head.place;
    ReferenceImage image{.t = head.t,
                         .exposure_begin = head.exposure_begin,
                         .exposure_end = head.exposure_end,
                         .x0 = head.x0,
                         .y0 = head.y0,
                         .channels = head.channels,
                         .filter = head.filter,
                         .pixels = {head.height, head.width}};
    const std::span pixels = std::as_writable_bytes(std::span{image.pixels.values()});
    std::ranges::copy(bytes.first(pixels.size()), pixels.begin());
    bytes = bytes.subspan(pixels.size());
    return image;
}

/// Reads whole packets of UserSource, which nobody splits.
class UserParser final : public Parser {
public:
    UserParser(int width, int height) : width_(unsigned(width)), height_(unsigned(height)) {}

    void parse(std::span<const std::byte> bytes, Batch& into) override {
        const Head head = taken_from<Head>(bytes);
        if (head.has_clock) clock_ = head.clock;
        images_.resize(head.images);
        for (Image& image : images_) image.it = image_taken_from(bytes, image.place);
        into.imu.resize(into.imu.size() + head.imu);
        into.triggers.resize(into.triggers.size() + head.triggers);
        auto image = images_.begin();
        for (std::uint64_t i = 0; i < head.events; ++i) {
            for (; image != images_.end() && image->place <= i; ++image) take(*image, into);
            take(taken_from<Event>(bytes), into);
        }
        for (; image != images_.end(); ++image) take(*image, into);
    }
    void finish(Batch&) override {}
    void resync() override {}
    std::optional<SensorTime> clock() const override { return clock_; }
    const Damage& damaged() const override { return damage_; }

private:
    struct Image {
        ReferenceImage it;
        std::uint64_t place;
    };
    static void take(Image& image, Batch& into) {
        if (!is_far(image.it)) into.add_image(std::move(image.it));
    }
    void take(const Event& event, Batch& into) {
        if (event.x >= width_ || event.y >= height_)
            damage_.count(DamageReason::out_of_range);
        else if (is_far(event.t))
            damage_.count(DamageReason::bad_record);
        else
            into.events.push_back(event);
    }

    const unsigned width_, height_;
    std::optional<SensorTime> clock_;
    Damage damage_;
    std::vector<Image> images_;  // of one packet
};

}  // namespace

UserSource::UserSource(EventSource& source, bool with_images)
    : source_(source), with_images_(with_images) {}

/// The end is a packet of its own: a recording's clock may have gone on since the last data.
ReadStatus UserSource::read(RawPacket& into) {
    into.bytes.clear();
    if (ended_ || stopped_.load(std::memory_order_relaxed)) return ReadStatus::end;
    ended_ = !source_.read(batch_);
    if (ended_) batch_.clear();
    for (const ReferenceImage& image : batch_.images) check_image(image);
    into.arrived = std::chrono::steady_clock::now();
    into.gap_before = !ended_ && source_.gap_before();  // at the end: told before
    const std::optional<SensorTime> clock = source_.clock();
    if (clock) refuse_far(*clock, "clock of the source");
    if (is_live() && !ended_ && batch_.empty() && clock == clock_ && !into.gap_before)
        return ReadStatus::timeout;
    clock_ = clock;
    const Head head{.images = batch_.images.size(),
                    .imu = batch_.imu.size(),
                    .triggers = batch_.triggers.size(),
                    .events = batch_.events.size(),
                    .has_clock = clock.has_value(),
                    .clock = clock.value_or(SensorTime{})};
    append(&head, 1, into.bytes);
    for (std::size_t i = 0; i < batch_.images.size(); ++i)
        append_image(batch_.images[i], batch_.place_of_image(i), with_images_, into.bytes);
    append(batch_.events.data(), batch_.events.size(), into.bytes);
    return ReadStatus::data;
}

void UserSource::stop() noexcept {
    stopped_.store(true, std::memory_order_relaxed);
    source_.stop();
}

std::unique_ptr<Parser> UserSource::make_parser() const {
    return std::make_unique<UserParser>(info().width, info().height);
}

}  // namespace eventide
