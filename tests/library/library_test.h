// The library as a program uses it, beside the program that it must agree with.
#pragma once

#include "tests/support/error_of.h"
#include "tests/system/program_test.h"

#include <eventide/eventide.hpp>

#include <string>
#include <vector>

namespace eventide::test {

class LibraryTest : public ProgramTest {
protected:
    /// Numbers that are the same in every process.
    static ReconstructorOptions repeatable(const std::string& window, int lookahead);
    /// The same for the program. `images`: the camera's correct frames, as where batches are
    /// pushed.
    static std::vector<std::string> repeatable_arguments(const std::string& window, int lookahead,
                                                         bool images = true);

    static Reconstructor reconstructor(const ReconstructorOptions& options);

    /// Intensity and sigma of all frames, as `eventide run` writes them.
    std::string frames_of_run(const std::vector<std::string>& arguments) const;
};

/// All events of the recording.
std::vector<Event> events_of(const std::string& recording);

/// A frame as `--out grayf32: --uncertainty separate` writes it.
void append_frame(const Frame& frame, std::string& bytes);

/// What next() gives now.
void append_frames(Reconstructor& reconstructor, std::string& bytes);

}  // namespace eventide::test
