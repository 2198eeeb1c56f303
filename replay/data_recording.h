// A DataReader as a recording: its data as plain records, which any parser's user takes.
#pragma once

#include "replay/data_reader.h"
#include "replay/recording.h"

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace eventide {

class DataRecording final : public Recording {
public:
    /// `bytes`: of the file.
    DataRecording(std::unique_ptr<DataReader> reader, std::uint64_t bytes);

    const SensorInfo& info() const override { return info_; }
    ReadStatus read(RawPacket& into) override;
    void stop() noexcept override { stopped_ = true; }
    std::unique_ptr<Parser> make_parser() const override;
    std::vector<std::string> remarks() const override { return reader_->remarks(); }
    void seek(SensorTime t) override;
    std::uint64_t size_bytes() const override { return bytes_; }
    /// Thread: any.
    std::uint64_t position_bytes() const override { return position_; }

private:
    void note_position();

    std::unique_ptr<DataReader> reader_;
    SensorInfo info_;
    std::uint64_t bytes_, packets_ = 0;
    Batch batch_;
    std::atomic<std::uint64_t> position_{0};
    std::atomic<bool> stopped_{false};
};

}  // namespace eventide
