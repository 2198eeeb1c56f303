// Recordings in the manner of the Event Camera Dataset: events.txt beside images.txt and images/.
#pragma once

#include "replay/recording.h"
#include "replay/stream/file_recording.h"

#include <deque>
#include <optional>
#include <string>
#include <vector>

namespace eventide {

/// The folder when `path` is one with an events.txt, or is an events.txt beside an images.txt.
std::optional<std::string> find_ecd_folder(const std::string& path);

struct EcdImages {
    struct Entry {
        SensorTime t{};
        SensorTime exposure_begin{}, exposure_end{};  ///< equal to t where nothing says them
        std::string path;
    };
    std::vector<Entry> entries;        ///< in time order; empty where there is no images.txt
    int width = 0, height = 0;         ///< px, of the first image that can be read; else 0
    std::uint64_t bad_entries = 0;     ///< lines of images.txt that make no sense or lead elsewhere
    std::vector<std::string> remarks;  ///< which lines those are, and which images are not there
};

/// Reads images.txt ("t file", t in seconds, file in the folder), exposure.txt where there is one
/// ("begin end" in seconds, a line for each of images.txt), and one image for the size.
EcdImages read_ecd_images(const std::string& folder);

/// Events with the folder's images as reference images: each comes out once the events have
/// passed its time, the rest at finish(). Images that cannot be read, or are not of the sensor's
/// size (`width` x `height`, px), are left out and count as bad_record.
class EcdParser final : public Parser {
public:
    /// `in_the_middle`: of the recording; images before the first event that comes are left out.
    EcdParser(std::unique_ptr<Parser> events, EcdImages images, int width, int height,
              bool in_the_middle = false);

    void parse(std::span<const std::byte> bytes, Batch& into) override;
    void finish(Batch& into) override;
    void resync() override;
    std::optional<SensorTime> clock() const override { return events_->clock(); }
    const Damage& damaged() const override;

private:
    void emit_until(std::optional<SensorTime> t, std::size_t first, Batch& into);

    std::unique_ptr<Parser> events_;
    EcdImages images_;
    int width_, height_;
    std::size_t next_image_ = 0;
    bool jumped_ = false;  ///< since the last event: the next image is to be found anew
    Damage image_damage_;
    mutable Damage damage_;  ///< the sum, made when asked for
};

class EcdRecording final : public Recording {
public:
    EcdRecording(std::unique_ptr<FileRecording> events, EcdImages images)
        : events_(std::move(events)), images_(std::move(images)) {}

    const SensorInfo& info() const override { return events_->info(); }
    ReadStatus read(RawPacket& into) override { return events_->read(into); }
    void stop() noexcept override { events_->stop(); }
    std::unique_ptr<Parser> make_parser() const override {
        return std::make_unique<EcdParser>(events_->make_parser(), images_, info().width,
                                           info().height, events_->begins_in_the_middle());
    }
    std::unique_ptr<Parser> make_clock() const override { return events_->make_parser(); }
    std::vector<std::string> remarks() const override;
    void seek(SensorTime t) override { events_->seek(t); }
    std::uint64_t size_bytes() const override { return events_->size_bytes(); }
    std::uint64_t position_bytes() const override { return events_->position_bytes(); }

private:
    std::unique_ptr<FileRecording> events_;
    EcdImages images_;
};

}  // namespace eventide
