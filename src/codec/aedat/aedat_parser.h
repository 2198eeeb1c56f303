// What AEDAT 1 and 2 have in common: records of an address and a time, big-endian, and files that
// were joined.
#pragma once

#include "src/codec/aedat/aedat_records.h"
#include "src/codec/aedat/aedat_timeline.h"
#include "src/codec/parser.h"
#include "src/core/byte_order.h"

#include <cstdint>
#include <optional>
#include <span>
#include <utility>

namespace eventide {

/// `Content` knows what addresses mean: take(record, t_us, into, damage), end_of_file(into, damage)
/// for what is incomplete, and resync().
template <typename Address, typename Content>
class AedatParser : public Parser {
public:
    void parse(std::span<const std::byte> bytes, Batch& into) final {
        records_.feed(
            bytes, [&](const std::byte* record) { push(record, into); },
            [&] { end_of_file(into); });
    }
    void finish(Batch& into) final {
        records_.finish([&](const std::byte* record) { push(record, into); },
                        [&] { end_of_file(into); });
    }
    void resync() final {
        records_.drop();
        timeline_.resync();
        content_.resync();
    }
    std::optional<SensorTime> clock() const final {
        const auto newest = timeline_.newest();
        return newest ? std::optional(from_us(*newest)) : std::nullopt;
    }
    const Damage& damaged() const final { return damage_; }

protected:
    explicit AedatParser(Content content) : content_(std::move(content)) {}

private:
    static constexpr std::size_t kBytes = sizeof(Address) + sizeof(std::int32_t);

    auto taker(Batch& into) {
        return [this, &into](const AedatRecord& record, std::int64_t t_us) {
            content_.take(record, t_us, into, damage_);
        };
    }
    void push(const std::byte* record, Batch& into) {
        const auto reset = [&](std::int64_t t_us) {
            into.triggers.push_back({from_us(t_us), Trigger::Kind::timestamp_reset, 0});
        };
        timeline_.push({load_big<Address>(record),
                        std::int32_t(load_big<std::uint32_t>(record + sizeof(Address)))},
                       damage_, taker(into), reset);
    }
    void end_of_file(Batch& into) {
        timeline_.join(taker(into));
        if (records_.is_half_read()) damage_.count(DamageReason::truncated);
        content_.end_of_file(into, damage_);
    }

    AedatRecords<kBytes> records_;
    AedatTimeline timeline_;
    Content content_;
    Damage damage_;
};

}  // namespace eventide
