// Streams of events made on the way.
#include "apps/cli/stress/made_stream.h"

#include <algorithm>
#include <cstring>
#include <span>
#include <utility>

namespace eventide::stress {
namespace {

/// Packets of whole events.
class EventParser final : public Parser {
public:
    void parse(std::span<const std::byte> bytes, Batch& into) override {
        const std::size_t before = into.events.size();
        into.events.resize(before + bytes.size() / sizeof(Event));
        std::memcpy(into.events.data() + before, bytes.data(), bytes.size());
        if (into.events.size() > before) clock_ = into.events.back().t;
    }
    void finish(Batch&) override {}
    void resync() override {}
    std::optional<SensorTime> clock() const override { return clock_; }
    const Damage& damaged() const override { return damage_; }

private:
    std::optional<SensorTime> clock_;
    Damage damage_;
};

SensorInfo info_of(int width, int height) {
    SensorInfo info;
    info.name = "made";
    info.width = width;
    info.height = height;
    return info;
}

}  // namespace

MadeStream::MadeStream(int width, int height, MakeEvents make)
    : info_{info_of(width, height)}, make_{std::move(make)} {}

ReadStatus MadeStream::read(RawPacket& into) {
    events_.clear();
    if (!stopped_) make_(events_);
    if (events_.empty()) return ReadStatus::end;
    const auto bytes = std::as_bytes(std::span{events_});
    into.bytes.assign(bytes.begin(), bytes.end());
    into.arrived = std::chrono::steady_clock::now();
    return ReadStatus::data;
}

std::unique_ptr<Parser> MadeStream::make_parser() const {
    return std::make_unique<EventParser>();
}

EncodedStream::EncodedStream(int width, int height, std::vector<std::byte> bytes,
                             MakeParser make_parser)
    : info_{info_of(width, height)},
      bytes_{std::move(bytes)},
      make_parser_{std::move(make_parser)} {}

ReadStatus EncodedStream::read(RawPacket& into) {
    if (stopped_ || at_ == bytes_.size()) return ReadStatus::end;
    const std::size_t n = std::min(kPacket, bytes_.size() - at_);
    const auto from = bytes_.begin() + std::ptrdiff_t(at_);
    into.bytes.assign(from, from + std::ptrdiff_t(n));
    into.arrived = std::chrono::steady_clock::now();
    at_ += n;
    return ReadStatus::data;
}

MakeEvents all_of(std::vector<Event> events) {
    auto kept = std::make_shared<std::vector<Event>>(std::move(events));
    return [kept](std::vector<Event>& into) {
        into.insert(into.end(), kept->begin(), kept->end());
        kept->clear();
    };
}

std::vector<Event> moving_edge(int width, int height, SensorTime begin, SensorTime end,
                               std::uint64_t seed) {
    Random random{seed};
    std::vector<Event> events;
    const int per_ms = std::max(1, height * 4 / 100);
    const std::int64_t ms = (end - begin).count() / 1000;
    for (std::int64_t k = 0; k < ms; ++k) {
        const auto turn = int(k / 5 % (2 * width));
        const int edge = turn < width ? turn : 2 * width - 1 - turn;
        for (int n = 0; n < per_ms; ++n) {
            const bool elsewhere = random.chance(.1);
            const int x = elsewhere ? random.integer(0, width - 1)
                                    : std::clamp(edge + random.integer(-2, 2), 0, width - 1);
            const auto us = 1000 * k + 1 + 999 * n / per_ms;
            events.push_back({begin + SensorDuration{us}, std::uint16_t(x),
                              std::uint16_t(random.integer(0, height - 1)),
                              random.chance(.5) ? Polarity::on : Polarity::off});
        }
    }
    return events;
}

}  // namespace eventide::stress
