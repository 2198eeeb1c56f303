// Filters one behind the other, as a user named them, between a source and whoever parses it.
#pragma once

#include "pipeline/counters.h"
#include "pipeline/filters/data_filter.h"
#include "pipeline/source.h"
#include "src/core/batch_pieces.h"

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace eventide {

class FilterChain {
public:
    /// In this order, each as make_data_filter() takes it. Throws Error (usage) as that does.
    FilterChain(const std::vector<std::string>& texts, const SensorPixels& size);
    /// One more behind the last, before the first events. Throws likewise, and is then as it was.
    void add(const std::string& text);

    bool empty() const { return links_.empty(); }
    SensorPixels size() const { return size_; }  ///< behind the last
    /// The sensor's colour filter as DataFilter::pattern() says, behind the last.
    ColourFilter pattern(ColourFilter before) const;
    /// The sensor as it looks behind the last.
    SensorInfo behind(SensorInfo sensor) const;
    void process(Batch& batch);
    /// Tells when the recording's first event was, where that is not the first that is processed.
    void count_from(SensorTime first) {
        first_ = first;
        for (Link& link : links_) link.filter->count_from(first);
    }
    /// Whether that is known, or was seen.
    bool knows_first() const { return first_.has_value(); }
    /// What comes next are data of another place: what filters remember of those before means
    /// nothing there. Throws Error (usage) as the constructor, and is then as it was.
    void restart();

    /// Events that the filters left out, together. Thread: any.
    std::uint64_t left_out() const;
    /// "region:10,20,100x50 1234, flip:x 0": how many events each left out. Thread: any.
    std::string report() const;

private:
    struct Link {
        std::string text;
        std::unique_ptr<DataFilter> filter;
        Counter left_out;
    };
    void process_piece(Batch& batch);

    const SensorPixels size_before_;
    SensorPixels size_;  // behind the last
    Batch piece_;
    BatchPieces pieces_;
    std::deque<Link> links_;           // counters stay where they are
    std::optional<SensorTime> first_;  // event of the recording
};

/// A source as it looks behind filters. Its parsers share the chain: one is used at a time.
class FilteredSource final : public Source {
public:
    /// Both are borrowed.
    FilteredSource(Source& source, FilterChain& chain);
    const SensorInfo& info() const override { return info_; }
    bool is_live() const noexcept override { return source_.is_live(); }
    std::size_t packet_bytes() const override { return source_.packet_bytes(); }
    ReadStatus read(RawPacket& into) override { return source_.read(into); }
    void stop() noexcept override { source_.stop(); }
    std::unique_ptr<Parser> make_parser() const override;

private:
    Source& source_;
    FilterChain& chain_;
    SensorInfo info_;
};

}  // namespace eventide
