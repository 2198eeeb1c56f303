// A small source, model and sink.
#include "tests/support/toy_stages.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace eventide::test {
namespace {

constexpr std::size_t kRecordBytes = 14;

template <typename T>
void put(std::vector<std::byte>& bytes, T value) {
    const auto* p = reinterpret_cast<const std::byte*>(&value);
    bytes.insert(bytes.end(), p, p + sizeof value);
}

template <typename T>
T field(const std::byte* p) {
    T value;
    std::memcpy(&value, p, sizeof value);
    return value;
}

}  // namespace

void append_record(std::vector<std::byte>& bytes, ToyKind kind, std::int64_t t_us, int x, int y,
                   bool on) {
    put(bytes, std::uint8_t(kind));
    put(bytes, t_us);
    put(bytes, std::uint16_t(x));
    put(bytes, std::uint16_t(y));
    put(bytes, std::uint8_t(on));
}

std::vector<std::byte> bytes_of(const std::vector<Event>& events) {
    std::vector<std::byte> bytes;
    for (const Event& e : events)
        append_record(bytes, ToyKind::event, to_us(e.t), e.x, e.y, e.polarity == Polarity::on);
    return bytes;
}

std::vector<Event> toy_events(std::size_t n, unsigned seed, std::int64_t begin_us) {
    std::mt19937 rng{seed};
    std::vector<Event> events(n);
    std::int64_t t = begin_us;
    for (Event& e : events) {
        const auto dice = rng() % 1000;
        t += dice < 300 ? 0 : dice < 998 ? rng() % 30 : rng() % 5000;
        e = {from_us(t), std::uint16_t(rng() % kToyWidth), std::uint16_t(rng() % kToyHeight),
             rng() % 2 == 0 ? Polarity::on : Polarity::off};
    }
    return events;
}

void ToyParser::parse(std::span<const std::byte> bytes, Batch& into) {
    while (!bytes.empty()) {
        if (held_.empty() && bytes.size() >= kRecordBytes) {
            take_record(bytes.data(), into);
            bytes = bytes.subspan(kRecordBytes);
            continue;
        }
        const auto n = std::min(kRecordBytes - held_.size(), bytes.size());
        held_.insert(held_.end(), bytes.begin(), bytes.begin() + std::ptrdiff_t(n));
        bytes = bytes.subspan(n);
        if (held_.size() < kRecordBytes) return;
        take_record(held_.data(), into);
        held_.clear();
    }
}

void ToyParser::take_record(const std::byte* record, Batch& into) {
    const auto kind = ToyKind(field<std::uint8_t>(record));
    const auto t_us = field<std::int64_t>(record + 1);
    if (fails_at_us_ && t_us >= *fails_at_us_) throw std::runtime_error("parser");
    const SensorTime t = from_us(t_us);
    const bool reset = kind == ToyKind::event && t < newest_event_;
    if (kind == ToyKind::event) newest_event_ = t;
    clock_ = clock_ && !reset ? std::max(*clock_, t) : t;
    if (kind == ToyKind::event)
        into.events.push_back(
            {from_us(t_us), field<std::uint16_t>(record + 9), field<std::uint16_t>(record + 11),
             field<std::uint8_t>(record + 13) != 0 ? Polarity::on : Polarity::off});
    if (kind == ToyKind::image) {
        ReferenceImage image;
        image.t = from_us(t_us);
        into.add_image(image);
    }
}

void ToyParser::finish(Batch&) {
    if (!held_.empty()) damaged_.count(DamageReason::truncated);
    held_.clear();
}

ToySource::ToySource(std::vector<std::vector<std::byte>> packets, bool live, int height, int width)
    : packets_(std::move(packets)), live_(live) {
    info_.name = "toy";
    info_.format = "toy";
    info_.width = width;
    info_.height = height;
}

std::vector<std::vector<std::byte>> ToySource::packets_of(std::span<const std::byte> bytes,
                                                          std::size_t n, std::mt19937* rng) {
    std::vector<std::vector<std::byte>> packets;
    while (!bytes.empty()) {
        const auto size = std::min(rng ? 1 + (*rng)() % (2 * n) : n, bytes.size());
        packets.emplace_back(bytes.begin(), bytes.begin() + std::ptrdiff_t(size));
        bytes = bytes.subspan(size);
    }
    return packets;
}

ReadStatus ToySource::read(RawPacket& into) {
    if (before_read) before_read(next_);
    if (stopped_) return ReadStatus::end;
    if (next_ >= packets_.size() && !(endless && !packets_.empty())) return ReadStatus::end;
    const auto& packet = packets_[std::min(next_++, packets_.size() - 1)];
    into.bytes.assign(packet.begin(), packet.end());
    into.arrived = std::chrono::steady_clock::now();
    return packet.empty() ? ReadStatus::timeout : ReadStatus::data;
}

std::unique_ptr<Parser> ToySource::make_parser() const {
    return std::make_unique<ToyParser>(parser_fails_at_us);
}

void ToySink::write(const Frame& frame) {
    if (before_write) before_write(count);
    ++count;
    if (!keeps) return;
    const auto copy = [](const Array2<float>& a) {
        return std::vector<float>(a.values().begin(), a.values().end());
    };
    seen.push_back({to_us(frame.t), to_us(frame.window.begin), to_us(frame.window.end), frame.index,
                    frame.events, frame.gap_before, copy(frame.intensity), copy(frame.sigma),
                    copy(frame.event_preview)});
}

void ToySink::close() {
    ++closed;
    if (before_close) before_close();
}

LatentMap ToyEncoder::make_output() const {
    LatentMap latent;
    latent.values = Array3<float>(state_.height(), state_.width(), 2);
    return latent;
}

void ToyEncoder::step(const VoxelGrid& grid, LatentMap& latent) noexcept {
    if (before_encode) before_encode();
    for (int y = 0; y < state_.height(); ++y)
        for (int x = 0; x < state_.width(); ++x) {
            float sum = 0;
            for (const float value : grid.values.pixel(y, x)) sum = 0.7F * sum + value;
            state_(y, x, 0) = 0.9F * state_(y, x, 0) + 0.1F * sum;
            state_(y, x, 1) += float(grid.events);
        }
    std::copy(state_.values().begin(), state_.values().end(), latent.values.values().begin());
}

void ToyEncoder::reset() noexcept {
    ++resets;
    std::fill(state_.values().begin(), state_.values().end(), 0.0F);
}

Frame ToyRenderer::make_output() const {
    Frame frame;
    frame.intensity = Array2<float>(height_, width_);
    frame.sigma = Array2<float>(height_, width_);
    return frame;
}

void ToyRenderer::take(LatentMap& latent) noexcept {
    auto kept = kept_[count_++ % kept_.size()].values();
    std::copy(latent.values.values().begin(), latent.values.values().end(), kept.begin());
}

void ToyRenderer::render(SensorTime t, const Window& window, Frame& frame) noexcept {
    const float place = float((t - window.begin).count()) / float(window.width().count());
    const auto latent = [this](std::size_t age) {
        return kept_[(count_ - 1 - age) % kept_.size()].values();
    };
    for (std::size_t pixel = 0; pixel < frame.intensity.values().size(); ++pixel) {
        float mu = place;
        for (std::size_t age = 0; age < std::min(count_, kept_.size()); ++age)
            mu = 0.8F * mu + latent(age)[2 * pixel];
        frame.intensity.values()[pixel] = mu;
        frame.sigma.values()[pixel] = place + latent(0)[2 * pixel + 1];
    }
}

void ToyRenderer::reset() noexcept {
    count_ = 0;
    finished = false;
}

}  // namespace eventide::test
