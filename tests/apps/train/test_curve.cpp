// The learning curve as it is drawn.
#include "apps/train/curve.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace eventide {
namespace {

namespace fs = std::filesystem;

/// What is drawn of a log whose rows are minutes and l1.
std::string drawn(const std::string& rows) {
    const fs::path folder = testing::TempDir();
    std::ofstream{folder / "log.csv"} << "step,minutes,l1\n" << rows;
    std::ofstream{folder / "validation.csv"} << "step,minutes,l1\n";
    write_curve(folder / "curve.svg", folder / "log.csv", folder / "validation.csv");
    std::ifstream svg{folder / "curve.svg"};
    return {std::istreambuf_iterator<char>{svg}, {}};
}

TEST(LearningCurve, LeavesOutStepsWhoseLossIsNoNumber) {
    const std::string found = drawn("1,1,.5\n2,2,nan\n3,3,-nan\n4,4,inf\n5,5,.25\n6,6");
    EXPECT_NE(found.find("points='40,10 400,210 '"), std::string::npos) << found;
    EXPECT_NE(found.find(">0.25</text>"), std::string::npos) << "the lowest is none of them";
}

}  // namespace
}  // namespace eventide
