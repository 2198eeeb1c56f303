// No output lands on an input or on another output.
#include "src/io/named_files.h"

#include "src/core/error.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <vector>

namespace eventide {
namespace {

namespace fs = std::filesystem;

class NamedFilesTest : public testing::Test {
protected:
    NamedFilesTest() {
        fs::create_directory(temp_ / "d");
        test::write_text(temp_ / "d/in", "x");
        files_.may_replace(true);
    }
    /// What the naming is refused with.
    template <typename Name>
    std::string refusal(Name name, ErrorKind kind = ErrorKind::usage) {
        try {
            name();
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), kind);
            return error.what();
        }
        return {};
    }
    test::TempFolder temp_;
    NamedFiles files_;
};

TEST_F(NamedFilesTest, AnOutputThatIsAnInputIsRefusedWithBothNames) {
    fs::create_symlink("d/in", temp_ / "link");
    files_.reads("SOURCE", temp_ / "d/in");
    EXPECT_EQ(refusal([&] { files_.writes("--record", temp_ / "link"); }),
              "--record " + temp_ / "link" + ": is the same file as SOURCE " + temp_ / "d/in" +
                  "; expected a file of its own");
    EXPECT_EQ(refusal([&] { files_.writes("--record", temp_ / "d/new"); }), "");
    EXPECT_EQ(refusal([&] { files_.reads("--model", temp_ / "d/in"); }), "")
        << "two inputs may be one file";
}

TEST_F(NamedFilesTest, TwoOutputsAreTwoFiles) {
    files_.writes("--out", temp_ / "d/new");
    EXPECT_NE(refusal([&] { files_.writes("--out", temp_ / "d/../d/new"); }), "");
    EXPECT_NE(refusal([&] { files_.reads("--state-in", temp_ / "d/new"); }), "");
    files_.writes("--stats", "/dev/null");
    EXPECT_EQ(refusal([&] { files_.writes("--record", "/dev/null"); }), "");
}

TEST_F(NamedFilesTest, OutputsThatAreNamedPipesFromTheBeginningAreKnown) {
    const std::string pipe = temp_ / "pipe", later = temp_ / "later";
    for (const std::string& path : {pipe, later}) ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
    files_.writes("--out", pipe);
    files_.writes("--out", temp_ / "d/new");
    files_.writes("--record", "-");
    files_.writes_when_done("--state-out", later);
    EXPECT_EQ(files_.pipes(), std::vector<fs::path>{pipe});
}

TEST_F(NamedFilesTest, NothingElseIsReadOrWrittenInAFolderThatIsTakenWhole) {
    files_.reads_all("INPUT", temp_ / "d");
    files_.writes_all("--out", temp_ / "frames");
    EXPECT_NE(refusal([&] { files_.writes("--json", temp_ / "d/in"); }), "");
    EXPECT_NE(refusal([&] { files_.writes("--json", temp_ / "frames/a/b"); }).find("--out"),
              std::string::npos);
    EXPECT_NE(refusal([&] { files_.writes_all("--truth", temp_.path()); }), "");
    EXPECT_EQ(refusal([&] { files_.writes("--json", temp_ / "scores"); }), "");
}

TEST_F(NamedFilesTest, AnOutputLiesInAFolderThatExistsOrThatOneBeforeMakes) {
    const std::string here = fs::canonical(temp_.path());
    EXPECT_EQ(refusal([&] { files_.writes("--record", temp_ / "no/events"); }),
              "--record " + temp_ / "no/events" + ": expected a folder that exists, found no " +
                  here + "/no");
    EXPECT_EQ(refusal([&] { files_.writes_when_done("--json", temp_ / "no/scores"); }),
              "--json " + temp_ / "no/scores" + ": expected a folder that exists, found no " +
                  here + "/no");
    EXPECT_NE(refusal([&] { files_.writes("--record", temp_ / "d/in/events"); }), "")
        << "a file is no folder";
    EXPECT_EQ(refusal([&] { files_.writes("--record", temp_ / "d/events"); }), "");
    EXPECT_EQ(refusal([&] { files_.writes("--csv", "-"); }), "");
    EXPECT_EQ(refusal([&] { files_.writes_when_done("--frame-csv", ""); }), "");
    files_.expect_folder("--plots", temp_ / "plots");
    files_.writes_folder("--out", temp_ / "new/frames/");
    for (const char* file : {"plots/scores", "new/events", "new/frames/states"})
        EXPECT_EQ(refusal([&] { files_.writes("--record", temp_ / file); }), "") << file;
    EXPECT_EQ(refusal([&] { files_.writes_when_done("--json", temp_ / "new/scores"); }), "");
    EXPECT_NE(refusal([&] { files_.writes("--record", temp_ / "new/other/events"); }), "");
}

