// Words of settings stand for the enumerators that they are named after.
#include "apps/cli/settings/words.h"
#include "src/core/error.h"

#include <gtest/gtest.h>

namespace eventide::app {
namespace {

TEST(Words, AreReadBackAsTheyAreShown) {
    for (const Word<Precision>& word : kPrecisionWords) {
        EXPECT_EQ(parse_word(std::string{word.text}, kPrecisionWords), word.value);
        EXPECT_EQ(show_word(word.value, kPrecisionWords), word.text);
    }
}

TEST(Words, StandForEnumeratorsWhateverTheirOrder) {
    const std::vector<Word<Engine>> turned{{Engine::fast, "fast"}, {Engine::plain, "plain"}};
    EXPECT_EQ(parse_word("plain", turned), Engine::plain);
    EXPECT_EQ(show_word(Engine::fast, turned), "fast");
}

TEST(Words, OfColourFiltersAreTheirNames) {
    ASSERT_EQ(bayer_words().size(), 5U);
    EXPECT_EQ(parse_word("rggb", bayer_words()), ColourFilter::rggb);
    EXPECT_EQ(parse_word("bggr", bayer_words()), ColourFilter::bggr);
    EXPECT_EQ(parse_word("none", bayer_words()), ColourFilter::none);
}

TEST(Words, OthersAreRefusedWithThoseThereAre) {
    try {
        parse_word("f16", kPrecisionWords);
        ADD_FAILURE() << "no error";
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "expected auto, f32 or bf16, found 'f16'");
    }
}

}  // namespace
}  // namespace eventide::app
