// The npz reader: what is written is read, and damage is refused by name, never read past.
#include "src/core/error.h"
#include "src/io/npz.h"
#include "tests/io/npz_writer.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

namespace fs = std::filesystem;

fs::path written(const std::string& bytes) {
    const fs::path path =
        fs::path{testing::TempDir()} /
        (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".npz");
    std::ofstream{path, std::ios::binary} << bytes;
    return path;
}

NpzWriter two_arrays() {
    NpzWriter writer;
    writer.add("stored", {2, 3}, {1, 2, 3, 4, 5, 6}, false);
    writer.add("deflated", {4}, {-1, .5F, 0, 7}, true);
    return writer;
}

TEST(Npz, ReadsWhatWasWrittenStoredOrDeflated) {
    const NpzFile file{written(two_arrays().bytes())};
    EXPECT_EQ(file.array("stored").shape, (std::vector<std::int64_t>{2, 3}));
    EXPECT_EQ(file.array("stored").values, (std::vector<float>{1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(file.array("deflated").values, (std::vector<float>{-1, .5F, 0, 7}));
    EXPECT_FALSE(file.contains("absent"));
    EXPECT_THROW(file.array("absent"), Error);
}

/// Opens and reads all; true where that went through.
bool reads(const std::string& bytes) {
    try {
        const NpzFile file{written(bytes)};
        for (const char* name : {"stored", "deflated"}) file.array(name);
        return true;
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        return false;
    }
}

TEST(Npz, RefusesAFileCutAnywhere) {
    const std::string bytes = two_arrays().bytes();
    ASSERT_TRUE(reads(bytes));
    for (std::size_t n = 0; n < bytes.size(); ++n) EXPECT_FALSE(reads(bytes.substr(0, n))) << n;
}

TEST(Npz, SurvivesAnyByteBeingWrong) {
    const std::string bytes = two_arrays().bytes();
    int refused = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i)
        for (const char flip : {'\x01', '\x80', '\xff'}) {
            std::string damaged = bytes;
            damaged[i] = char(damaged[i] ^ flip);
            refused += reads(damaged) ? 0 : 1;
        }
    EXPECT_GT(refused, int(bytes.size()));  // fields nobody reads (dates) may be wrong unseen
}

TEST(Npz, TakesNoMemoryForASizeThatIsOnlySaid) {
    std::string bytes = two_arrays().bytes();
    const std::size_t entry = bytes.rfind("PK\x01\x02");  // of "deflated", in the directory
    for (std::size_t i = 0; i < 4; ++i) bytes[entry + 24 + i] = "\0\0\0\x70"[i];  // 1.8 GB
    try {
        NpzFile{written(bytes)}.array("deflated");
        FAIL() << "was taken";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("said to be of 1879048192 bytes"),
                  std::string::npos)
            << error.what();
    }
}

TEST(Npz, RefusesAShapeThatDoesNotFitTheData) {
    for (const std::int64_t columns : {4, 2}) {
        NpzWriter writer;
        writer.add("stored", {2, columns}, {1, 2, 3, 4, 5, 6}, false);
        EXPECT_THROW(NpzFile{written(writer.bytes())}.array("stored"), Error) << columns;
    }
}

TEST(Npz, RefusesKindsOfNumbersItDoesNotRead) {
    NpzWriter writer;
    const std::string header = "{'descr': '<i8', 'fortran_order': False, 'shape': (1,), }\n";
    writer.add_bytes("stored",
                     std::string{"\x93NUMPY\x01\x00", 8} + char(header.size()) + '\0' + header +
                         std::string(8, '\0'),
                     false);
    EXPECT_THROW(NpzFile{written(writer.bytes())}.array("stored"), Error);
}

}  // namespace
}  // namespace eventide
