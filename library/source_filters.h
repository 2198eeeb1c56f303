// The filters that a reader's or camera's user has put behind it.
#pragma once

#include "pipeline/filters/filter_chain.h"

#include <string>

namespace eventide {

class SourceFilters {
public:
    /// For a source with this sensor; no filter at first.
    explicit SourceFilters(const SensorInfo& sensor)
        : sensor_(sensor), info_(sensor), chain_({}, {sensor.width, sensor.height}) {}

    /// The sensor as it looks behind the filters.
    const SensorInfo& info() const { return info_; }

    /// Throws Error (usage): once data were read, without a sensor's size, and as
    /// make_data_filter() does. Nothing has changed then.
    void add(const std::string& text);

    /// What was just read. Images that do not say so become mosaics of the sensor's colour filter.
    void process(Batch& batch);

    /// Whether the next events would be taken for the stream's first ones, wherever they come from.
    bool wants_first() const { return !chain_.empty() && !chain_.knows_first(); }
    void count_from(SensorTime first) {
        has_begun_ = true;
        chain_.count_from(first);
    }
    /// What is read next comes from another place. Throws Error (usage), where nothing has changed.
    void restart() { chain_.restart(); }

private:
    const SensorInfo sensor_;  // before the filters
    SensorInfo info_;
    FilterChain chain_;
    bool has_begun_ = false;  // something was read
};

}  // namespace eventide
