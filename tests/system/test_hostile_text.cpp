// Names and texts out of files are shown by every command and obeyed by no terminal.
#include "src/model/model_file.h"
#include "tests/system/program_test.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

namespace eventide::test {
namespace {

/// Clear the screen, a bell, the same as a C1 control, and text that reads backwards.
const std::string kHostile =
    "\x1b[2J\a\xc2\x9b"
    "2J\u202egpj.exe\u202c\x9b"
    "31m";

/// Nothing but text, newlines and tabs.
bool is_safe(const std::string& text) {
    const bool plain = std::ranges::none_of(text, [](char c) {
        const auto code = static_cast<unsigned char>(c);
        return (code < 0x20 && c != '\n' && c != '\t') || code == 0x7F;
    });
    return plain && text.find("\xc2\x9b") == text.npos && text.find("\u202e") == text.npos &&
           text.find(
               "\x9b"
               "31m") == text.npos;
}

class HostileText : public ProgramTest {
protected:
    /// Whatever the command does, it does not hand the text on; it says some of its words.
    void expect_safe(const std::vector<std::string>& arguments, int exit_code,
                     const std::string& words = "[2J") const {
        const Result result = eventide(arguments);
        std::string line = "eventide";
        for (const std::string& argument : arguments) line += " " + argument;
        EXPECT_EQ(result.exit_code, exit_code) << line << "\n" << result.error;
        EXPECT_TRUE(is_safe(result.output)) << line << "\n" << result.output;
        EXPECT_TRUE(is_safe(result.error)) << line << "\n" << result.error;
        EXPECT_NE((result.output + result.error).find(words), std::string::npos)
            << line << "\n"
            << result.output << result.error;
    }
    std::string copy(const std::string& from, const std::string& name) const {
        std::filesystem::copy_file(from, temp_ / name);
        return name;
    }
};

TEST_F(HostileText, TheDetectorSeesIt) {
    EXPECT_FALSE(is_safe(kHostile));
    for (const char* bad : {"\x1b", "\a", "\xc2\x9b", "\u202e"}) EXPECT_FALSE(is_safe(bad));
}

TEST_F(HostileText, InNamesOfFiles) {
    const std::string recorded = copy(recording(), kHostile + ".aedat4");
    const std::string named = copy(model(), kHostile + ".safetensors");
    expect_safe({"run", kHostile, "--out", "null"}, 3);
    expect_safe({"run", recorded, "--out", kHostile + ".bmp"}, 2);
    expect_safe({"run", recorded, "--out", "null", "--model", kHostile}, 3);
    expect_safe({"run", recorded, "--out", kHostile + "/"}, 0, "frames");
    expect_safe({"info", kHostile}, 3);
    expect_safe({"info", recorded}, 0, "aedat4");
    expect_safe({"info", named, "--json"}, 0, "identity");
    expect_safe({"convert", recorded, kHostile + ".txt"}, 0);
    expect_safe({"convert", recorded, kHostile + ".xyz"}, 2);
    expect_safe({"simulate", "--scene", kHostile, "--out", "a.aedat4"}, 2);
    expect_safe({"evaluate", kHostile}, 3);
    expect_safe({"evaluate", recorded, "--model", named, "--json", "-"}, 0);
    expect_safe({"stress", "--models", kHostile, "--quick", "--cases", "one-event"}, 3);
    expect_safe({"bench", "--models", kHostile, "--seconds", "0.2", "--sizes", "32x24"}, 3);
    expect_safe({"devices", kHostile}, 2);
    expect_safe({"doctor", kHostile}, 2);
    expect_safe({kHostile}, 2);
    expect_safe({"run", recorded, "--out", kHostile, "--print-config"}, 0);
}

TEST_F(HostileText, InHeadersAndMetadata) {
    std::string in_a_line = kHostile;
    std::erase(in_a_line, '\a');
    std::erase(in_a_line, '\x1b');  // a RAW header with these is none
    std::ofstream{temp_ / "a.raw", std::ios::binary}
        << "% evt 3.0\n% geometry 64x48\n% camera_integration_name " + in_a_line +
               "\n% serial_number " + in_a_line + "\n% end\n";
    expect_safe({"info", "a.raw"}, 0);
    expect_safe({"run", "a.raw", "--out", "null"}, 0, "no event");
    Model speaking = load_model(model());
    speaking.config.card = kHostile;
    save_model(temp_ / "speaking.safetensors", speaking);
    expect_safe({"info", "speaking.safetensors"}, 0);
    expect_safe({"info", "speaking.safetensors", "--json"}, 0);
    std::ofstream{temp_ / "a.txt"} << kHostile + "\n";
    expect_safe({"info", "a.txt", "--input-format", "text"}, 3);
    std::ofstream{temp_ / "a.toml"} << "[run]\n\"" + in_a_line + "\" = 3\n";
    expect_safe({"run", recording(), "--config", "a.toml", "--out", "null"}, 2, "a.toml:2");
}

}  // namespace
}  // namespace eventide::test
