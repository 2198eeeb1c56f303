// Files appear whole or not at all, and what was there stays until then.
#include "src/io/output_file.h"

#include "src/core/error.h"
#include "tests/support/file_limit.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>
#include <array>
#include <filesystem>

namespace eventide {
namespace {

namespace fs = std::filesystem;

using test::read_text;
using test::TempFolder;
using test::write_text;

const OutputOptions kReplace{.overwrite = true};
const OutputOptions kGrow{.appears = Appears::growing};
const OutputOptions kReplaceGrowing{.overwrite = true, .appears = Appears::growing};

std::size_t files_in(const TempFolder& temp) {
    return std::size_t(std::distance(fs::directory_iterator{temp.path()}, {}));
}

std::string refusal(const std::string& path, const OutputOptions& options) {
    try {
        OutputFile file{path, options};
    } catch (const Error& error) {
        return (error.kind() == ErrorKind::usage ? "usage: " : "failed: ") +
               std::string{error.what()};
    }
    return {};
}

/// What OutputOptions::unread was told, a line each time.
struct Unread {
    std::string all;
    auto listener() {
        return [this](const std::string& name, PipeReader why) {
            all += name + ": " + std::string{text_of(why)} + "\n";
        };
    }
};

TEST(OutputFile, APipeWhoseReaderGoesAwayIsToldOnceAndIsNoError) {
    signal(SIGPIPE, SIG_IGN);
    const TempFolder temp;
    ASSERT_EQ(::mkfifo((temp / "pipe").c_str(), 0600), 0);
    const int reader = ::open((temp / "pipe").c_str(), O_RDONLY | O_NONBLOCK);
    Unread told;
    OutputFile file{temp / "pipe", {.unread = told.listener()}};
    file.write("first");
    EXPECT_TRUE(file.is_read());
    ::close(reader);
    for (int i = 0; i < 2; ++i) file.write("more");
    EXPECT_EQ(file.reader(), PipeReader::left);
    file.close();
    EXPECT_EQ(told.all, temp / "pipe: its reader went away\n");
}

TEST(OutputFile, APipeThatNobodyOpensIsSaidToHaveHadNoReader) {
    const TempFolder temp;
    ASSERT_EQ(::mkfifo((temp / "pipe").c_str(), 0600), 0);
    int asked = 0;
    Unread told;
    OutputFile file{temp / "pipe",
                    {.give_up = [&] { return ++asked == 2; }, .unread = told.listener()}};
    file.write("never seen");
    EXPECT_EQ(file.reader(), PipeReader::never_came);
    file.close();
    EXPECT_EQ(told.all, temp / "pipe: nobody read it\n");
}

TEST(OutputFile, AFullPipeIsGivenUpWhenAskedTo) {
    std::array<int, 2> ends{};
    ASSERT_EQ(::pipe(ends.data()), 0);
    bool wanted = false;
    const std::string name = "/dev/fd/" + std::to_string(ends[1]);
    Unread told;
    OutputFile file{name, {.give_up = [&] { return wanted; }, .unread = told.listener()}};
    EXPECT_TRUE(file.takes_at_once());
    file.write("first");
    EXPECT_TRUE(file.is_read());
    wanted = true;
    for (int i = 0; i < 2; ++i) file.write(std::string(1 << 20, 'x'));
    EXPECT_FALSE(file.is_read());
    EXPECT_EQ(told.all, name + ": its reader took nothing any more\n");
    EXPECT_FALSE(file.takes_at_once());
    EXPECT_EQ(::fcntl(ends[1], F_GETFL) & O_NONBLOCK, 0) << "of others, who share it";
    file.close();
    ::close(ends[0]);
    ::close(ends[1]);
}

TEST(OutputFile, AWholeFileShowsWhenItIsClosedAndNotBefore) {
    const TempFolder temp;
    OutputFile file{temp / "a"};
    file.write("one ");
    file.write("two");
    EXPECT_FALSE(fs::exists(temp / "a"));
    file.close();
    EXPECT_EQ(read_text(temp / "a"), "one two");
    EXPECT_EQ(files_in(temp), 1U);
}

TEST(OutputFile, WhatIsNotFinishedLeavesTheOldFileAndNothingBeside) {
    const TempFolder temp;
    write_text(temp / "a", "old");
    {
        OutputFile file{temp / "a", kReplace};
        file.write("half");
    }
    EXPECT_EQ(read_text(temp / "a"), "old");
    EXPECT_EQ(files_in(temp), 1U);
}

TEST(OutputFile, AFullDiskLeavesTheOldFile) {
    const TempFolder temp;
    write_text(temp / "a", "old");
    for (const Appears appears : {Appears::whole, Appears::growing}) {
        const test::FileLimit disk{0};
        OutputFile file{temp / "a", {.overwrite = true, .appears = appears}};
        try {
            file.write("new");
            FAIL() << "writing to a full disk went well";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::failed);
            EXPECT_NE(std::string{error.what()}.find(temp / "a" + ": cannot be written: "),
                      std::string::npos)
                << error.what();
        }
        if (appears == Appears::whole) {
            EXPECT_EQ(read_text(temp / "a"), "old");
        }
    }
    EXPECT_EQ(files_in(temp), 1U);
}

TEST(OutputFile, WhatAFileHeldStaysUnderItsOtherNames) {
    for (const OutputOptions& options : {kReplace, kReplaceGrowing}) {
        const TempFolder temp;
        write_text(temp / "a", "precious");
        fs::create_hard_link(temp / "a", temp / "backup");
        fs::permissions(temp / "a", fs::perms::owner_read | fs::perms::owner_write);
        OutputFile file{temp / "a", options};
        EXPECT_EQ(read_text(temp / "a"), "precious") << "until the first byte";
        file.write("new");
        if (options.appears == Appears::growing) {
            EXPECT_EQ(read_text(temp / "a"), "new");
        }
        file.close();
        EXPECT_EQ(read_text(temp / "a"), "new");
        EXPECT_EQ(read_text(temp / "backup"), "precious");
        EXPECT_EQ(fs::status(temp / "a").permissions(),
                  fs::perms::owner_read | fs::perms::owner_write);
        EXPECT_EQ(files_in(temp), 2U);
    }
}

TEST(OutputFile, AFileWithSomethingInItIsKeptUnlessItMayBeReplaced) {
    const TempFolder temp;
    write_text(temp / "a", "precious");
    write_text(temp / "empty", "");
    for (const OutputOptions& options : {OutputOptions{}, kGrow}) {
        EXPECT_EQ(refusal(temp / "a", options),
                  "usage: " + temp / "a" +
                      ": exists already; --overwrite (in the library overwrite) replaces it");
        EXPECT_NE(refusal(temp.path(), options).find("found a folder"), std::string::npos);
        EXPECT_EQ(refusal(temp / "empty", options), "");
    }
    EXPECT_EQ(read_text(temp / "a"), "precious");
    write_file(temp / "a", std::string_view{"new"}, true);
    EXPECT_EQ(read_text(temp / "a"), "new");
}

TEST(OutputFile, AFileThatAnotherMakesMeanwhileStays) {
    const TempFolder temp;
    OutputFile file{temp / "a"};
    file.write("ours");
    write_text(temp / "a", "theirs");
    EXPECT_THROW(file.close(), Error);
    EXPECT_EQ(read_text(temp / "a"), "theirs");
}

TEST(OutputFile, AFileThatAnotherMakesMeanwhileIsReplacedWhereThatIsAskedFor) {
    const TempFolder temp;
    OutputFile file{temp / "a", kReplace};
    file.write("ours");
    write_text(temp / "a", "theirs");
    file.close();
    EXPECT_EQ(read_text(temp / "a"), "ours");
}

TEST(OutputFile, WhatIsOpenForAppendingCannotBeMended) {
    const TempFolder temp;
    for (const int flags : {0, O_APPEND}) {
        const int open = ::open((temp / "log").c_str(), O_WRONLY | O_CREAT | flags, 0600);
        const OutputFile file{"/dev/fd/" + std::to_string(open)};
        EXPECT_EQ(file.is_seekable(), flags == 0);
        ::close(open);
    }
}

TEST(OutputFile, ReplacingKeepsLinksAndPermissions) {
    const TempFolder temp;
    write_text(temp / "target", "old");
    fs::permissions(temp / "target", fs::perms{0640});
    fs::create_symlink("target", temp / "link");
    write_file(temp / "link", std::string_view{"new"}, true);
    EXPECT_TRUE(fs::is_symlink(temp / "link"));
    EXPECT_EQ(read_text(temp / "target"), "new");
    EXPECT_EQ(fs::status(temp / "target").permissions(), fs::perms{0640});
}

TEST(OutputFile, ANameOfItsOwnBesideIsLeftToWhoeverHasIt) {
    const TempFolder temp;
    write_text(temp / "a.part", "mine");
    write_file(temp / "a", std::string_view{"new"}, false);
    EXPECT_EQ(read_text(temp / "a.part"), "mine");
    EXPECT_EQ(read_text(temp / "a"), "new");
    const std::string longest(255, 'x');
    write_file(temp / longest, std::string_view{"new"}, false);
    EXPECT_EQ(read_text(temp / longest), "new");
}

TEST(OutputFile, AGrowingFileReplacesWithItsFirstByteOnly) {
    const TempFolder temp;
    write_text(temp / "a", "old and long");
    {
        OutputFile file{temp / "a", kReplaceGrowing};
        EXPECT_EQ(read_text(temp / "a"), "old and long");
        file.write("new");
        EXPECT_EQ(read_text(temp / "a"), "new");
        file.write("er");
    }
    EXPECT_EQ(read_text(temp / "a"), "newer");
    { OutputFile never_written{temp / "b", kGrow}; }
    EXPECT_FALSE(fs::exists(temp / "b"));
}

TEST(OutputFile, AGrowingFileHasOneWriterAtATime) {
    const TempFolder temp;
    const std::string taken = "usage: " + temp / "a" +
                              ": expected a file that nobody else writes, found one that another "
                              "program writes now";
    {
        OutputFile first{temp / "a", kGrow};
        EXPECT_EQ(refusal(temp / "a", kGrow), taken) << "before its first byte";
        first.write("first");
        EXPECT_EQ(refusal(temp / "a", kReplaceGrowing), taken);
        EXPECT_EQ(read_text(temp / "a"), "first");
        first.close();
    }
    EXPECT_EQ(refusal(temp / "a", kReplaceGrowing), "");
    EXPECT_EQ(read_text(temp / "a"), "first");
    fs::create_hard_link(temp / "a", temp / "other name");
    OutputFile second{temp / "a", kReplaceGrowing};
    second.write("second");
    EXPECT_EQ(refusal(temp / "a", kReplaceGrowing), taken);
    EXPECT_EQ(refusal(temp / "other name", kReplaceGrowing), "") << "what was there before";
}

TEST(OutputFile, WhatIsPublishedGrowsOn) {
    const TempFolder temp;
    OutputFile file{temp / "a"};
    file.write("one\n");
    file.publish();
    EXPECT_EQ(read_text(temp / "a"), "one\n");
    file.write("two\n");
    file.close();
    EXPECT_EQ(read_text(temp / "a"), "one\ntwo\n");
}

TEST(OutputFile, BytesCanBeMended) {
    const TempFolder temp;
    OutputFile file{temp / "a"};
    ASSERT_TRUE(file.is_seekable());
    file.write("??ta");
    file.write_at(0, std::as_bytes(std::span{"da", 2}));
    file.write("!");
    file.close();
    EXPECT_EQ(read_text(temp / "a"), "data!");
}

TEST(OutputFile, DevicesAreWrittenToAndNotReplaced) {
    write_file("/dev/null", std::string_view{"x"}, false);
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
    EXPECT_THROW(write_file("/dev/full", std::string_view{"x"}, false), Error);
}

TEST(OutputFile, AnOpenFileIsNamedAsTheSystemNamesIt) {
    EXPECT_TRUE(names_open_file("/dev/fd/1") && names_open_file("/proc/self/fd/1"));
    EXPECT_TRUE(names_open_file("/dev/stdout") && names_open_file("/dev/stderr"));
    EXPECT_FALSE(names_open_file("/proc/self/fd/01")) << "what is compared with inputs is not it";
}

TEST(OutputFile, SaysWhyItCannotBeMade) {
    EXPECT_EQ(refusal("", {}), "usage: output: expected the name of a file, found none");
    EXPECT_EQ(refusal("/nowhere/a", {}),
              "failed: /nowhere/a: cannot be created: No such file or directory");
}

TEST(OutputFile, AFolderIsCreatedOnceAndWithThoseAboveIt) {
    const TempFolder temp;
    EXPECT_TRUE(create_folder(temp / "a/b/"));
    EXPECT_FALSE(create_folder(temp / "a/b"));
    write_text(temp / "file", "x");
    try {
        create_folder(temp / "file/a");
        ADD_FAILURE() << "took it";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::failed);
        EXPECT_EQ(error.what(), temp / "file/a" + ": cannot be created: Not a directory");
    }
}

TEST(OutputFile, RunningOutOfDescriptorsIsSaidAsSuch) {
    const TempFolder temp;
    rlimit before{};
    getrlimit(RLIMIT_NOFILE, &before);
    const rlimit none{0, before.rlim_max};
    setrlimit(RLIMIT_NOFILE, &none);
    const std::string words = refusal(temp / "a", {});
    setrlimit(RLIMIT_NOFILE, &before);
    EXPECT_NE(words.find("ulimit -n"), std::string::npos) << words;
}

}  // namespace
}  // namespace eventide
