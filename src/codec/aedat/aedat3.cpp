// AEDAT 3: bytes -> packets and the whole records in them.
#include "src/codec/aedat/aedat3.h"

#include <algorithm>
#include <cstring>
#include <string_view>

namespace eventide {

namespace {

bool begins_file(std::span<const std::byte> bytes) {
    constexpr std::string_view kFirstLine = "#!AER-DAT3.";
    return std::memcmp(bytes.data(), kFirstLine.data(), kFirstLine.size()) == 0;
}

}  // namespace

Aedat3Parser::Aedat3Parser(const Aedat3Header& header, int width, int height)
    : source_(header.source),
      others_(header.others),
      content_(header.lower_left, header.stream.height > 0 ? header.stream.height : height, width,
               height) {}

/// Slides over the bytes until 28 of them make a header.
std::span<const std::byte> Aedat3Parser::search_header(std::span<const std::byte> bytes) {
    while (true) {
        if (unit_.size() == Aedat3Packet::kHeaderBytes) {
            const Aedat3Packet packet = read_aedat3_packet(unit_.data());
            const bool of_ours = !source_ || packet.source == *source_;
            if (is_plausible(packet) && packet.number > 0 && of_ours) {
                begin_packet(packet);
                return bytes;
            }
            unit_.erase(unit_.begin());
        }
        const std::size_t n = std::min(Aedat3Packet::kHeaderBytes - unit_.size(), bytes.size());
        if (n == 0) return bytes;
        unit_.insert(unit_.end(), bytes.begin(), bytes.begin() + std::ptrdiff_t(n));
        bytes = bytes.subspan(n);
    }
}

std::span<const std::byte> Aedat3Parser::read_header(std::span<const std::byte> bytes) {
    const std::size_t n = std::min(Aedat3Packet::kHeaderBytes - unit_.size(), bytes.size());
    unit_.insert(unit_.end(), bytes.begin(), bytes.begin() + std::ptrdiff_t(n));
    bytes = bytes.subspan(n);
    if (unit_.size() < Aedat3Packet::kHeaderBytes) return bytes;
    const Aedat3Packet packet = read_aedat3_packet(unit_.data());
    if (is_plausible(packet)) {
        begin_packet(packet);
        return bytes;
    }
    state_ = State::searching;
    if (begins_file(unit_))
        content_.join();
    else
        content_.damage().count(DamageReason::bad_length);
    return bytes;
}

void Aedat3Parser::begin_packet(const Aedat3Packet& packet) {
    unit_.clear();
    packet_ = packet;
    const bool of_other_source = source_ && packet.source != *source_;
    const bool is_named =
        std::ranges::find(others_, int(packet.source), &Aedat3Source::number) != others_.end();
    if (of_other_source && !is_named) content_.damage().count(DamageReason::unknown_word);
    if (of_other_source || packet.type > std::int16_t(Aedat3Type::imu9)) {
        left_ = std::uint64_t(packet.record_bytes) * packet.number;
        state_ = State::passing_over;
    } else {
        if (!source_) source_ = packet.source;
        content_.begin(packet);
        left_ = packet.number;
        state_ = State::records;
    }
    if (left_ == 0) state_ = State::header;
}

std::span<const std::byte> Aedat3Parser::pass_over(std::span<const std::byte> bytes) {
    const auto n = std::size_t(std::min<std::uint64_t>(left_, bytes.size()));
    left_ -= n;
    if (left_ == 0) state_ = State::header;
    return bytes.subspan(n);
}

std::span<const std::byte> Aedat3Parser::read_records(std::span<const std::byte> bytes,
                                                      Batch& into) {
    const std::size_t record_bytes = packet_.record_bytes;
    if (unit_.empty()) {
        const auto whole = std::size_t(std::min<std::uint64_t>(left_, bytes.size() / record_bytes));
        const auto records = bytes.first(whole * record_bytes);
        content_.take(packet_, records, into);
        left_ -= whole;
        bytes = bytes.subspan(records.size());
    }
    if (left_ > 0 && !bytes.empty()) {
        const std::size_t n = std::min(record_bytes - unit_.size(), bytes.size());
        unit_.insert(unit_.end(), bytes.begin(), bytes.begin() + std::ptrdiff_t(n));
        bytes = bytes.subspan(n);
        if (unit_.size() == record_bytes) {
            content_.take(packet_, unit_, into);
            unit_.clear();
            --left_;
        }
    }
    if (left_ == 0) state_ = State::header;
    return bytes;
}

void Aedat3Parser::parse(std::span<const std::byte> bytes, Batch& into) {
    while (!bytes.empty()) switch (state_) {
            case State::header:
                bytes = read_header(bytes);
                break;
            case State::searching:
                bytes = search_header(bytes);
                break;
            case State::records:
                bytes = read_records(bytes, into);
                break;
            case State::passing_over:
                bytes = pass_over(bytes);
                break;
        }
}

void Aedat3Parser::finish(Batch& into) {
    const bool inside = state_ == State::records || state_ == State::passing_over;
    if (inside || (state_ == State::header && !unit_.empty()))
        content_.damage().count(DamageReason::truncated);
    content_.finish(into);
    unit_.clear();
    state_ = State::header;
}

void Aedat3Parser::resync() {
    unit_.clear();
    state_ = State::searching;
    content_.resync();
}

std::optional<SensorTime> Aedat3Parser::clock() const {
    const auto newest = content_.newest_us();
    return newest ? std::optional(from_us(*newest)) : std::nullopt;
}

}  // namespace eventide
