/// @file
/// Recordings: files of events, in any format that eventide reads.
#pragma once

#include <eventide/event.h>
#include <eventide/pipeline.h>
#include <eventide/version.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace eventide {

/// What a recording's bytes do not say, or say wrongly.
struct ReaderOptions {
    std::string format;  ///< "aedat4", "evt3", "text", ...; empty: found from the content
    int width = 0;       ///< px, of the sensor; 0: what the recording says. Both or neither
    int height = 0;      ///< px, likewise
    /// Called every 20 ms while standard input or a pipe has no bytes: what it throws comes out of
    /// the constructor or of read(), which may then be called again. Also called now and then by
    /// span(). May be empty.
    std::function<void()> while_waiting{};
    /// Told each of remarks(), behind the path, by the constructor, out of which comes what it
    /// throws. May be empty.
    std::function<void(const std::string&)> warn{};
    /// In a recording with events of several cameras, whose are read, as remarks() name them: the
    /// topic of a bag; "davis/right" of an HDF5 file; the number of a source of AEDAT 3, or of a
    /// stream of AEDAT 4. Empty: the first.
    std::string stream{};
};

/// AEDAT 1 to 4, Prophesee RAW (EVT2, EVT2.1, EVT3) and DAT, HDF5 (of DSEC, MVSEC, M3ED, Prophesee,
/// event_utils and e2calib), ROS 1 and 2 bags, Event Stream, NumPy arrays (npy, npz), text, and
/// folders of the Event Camera Dataset, found by their content. Read in bounded memory, a batch at
/// a time. Thread: one at a time.
class EVENTIDE_API EventReader final : public EventSource {
public:
    /// "-" is standard input. Throws Error: input naming the path, what was expected and what was
    /// found; usage for the name of a camera, for options that make no sense and for
    /// a stream that is not there.
    explicit EventReader(const std::string& path, const ReaderOptions& options = {});
    ~EventReader() override;
    EventReader(EventReader&&) noexcept;             ///< leaves the other empty
    EventReader& operator=(EventReader&&) noexcept;  ///< leaves the other empty

    const SensorInfo& info() const noexcept override;  ///< as it looks behind the filters
    int width() const noexcept;                        ///< px; 0 where the recording does not say
    int height() const noexcept;                       ///< px; 0 where the recording does not say

    /// Puts a filter behind the reader, and behind the filters that are there: "flicker",
    /// "region:10,20,100x50", ..., as `eventide run --filter` takes them (docs/usage.md). Some
    /// change width and height ("transpose", "subsample:2x2"). Throws Error (usage) for one that is
    /// none, where the recording does not say its size, and once something was read.
    void add_filter(const std::string& filter);

    /// What had to be guessed when it was opened: sentences for people.
    std::vector<std::string> remarks() const;

    /// The next data: `batch` is emptied first and may stay without events where others came.
    /// Events are inside the sensor and in order of time; one earlier than the one before it means
    /// that the sensor's clock was reset. Images came before the batch's events. False at the end.
    /// Throws Error (input) where the file cannot be read; damaged bytes are left out and counted.
    bool read(Batch& batch) override;

    /// Goes on from `t`, forwards or back: the next events and images are those from then on. A
    /// Reconstructor that saw others wants reset() first. Does nothing on standard input and on
    /// pipes. Throws Error (input).
    void seek(SensorTime t);

    /// The newest time the recording told so far, which may lie after its newest event; at the end
    /// it is the end of the recording. Empty before the first.
    std::optional<SensorTime> clock() const override;

    /// Thread: any. Standard input and pipes end here: no read() waits any more, what was read is
    /// still given, then false. A file never waits, and may be read on.
    void stop() noexcept override;

    /// Places where bytes made no sense, so far.
    std::uint64_t damaged() const noexcept;

    /// Times of the first and the last event; empty where there is none. Reads the whole recording,
    /// through an opening of its own. Throws Error (usage) for standard input and pipes.
    std::optional<Window> span() const;

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace eventide
