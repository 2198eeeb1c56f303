// tests/support/own_temporary_folder.cpp, which is part of every test program.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace {

namespace fs = std::filesystem;

TEST(TemporaryFolder, IsThisProcessesOwn) {
    const fs::path folder = fs::canonical(testing::TempDir());
    EXPECT_EQ(folder, fs::canonical(fs::temp_directory_path()));
    EXPECT_TRUE(fs::is_empty(folder)) << folder;
    EXPECT_EQ(folder.filename().string().substr(0, 2), "ev") << folder;
    EXPECT_EQ(fs::status(folder).permissions(), fs::perms::owner_all);
}

TEST(TemporaryFolder, StaysWhenAForkedChildEnds) {
    EXPECT_EXIT(std::exit(0), testing::ExitedWithCode(0), "");
    EXPECT_TRUE(fs::exists(testing::TempDir()));
}

}  // namespace
