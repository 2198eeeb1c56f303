// Bisection over byte positions: the clock of a fresh parser tells the time at each.
#include "replay/seek.h"

#include <algorithm>
#include <optional>
#include <vector>

namespace eventide {

namespace {

// Closer than this, reading on is as quick as another probe.
constexpr std::uint64_t kCloseEnoughBytes = std::uint64_t(64) << 10;
// Long enough to find a time behind a large frame.
constexpr std::uint64_t kLongestProbeBytes = std::uint64_t(4) << 20;

class Probe {
public:
    Probe(const ByteFile& file, const OpenedStream& stream)
        : file_(file), stream_(stream), bytes_(std::size_t(4) << 10) {}

    /// The first time told by the bytes from `position` on; empty when there is none near.
    std::optional<SensorTime> time_at(std::uint64_t position) {
        const auto parser = stream_.make_parser(stream_.header);
        if (position != stream_.header.data_offset) parser->resync();
        for (std::uint64_t done = 0; done < kLongestProbeBytes; done += bytes_.size()) {
            const std::size_t n = file_.read_at(position + done, bytes_);
            parser->parse({bytes_.data(), n}, batch_);
            const std::optional<SensorTime> first = first_time(*parser);
            batch_.clear();
            if (first) return first;
            if (n < bytes_.size()) break;
        }
        return {};
    }

private:
    /// The clock stands at the end of the bytes; their first event is nearer to the position.
    std::optional<SensorTime> first_time(const Parser& parser) const {
        if (!batch_.events.empty()) return batch_.events.front().t;
        return parser.clock();
    }

    const ByteFile& file_;
    const OpenedStream& stream_;
    std::vector<std::byte> bytes_;
    Batch batch_;
};

}  // namespace

std::uint64_t find_position(const ByteFile& file, const OpenedStream& stream, SensorTime t) {
    const std::uint64_t begin = stream.header.data_offset, step = stream.seek_alignment;
    if (step == 0 || file.size() <= begin + kCloseEnoughBytes) return begin;
    Probe probe(file, stream);
    std::optional<SensorTime> low_time = probe.time_at(begin), high_time;
    if (!low_time || *low_time >= t) return begin;

    // The events before `low` are all before t, those from `high` on all at or after t.
    std::uint64_t low = begin, high = file.size();
    while (high - low > kCloseEnoughBytes) {
        const std::uint64_t middle = begin + ((low + high) / 2 - begin) / step * step;
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

}  // namespace eventide
