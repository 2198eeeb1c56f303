// Words that were not understood, and what may have been meant.
#include "src/settings/suggestion.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

const std::vector<std::string> kFlags{"--fps", "--from", "--size", "--uncertainty"};

TEST(Suggestion, IsTheNearestWord) {
    EXPECT_EQ(suggestion("--frm", kFlags), "; did you mean --from?");
    EXPECT_EQ(suggestion("--fsp", kFlags), "; did you mean --fps?");
    EXPECT_EQ(suggestion("--uncertanty", kFlags), "; did you mean --uncertainty?");
    EXPECT_EQ(suggestion("rnu", {"run", "info"}), "; did you mean run?");
}

TEST(Suggestion, IsOneThatBeginsAlikeWhereNoneIsNearer) {
    EXPECT_EQ(suggestion("--uncert", kFlags), "; did you mean --uncertainty?");
    EXPECT_EQ(suggestion("--output", {"--overwrite", "--out"}), "; did you mean --out?");
    EXPECT_EQ(suggestion("eval", {"run", "evaluate"}), "; did you mean evaluate?");
    EXPECT_EQ(suggestion("--sizes", {"--siz", "--size"}), "; did you mean --size?");
    EXPECT_EQ(suggestion("--", kFlags), "") << "says nothing";
}

TEST(Suggestion, IsEmptyWhereNothingIsNear) {
    EXPECT_EQ(suggestion("--threads", kFlags), "");
    EXPECT_EQ(suggestion("", kFlags), "");
    EXPECT_EQ(suggestion("--fps", {}), "");
}

}  // namespace
}  // namespace eventide
