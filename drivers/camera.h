// A source that is a device: what all cameras can be told and asked.
#pragma once

#include "pipeline/source.h"

#include <cstdint>
#include <string>
#include <vector>

namespace eventide {

/// What happened between the device and the host.
struct CameraCounters {
    std::uint64_t transfers = 0, bytes = 0;
    std::uint64_t reconnects = 0;
    std::uint64_t halts = 0;          ///< times the data endpoint stalled and went on
    std::uint64_t odd_transfers = 0;  ///< ended within a word, which was left out
    std::uint64_t device_dropped =
        0;  ///< events the camera itself dropped, as its own counters say (after the run)
    std::uint64_t host_dropped = 0;  ///< datagrams or buffers that came and were not taken in time
};

/// What to do about a camera that went away, after the words that say so; users of the program and
/// of the library read it.
inline constexpr const char* kReconnect =
    "; --reconnect (the option reconnect of the library) waits until it is back";

/// A live source. Constructed open and configured; data flow from the first read() on.
class Camera : public Source {
public:
    bool is_live() const noexcept override { return true; }
    virtual CameraCounters counters() const = 0;  ///< source thread, or after the run
};

/// A camera that was found, usable or not.
struct CameraDescription {
    std::string source;  ///< what `eventide run` takes: "davis:00000042"
    std::string name, serial;
    int bus = 0, address = 0;
    std::string firmware, logic;  ///< empty where it could not be asked
    std::string problem;          ///< why it cannot be used and what to do; empty where it can
};

}  // namespace eventide
