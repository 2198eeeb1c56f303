// The installed tree as its users have it.
#pragma once

#include "tests/system/program_test.h"

#include <memory>
#include <string>
#include <vector>

namespace eventide::test {

class Installed : public ProgramTest {
protected:
    /// Installed somewhere, and moved from there.
    static void SetUpTestSuite();
    static void TearDownTestSuite() { place_.reset(); }

    static std::string prefix() { return *place_ / "eventide"; }
    static std::string library_folder() { return prefix() + "/" EVENTIDE_LIBDIR; }
    static std::string example(const std::string& name) {
        return EVENTIDE_SOURCE_DIR "/examples/" + name;
    }

    static void succeed(const std::vector<std::string>& command, ProcessSettings settings = {});

    /// The example writes what `eventide run` does, with the installed default model.
    void expect_frames_of_run(std::vector<std::string> example,
                              ProcessSettings settings = {}) const;

    /// from_text writes what `eventide run` does of the same file, and loads nothing but the core.
    void expect_frames_of_text_with_the_core_alone(const std::string& from_text) const;

    /// What a program loads, as ldd says.
    static std::string libraries_of(const std::string& program);

private:
    void expect_ours_of_run(const std::vector<std::string>& source) const;

    inline static std::unique_ptr<TempFolder> place_;
};

}  // namespace eventide::test
