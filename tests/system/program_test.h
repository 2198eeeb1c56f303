// The built program, with a small model and small recordings of the project's own, for the tests
// that run it as a user does.
#pragma once

#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace eventide::test {

/// Made once for each test program: random.safetensors (a network that has learned nothing), which
/// also goes by the name "default"; recording.aedat4, 64x48, 0.4 s with images every 40 ms.
class ProgramTest : public testing::Test {
protected:
    static void SetUpTestSuite();

    /// Runs eventide with these arguments in temp_.
    Result eventide(const std::vector<std::string>& arguments, ProcessSettings settings = {}) const;
    /// The same, not waited for.
    Process start(const std::vector<std::string>& arguments, ProcessSettings settings = {}) const;
    /// Fails with this code, says something with these words, and writes nothing else.
    void expect(int code, const std::vector<std::string>& arguments, const std::string& words,
                ProcessSettings settings = {}) const;
    /// A line of bash in temp_, with eventide in its path; "recording" and "model.safetensors" are
    /// the shared ones.
    Result in_shell(const std::string& script) const;
    /// Where the shared files are.
    static std::string model();
    static std::string recording();
    static std::string wrong_model();  ///< of another shape

    /// Numbers of packets' times that ffprobe finds.
    static std::vector<long long> packet_times(const std::string& file);
    static std::string probe(const std::string& file, const std::string& stream_entries);
    /// The column of a CSV file, without its head.
    static std::vector<long long> column(const std::string& file, std::size_t number);

    TempFolder temp_;
};

}  // namespace eventide::test
