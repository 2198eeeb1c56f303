// What a user may state about a recording that its bytes do not say, or say wrongly.
#pragma once

#include "src/codec/text/text_layout.h"

#include <functional>
#include <string>

namespace eventide {

/// What to do about a sensor's size that nothing says; users of the program and of the library read
/// it.
inline constexpr const char* kStateSize =
    "state it with --input-size WIDTHxHEIGHT (the options width and height of the library)";

/// What to tell people of a recording of several cameras: that the events of `left_out` are not
/// read, as those of `read` are, and which `stream` (OpenOptions) would read them.
inline std::string left_out_stream(const std::string& left_out, const std::string& read,
                                   const std::string& stream) {
    return "the events of " + left_out + " are left out, those of " + read +
           " are read; --input-stream " + stream +
           " (the option stream of the library) reads those";
}

struct OpenOptions {
    std::string format{};       ///< a name from all_formats(); empty: found from the content
    int width = 0, height = 0;  ///< px; 0: what the recording says. Both or neither
    /// Of a recording with events of several cameras, whose are read, as remarks() of the recording
    /// name them: the topic of a bag; "davis/right" of an HDF5 file; the number of a source of
    /// AEDAT 3, or of a stream of AEDAT 4. Empty: the first.
    std::string stream{};
    TextOptions text{};
    /// Documents disagree on bit 0 of DVS128 addresses: jAER, which wrote most files, reads 0 as
    /// on; the vendor's text says 1. Used by AEDAT 1.0 and 2.0.
    bool dvs128_one_is_on = false;
    /// Asked every 20 ms while a pipe has no bytes yet: true ends the opening with Error (failed).
    std::function<bool()> give_up{};
    /// Called every 20 ms while a pipe has no bytes, later ones too: what it throws comes out of
    /// the opening or of read(), which may then be called again.
    std::function<void()> while_waiting{};
};

}  // namespace eventide
