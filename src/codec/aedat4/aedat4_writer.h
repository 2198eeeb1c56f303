// data -> AEDAT4, readable by the vendor's software.
#pragma once

#include "src/codec/aedat4/aedat4_compression.h"
#include "src/codec/aedat4/aedat4_table.h"
#include "src/codec/stream.h"

#include <cstdint>
#include <vector>

namespace eventide {

class FlatWriter;

/// Writes four streams (events 0, frames 1, IMU 2, triggers 3), in packets of at most
/// kPacketEvents, and the table at the end, whose place the one patch puts into the header.
///
/// Grey, BGR and BGRA images; 8 bits per channel where no value needs more, else 16, which the
/// vendor's readers do not know. An image of known exposure is read back with t in its middle.
/// Throws Error (usage) for coordinates above 32767, times before -2^61 us or after 2^61 us, images
/// of other channel counts, and triggers the format has no number for: rising and falling edges
/// have sources 0 (input) and Trigger::kGenerator, all other kinds source 0, Kind::other sources 10
/// to 127.
class Aedat4Writer final : public StreamWriter {
public:
    static constexpr std::size_t kPacketEvents = 16384;
    static constexpr std::size_t kPacketSamples = 1024;

    explicit Aedat4Writer(Aedat4Compression compression = usual_aedat4_compression())
        : compression_(compression) {}

    void begin(const StreamHeader& header, std::vector<std::byte>& out) override;
    void write(const Batch& batch, std::vector<std::byte>& out) override;
    void finish(std::vector<std::byte>& out) override;
    std::vector<Patch> patches() const override { return patches_; }

private:
    void write_events(std::span<const Event> events, std::vector<std::byte>& out);
    void write_image(const ReferenceImage& image, std::vector<std::byte>& out);
    void write_imu(std::span<const ImuSample> samples, std::vector<std::byte>& out);
    void write_triggers(std::span<const Trigger> triggers, std::vector<std::byte>& out);
    void packet(Aedat4TableEntry entry, FlatWriter& content, std::vector<std::byte>& out);

    Aedat4Compression compression_;
    Aedat4Table table_;
    std::uint64_t written_ = 0;         ///< bytes before the next packet
    std::uint64_t position_place_ = 0;  ///< in the header
    std::vector<Patch> patches_;
};

}  // namespace eventide
