// Events and images out of arrays, in parts, from any time on.
#pragma once

#include "replay/data_reader.h"
#include "replay/event_table.h"
#include "replay/open_options.h"
#include "replay/table_images.h"

#include <memory>
#include <string>
#include <vector>

namespace eventide {

class TableReader final : public DataReader {
public:
    static constexpr std::size_t kRowsAtATime = 8192;

    /// `images` may be null. Where neither `header` nor `options` say the sensor's size, it is that
    /// of the smallest sensor known that holds the events of kSamples places of the file, and a
    /// remark says so. Throws Error (input) where there is none, and where most of the events at
    /// the beginning would be left out because they come after later ones.
    TableReader(const std::string& path, StreamHeader header, std::unique_ptr<EventTable> events,
                std::unique_ptr<ImageTable> images, const OpenOptions& options);

    const StreamHeader& header() const override { return header_; }
    bool read(Batch& into, Damage& damage) override;
    void seek(SensorTime t) override;
    double progress() const override;
    std::vector<std::string> remarks() const override { return remarks_; }

private:
    static constexpr std::uint64_t kSamples = 64;

    void find_size(const std::string& path);
    void check_order(const std::string& path);
    bool read_rows(std::uint64_t first, Damage& damage);
    void take_rows(Batch& into, Damage& damage) const;
    std::int64_t last_time_us() const;
    std::size_t rows_until(std::int64_t t_us) const;
    bool take_images(std::int64_t until_us, Batch& into, Damage& damage);
    bool fits(std::uint64_t row, std::int64_t t_us) const;

    StreamHeader header_;
    std::unique_ptr<EventTable> events_;
    TableImages images_;
    std::vector<std::string> remarks_;
    EventRows rows_;  // of the last part
    std::uint64_t next_row_ = 0;
    std::uint64_t bad_tables_ = 0;  // to be counted with the next part
};

}  // namespace eventide
