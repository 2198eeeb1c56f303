// The events that a run reconstructs from, written down behind all filters.
#pragma once

#include "pipeline/stages.h"
#include "replay/convert.h"
#include "replay/written_data.h"
#include "src/codec/batch_parts.h"

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace eventide::app {

/// Where --events-out and convert's TO go: "udp://HOST:PORT", "FORMAT:PATH" (also "FORMAT:-"),
/// "folder/", a file by its extension, or "-" as text. Throws Error (usage) for what is none of
/// these and for a file that exists.
std::unique_ptr<ConvertTarget> open_event_target(const std::string& to,
                                                 const OutputOptions& options,
                                                 const StreamHeader& header);

/// The file or folder in it; empty for what is none.
std::string file_of_event_target(const std::string& to);

/// "3 datagrams that nobody received"
std::string lost_datagrams(std::uint64_t lost);

/// The last of the filters. Bin thread; it holds up the pipeline for as long as writing takes.
class EventsOut final : public EventFilter, public DataObserver {
public:
    /// The first or last time that is written; empty: all, or not known yet. In the present clock,
    /// which may be reset; and how long a stream is to last is known with its first event.
    using Limit = std::function<std::optional<SensorTime>()>;
    /// `filter` may be null; it is borrowed. Events outside of [from, to] are not written.
    /// `colours` as of WrittenData.
    EventsOut(EventFilter* filter, std::unique_ptr<ConvertTarget> target, Limit from, Limit to,
              ColourFilter colours = ColourFilter::none)
        : filter_(filter),
          target_(std::move(target)),
          data_(target_->holds(), colours),
          from_(std::move(from)),
          to_(std::move(to)) {}

    /// Images and the rest, of which what the target holds is written with the events they came
    /// with, or at once where there are none.
    void see(const Batch& batch) override;
    void process(std::vector<Event>& events) override;
    void release(SensorTime now, std::vector<Event>& events) override;
    void flush(std::vector<Event>& events) override;
    SensorTime known_until(SensorTime now) const override {
        return filter_ != nullptr ? filter_->known_until(now) : now;
    }
    std::size_t held() const override { return filter_ != nullptr ? filter_->held() : 0; }
    FlickerFound flicker() const override {
        return filter_ != nullptr ? filter_->flicker() : FlickerFound{};
    }
    void finish();
    std::uint64_t lost() const { return target_->lost(); }
    const WrittenData& data() const { return data_; }  ///< after the run

private:
    void keep(const BatchPart& part, Batch& in) const;
    void begin_clocks(std::span<const Event> events);
    void write(std::span<const Event> events);

    EventFilter* filter_;
    std::unique_ptr<ConvertTarget> target_;
    WrittenData data_;
    Limit from_, to_;
    Batch batch_;
    std::deque<Batch> next_clocks_;          // seen, without the events with which they begin
    Batch later_;                            // than events that the filter holds back
    SensorTime newest_ = SensorTime::min();  // event
    bool has_events_ = false;                // written
};

}  // namespace eventide::app
