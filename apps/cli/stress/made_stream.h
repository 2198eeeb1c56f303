// Streams of events made on the way: of any length, without memory for all of it.
#pragma once

#include "pipeline/source.h"
#include "src/simulate/random.h"

#include <atomic>
#include <functional>
#include <memory>
#include <vector>

namespace eventide::stress {

/// Appends the next part of a stream, at least one event; nothing at its end.
using MakeEvents = std::function<void(std::vector<Event>&)>;

/// A recording whose bytes are events as they lie in memory, each packet whole ones. Its parser
/// hands on whatever times they have: one that is earlier than the one before it is what a camera's
/// clock that was reset gives.
class MadeStream final : public Source {
public:
    MadeStream(int width, int height, MakeEvents make);

    const SensorInfo& info() const override { return info_; }
    bool is_live() const noexcept override { return false; }
    ReadStatus read(RawPacket& into) override;
    void stop() noexcept override { stopped_ = true; }
    std::unique_ptr<Parser> make_parser() const override;

private:
    SensorInfo info_;
    MakeEvents make_;
    std::vector<Event> events_;
    std::atomic<bool> stopped_{false};  // any thread
};

/// Bytes of a format, and the parser that a file or camera of that format has.
class EncodedStream final : public Source {
public:
    using MakeParser = std::function<std::unique_ptr<Parser>()>;
    EncodedStream(int width, int height, std::vector<std::byte> bytes, MakeParser make_parser);

    const SensorInfo& info() const override { return info_; }
    bool is_live() const noexcept override { return false; }
    ReadStatus read(RawPacket& into) override;
    void stop() noexcept override { stopped_ = true; }
    std::unique_ptr<Parser> make_parser() const override { return make_parser_(); }

private:
    static constexpr std::size_t kPacket = 8191;  // bytes: odd, so that records are cut
    SensorInfo info_;
    std::vector<std::byte> bytes_;
    std::size_t at_ = 0;
    MakeParser make_parser_;
    std::atomic<bool> stopped_{false};  // any thread
};

/// All events at once.
MakeEvents all_of(std::vector<Event> events);

/// An edge that wanders over the sensor and turns round, and now and then an event elsewhere: 4
/// events each millisecond and 100 px of height, in (begin, end]. The same for the same arguments.
std::vector<Event> moving_edge(int width, int height, SensorTime begin, SensorTime end,
                               std::uint64_t seed = 1);

}  // namespace eventide::stress
