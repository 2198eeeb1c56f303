// Bisection over byte positions, and skimming where a time in the middle says nothing by itself.
#include "replay/stream/seek.h"

#include "replay/stream/byte_file.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

namespace eventide {

namespace {

// Closer than this, reading on is as quick as another probe.
constexpr std::uint64_t kCloseEnoughBytes = std::uint64_t(64) << 10;
// Long enough to find a time behind a large frame.
constexpr std::uint64_t kLongestProbeBytes = std::uint64_t(4) << 20;

class Probe {
public:
    Probe(const ByteFile& file, const StreamHeader& header, const MakeParser& make_parser)
        : file_(file), header_(header), make_parser_(make_parser), bytes_(std::size_t(4) << 10) {}

    /// The newest time told by the first bytes from `position` on that tell one; empty when there
    /// is none near. The newest, since one flipped bit must not send us past what is asked for.
    std::optional<SensorTime> time_at(std::uint64_t position) {
        const auto parser = make_parser_(header_);
        if (position != header_.data_offset) parser->resync();
        for (std::uint64_t done = 0; done < kLongestProbeBytes; done += bytes_.size()) {
            const std::size_t n = file_.read_at(position + done, bytes_);
            parser->parse({bytes_.data(), n}, batch_);
            batch_.clear();
            if (const auto newest = parser->clock()) return newest;
            if (n < bytes_.size()) break;
        }
        return {};
    }

private:
    const ByteFile& file_;
    const StreamHeader& header_;
    const MakeParser& make_parser_;
    std::vector<std::byte> bytes_;
    Batch batch_;
};

std::uint64_t bisect(Probe& probe, std::uint64_t begin, std::uint64_t end, std::uint64_t alignment,
                     SensorTime t) {
    std::optional<SensorTime> low_time = probe.time_at(begin), high_time;
    if (!low_time || *low_time >= t) return begin;

    // The events before `low` are all before t, those from `high` on all at or after t.
    std::uint64_t low = begin, high = end;
    while (high - low > kCloseEnoughBytes) {
        const std::uint64_t middle = begin + ((low + high) / 2 - begin) / alignment * alignment;
        if (middle <= low) break;
        const std::optional<SensorTime> found = probe.time_at(middle);
        if (found && (*found < *low_time || (high_time && *found > *high_time))) return begin;
        if (found && *found < t) {
            low = middle;
            low_time = found;
        } else {
            high = middle;
            if (found) high_time = found;
        }
    }
    return low;
}

/// What came out is not all before t. The clock alone does not say it: where it began anew since,
/// as between files that were joined, it is earlier again.
bool reaches(const Batch& batch, const Parser& parser, SensorTime t) {
    const auto any = [t](const auto& items) {
        return std::ranges::any_of(items, [t](const auto& item) { return item.t >= t; });
    };
    return (parser.clock() && *parser.clock() >= t) || any(batch.events) || any(batch.images) ||
           any(batch.imu) || any(batch.triggers);
}

/// Reads from the beginning, and keeps nothing but the parser as it was before the last chunk.
SeekPoint skim(const ByteFile& file, const StreamHeader& header, std::unique_ptr<Parser> parser,
               const SeekMeans& means, SensorTime t) {
    std::vector<std::byte> bytes(kCloseEnoughBytes);
    Batch batch;
    SeekPoint place{header.data_offset, means.copy(*parser)};
    for (;;) {
        const std::size_t n = file.read_at(place.position, bytes);
        batch.clear();
        parser->parse({bytes.data(), n}, batch);
        if (n < bytes.size() || reaches(batch, *parser, t)) return place;
        place.position += n;
        place.parser = means.copy(*parser);
    }
}

}  // namespace

SeekPoint find_seek_point(const ByteFile& file, const StreamHeader& header,
                          const MakeParser& make_parser, const SeekMeans& means, SensorTime t) {
    const std::uint64_t begin = header.data_offset;
    if (means.look_up)
        if (const auto found = means.look_up(file, t)) return {*found};
    if (file.size() <= begin + kCloseEnoughBytes) return {begin};
    if (means.copy != nullptr) return skim(file, header, make_parser(header), means, t);
    if (means.alignment == 0) return {begin};
    Probe probe(file, header, make_parser);
    const SensorTime earliest = std::max(t, SensorTime::min() + means.slack) - means.slack;
    return {bisect(probe, begin, file.size(), means.alignment, earliest)};
}

}  // namespace eventide
