// A recording that lies in memory: reading it costs nothing, so that what is measured is the rest.
#pragma once

#include "replay/recording.h"

#include <atomic>
#include <functional>
#include <memory>
#include <vector>

namespace eventide::app {

struct RecordedPackets {
    SensorInfo info;
    std::vector<std::vector<std::byte>> packets;
    std::function<std::unique_ptr<Parser>()> make_parser;
    std::uint64_t bytes = 0;
};

class MemoryRecording : public Recording {
public:
    explicit MemoryRecording(std::shared_ptr<const RecordedPackets> data)
        : data_{std::move(data)} {}

    const SensorInfo& info() const override { return data_->info; }
    ReadStatus read(RawPacket& into) override {
        if (stopped_ || next_ == data_->packets.size()) return ReadStatus::end;
        into.bytes = data_->packets[next_++];
        into.arrived = std::chrono::steady_clock::now();
        position_ += into.bytes.size();
        return ReadStatus::data;
    }
    void stop() noexcept override { stopped_ = true; }
    std::unique_ptr<Parser> make_parser() const override { return data_->make_parser(); }
    void seek(SensorTime) override { next_ = 0; }
    std::uint64_t size_bytes() const override { return data_->bytes; }
    std::uint64_t position_bytes() const override { return position_; }

private:
    std::shared_ptr<const RecordedPackets> data_;
    std::atomic<bool> stopped_{false};  // any thread
    std::size_t next_ = 0;
    std::uint64_t position_ = 0;
};

}  // namespace eventide::app
