/// @file
/// Recordings being written.
#pragma once

#include <eventide/event.h>
#include <eventide/version.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

namespace eventide {

/// How a recording is written.
struct WriterOptions {
    std::string format;      ///< "aedat4", "evt3", "text", ...; empty: by the file's extension
    bool overwrite = false;  ///< replace a file that exists
    /// Called every 20 ms while a pipe has no reader or is full: what it throws comes out of the
    /// constructor, of write() or of finish(), and the recording stays incomplete. May be empty.
    std::function<void()> while_waiting{};
};

/// The file appears under its name, whole, with finish(); without it nothing is left behind.
/// Thread: one at a time.
class EVENTIDE_API EventWriter {
public:
    /// Of `sensor` width and height must be set (px); name, serial and colour filter may be, and
    /// are written where the format has a place for them. "-" is standard output. Throws Error:
    /// usage for an unknown format or a file that exists, failed where it cannot be written.
    EventWriter(const std::string& path, const SensorInfo& sensor,
                const WriterOptions& options = {});
    ~EventWriter();
    EventWriter(EventWriter&&) noexcept;             ///< leaves the other empty
    EventWriter& operator=(EventWriter&&) noexcept;  ///< leaves the other empty

    /// Must follow what was written before in time. Throws Error: usage for an event earlier than
    /// the one before it or outside of the sensor, a time more than 2^60 us from zero, what the
    /// format cannot hold and after finish(), failed where the disk is full. Where the order, the
    /// sensor or a time were wrong, nothing has changed; after any other error the recording cannot
    /// be written on or finished.
    void write(std::span<const Event> events);

    /// The same with images, inertial samples and triggers. Kinds that the format has no records
    /// for are left out and counted.
    void write(const Batch& batch);

    /// Ends the stream and shows the file. Throws Error (failed).
    void finish();

    std::uint64_t not_held() const noexcept;  ///< images, samples and triggers left out

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace eventide
