// Data that are no stream of bytes (rows of arrays, messages of a bag) on their way to a parser.
#pragma once

#include "src/codec/event_validator.h"
#include "src/codec/parser.h"
#include "src/codec/told_time.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace eventide {

/// Appends the data as records, each image before the events of its time and later: what lies in
/// `batch` is in order of time. `found`: damage that whoever read them counted.
void append_plain_records(const Batch& batch, const Damage& found, std::vector<std::byte>& out);

/// Reads them back. 16 bytes each, little endian: u8 kind, u8, u16, u16, u16, i64 time in us; of
/// images and IMU samples more follow.
class PlainRecordsParser final : public Parser {
public:
    /// Size in px.
    PlainRecordsParser(int width, int height)
        : validator_(std::uint64_t(width), std::uint64_t(height)) {}

    void parse(std::span<const std::byte> bytes, Batch& into) override;
    void finish(Batch& into) override;
    void resync() override;
    std::optional<SensorTime> clock() const override;
    const Damage& damaged() const override { return damage_; }

private:
    static constexpr std::size_t kHeadBytes = 16;

    std::size_t take_head(std::span<const std::byte> bytes, Batch& into);
    void take_record(const std::byte* head, Batch& into);
    void take_event(const std::byte* head, Batch& into);
    void begin_image(const std::byte* head);
    void end_payload(Batch& into);
    void end_image(Batch& into);
    void end_imu(Batch& into);
    void tell(std::int64_t t_us);

    EventValidator validator_;
    Damage damage_;
    std::array<std::byte, kHeadBytes> head_{};
    std::size_t head_bytes_ = 0;  ///< read of the next one
    std::size_t rest_ = 0;        ///< bytes of payload to come
    std::vector<std::byte> payload_;
    ToldTime told_;
};

}  // namespace eventide
