// Models are found by file, by name, or not at all with words that help.
#include "apps/cli/settings/model_path.h"
#include "src/core/error.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace eventide::app {
namespace {

TEST(ModelPath, AFileStandsForItselfAndANameForAFileOfTheFolder) {
    const test::TempFolder temp;
    test::write_text(temp / "mine.safetensors", "x");
    EXPECT_EQ(find_model(temp / "mine.safetensors"), temp / "mine.safetensors");
    setenv("EVENTIDE_MODELS", temp.path().c_str(), 1);
    EXPECT_EQ(find_model("mine"), temp / "mine.safetensors");
    try {
        find_model("yours");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        const std::string words = error.what();
        EXPECT_NE(words.find("'yours'"), std::string::npos);
        EXPECT_NE(words.find("mine"), std::string::npos);
        EXPECT_NE(words.find(temp.path().string()), std::string::npos);
    }
    unsetenv("EVENTIDE_MODELS");
}

}  // namespace
}  // namespace eventide::app
