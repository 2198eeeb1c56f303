// Two names of one file are one file.
#include "src/io/file_identity.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <sys/stat.h>
#include <filesystem>

namespace eventide {
namespace {

namespace fs = std::filesystem;

class Identity : public testing::Test {
protected:
    bool same(const std::string& a, const std::string& b) const {
        return FileIdentity::of(temp_ / a).is_same_file(FileIdentity::of(temp_ / b));
    }
    test::TempFolder temp_;
};

TEST_F(Identity, LinksAndDetoursLeadToTheSameFile) {
    fs::create_directory(temp_ / "d");
    test::write_text(temp_ / "d/file", "x");
    test::write_text(temp_ / "other", "x");
    fs::create_symlink("d/file", temp_ / "symlink");
    fs::create_hard_link(temp_ / "d/file", temp_ / "hardlink");
    fs::create_directory_symlink("d", temp_ / "e");
    for (const char* name : {"d/file", "symlink", "hardlink", "e/file", "d/../e/./file"})
        EXPECT_TRUE(same("d/file", name)) << name;
    EXPECT_FALSE(same("d/file", "other"));
    EXPECT_FALSE(same("d/file", "d"));
}

TEST_F(Identity, FilesThatDoNotExistYetAreTheSameWhereTheyWouldBeMade) {
    fs::create_directory(temp_ / "d");
    fs::create_directory_symlink("d", temp_ / "e");
    fs::create_symlink("d/new", temp_ / "leads_to_nothing");
    for (const char* name : {"d/new", "e/new", "d/../d/new", "leads_to_nothing"})
        EXPECT_TRUE(same("d/new", name)) << name;
    EXPECT_TRUE(same("no/such/folder", "no/such/folder/"));
    EXPECT_FALSE(same("d/new", "d/newer"));
    EXPECT_FALSE(same("no/such/a", "no/such/b"));
}

TEST_F(Identity, DevicesAndTerminalsMayBeSharedPipesMayNot) {
    const auto null = FileIdentity::of("/dev/null");
    EXPECT_FALSE(null.is_same_file(null));
    ASSERT_EQ(mkfifo((temp_ / "pipe").c_str(), 0600), 0);
    EXPECT_TRUE(same("pipe", "pipe"));
}

TEST_F(Identity, ACircleOfLinksIsAName) {
    fs::create_symlink("b", temp_ / "a");
    fs::create_symlink("a", temp_ / "b");
    EXPECT_NO_THROW(FileIdentity::of(temp_ / "a"));
}

TEST_F(Identity, AFileLiesInEveryFolderAboveIt) {
    fs::create_directories(temp_ / "a/b");
    fs::create_directory_symlink("a/b", temp_ / "c");
    EXPECT_TRUE(lies_in(resolved(temp_ / "a/b/file"), resolved(temp_ / "a")));
    EXPECT_TRUE(lies_in(resolved(temp_ / "c/new/file"), resolved(temp_ / "a/b/")));
    EXPECT_TRUE(lies_in(resolved(temp_ / "a/b/"), resolved(temp_ / "a/b")));
    EXPECT_FALSE(lies_in(resolved(temp_ / "a/bc"), resolved(temp_ / "a/b")));
    EXPECT_TRUE(lies_in(resolved(temp_ / "to/be/made"), resolved(temp_ / "to")));
}

}  // namespace
}  // namespace eventide