TEST_F(NamedFilesTest, WhatIsWrittenWhenAllIsDoneGoesWhereFilesCanBeMade) {
    const fs::perms look = fs::perms::group_read | fs::perms::group_exec | fs::perms::others_read |
                           fs::perms::others_exec;
    fs::permissions(temp_ / "d", fs::perms::owner_read | fs::perms::owner_exec | look);
    fs::create_directory(temp_ / "locked");
    fs::permissions(temp_ / "locked", fs::perms::none);
    const uid_t self = geteuid();
    if (self == 0) {  // who may write anywhere
        for (const fs::path& part : {temp_.path(), temp_.path().parent_path()})
            fs::permissions(part, look, fs::perm_options::add);
        ASSERT_EQ(seteuid(65534), 0);
    }
    const auto named = [&](const fs::path& file) {
        return refusal([&] { files_.writes_when_done("--json", file); }, ErrorKind::failed);
    };
    EXPECT_EQ(named(temp_ / "d/scores.json"),
              "--json " + temp_ / "d/scores.json" + ": cannot be created: Permission denied");
    EXPECT_EQ(named("/dev/null"), "") << "a device is there already";
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    EXPECT_EQ(named("/dev/fd/" + std::to_string(ends[1])), "") << "and so is a pipe";
    for (const int end : ends) ::close(end);
    EXPECT_EQ(refusal([&] { files_.writes("--record", temp_ / "locked/d/events"); }), "")
        << "opening it says what is wrong";
    EXPECT_EQ(seteuid(self), 0);
}

TEST_F(NamedFilesTest, AFolderForWhatIsMadeInTheEndIsNoFile) {
    for (const char* name : {"d/in", "d/in/", "d/in/more"})
        EXPECT_EQ(refusal([&] { files_.expect_folder("--plots", temp_ / name); }),
                  "--plots " + temp_ / name + ": expected a folder, found a file, " +
                      fs::canonical(temp_.path()).string() + "/d/in");
    for (const char* name : {"d", "d/", "new", "new/more/"})
        EXPECT_EQ(refusal([&] { files_.expect_folder("--plots", temp_ / name); }), "") << name;
    EXPECT_EQ(refusal([&] { files_.expect_folder("--plots", "plots"); }), "");
}

TEST_F(NamedFilesTest, AnOutputBelowTheHomeSignIsRefused) {
    for (const fs::path path : {"~", "~/video.mp4"}) {
        EXPECT_NE(refusal([&] { files_.writes("--out", path); }).find("found ~"),
                  std::string::npos);
        EXPECT_NE(refusal([&] { files_.writes_when_done("--json", path); }).find("found ~"),
                  std::string::npos);
        EXPECT_NE(refusal([&] { files_.writes_folder("--out", path); }).find("found ~"),
                  std::string::npos);
        EXPECT_NE(refusal([&] { files_.writes_all("--out", path); }).find("found ~"),
                  std::string::npos);
        EXPECT_NE(refusal([&] { files_.expect_folder("--plots", path); }).find("found ~"),
                  std::string::npos);
    }
    EXPECT_EQ(refusal([&] { files_.writes("--out", temp_ / "~"); }), "");
    EXPECT_EQ(refusal([&] { files_.writes("--out", "~video.mp4"); }), "");
}

TEST_F(NamedFilesTest, WhatExistsIsNotReplacedUnasked) {
    files_.may_replace(false);
    EXPECT_NE(refusal([&] { files_.writes("--stats", temp_ / "d/in"); }).find("--overwrite"),
              std::string::npos);
}

}  // namespace
}  // namespace eventide
