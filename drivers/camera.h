// A source that is a device: what all cameras can be told and asked.
#pragma once

#include "pipeline/camera_counters.h"
#include "pipeline/counter.h"
#include "pipeline/source.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace eventide {

/// What to do about a camera that went away, after the words that say so; users of the program and
/// of the library read it.
inline constexpr const char* kReconnect =
    "; --reconnect (the option reconnect of the library) waits until it is back";

/// A live source. Constructed open and configured; data flow from the first read() on.
class Camera : public Source {
public:
    bool is_live() const noexcept override { return true; }
    CameraCounters counters() const {  ///< any thread, at any time
        CameraCounters now;
        for (std::size_t i = 0; i < kCameraCounts; ++i) now.set(CameraCount(i), counts_[i].value());
        return now;
    }

protected:
    void count(CameraCount what, std::uint64_t n = 1) noexcept {  ///< source thread
        counts_[std::size_t(what)].add(n);
    }

private:
    std::array<Counter, kCameraCounts> counts_;
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
