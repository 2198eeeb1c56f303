// A recording and a model under several names, for tests of what a command was not told to write:
// that it does not touch.
#pragma once

#include "tests/system/program_test.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace eventide::test {

class Outputs : public ProgramTest {
protected:
    Outputs() {
        std::filesystem::copy_file(recording(), temp_ / "rec.aedat4");
        std::filesystem::copy_file(model(), temp_ / "model.safetensors");
        std::filesystem::create_symlink("rec.aedat4", temp_ / "link.aedat4");
        std::filesystem::create_hard_link(temp_ / "rec.aedat4", temp_ / "hard.aedat4");
        write_text(temp_ / "c.toml", "[run]\nfps = 20\n");
    }

    /// Ends with exit code 2 and both names, and leaves every file in the folder as it was.
    void expect_refused(const std::vector<std::string>& arguments, const std::string& one,
                        const std::string& other = {}) const {
        const auto before = files();
        std::string line = "eventide";
        for (const std::string& argument : arguments) line += " " + argument;
        const Result result = eventide(arguments);
        EXPECT_EQ(result.exit_code, 2) << line << "\n" << result.error;
        for (const std::string& words : {one, other})
            EXPECT_NE(result.error.find(words), std::string::npos) << line << "\n" << result.error;
        EXPECT_TRUE(files() == before) << line;
    }

    /// All files with their bytes.
    std::map<std::string, std::string> files() const {
        std::map<std::string, std::string> all;
        for (const auto& entry : std::filesystem::recursive_directory_iterator{temp_.path()})
            all[entry.path()] = entry.is_regular_file() ? read_text(entry.path()) : "";
        return all;
    }
};

}  // namespace eventide::test
