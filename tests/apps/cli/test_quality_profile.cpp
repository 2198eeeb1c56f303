// What a processor does is measured once; what is not its own is measured anew.
#include "apps/cli/run/quality/measure_profile.h"
#include "apps/cli/run/quality/profile_cache.h"
#include "src/core/error.h"
#include "tests/support/random_model.h"
#include "tests/system/process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace eventide::app {
namespace {

using test::TempFolder;
using testing::HasSubstr;

QualityProfile profile() {
    return {{"Some Processor(R) 9000 @ 2 GHz (avx2)", "AVX2", "auto", "1.0", "default", "0123", 346,
             260},
            {{Precision::f32, "fast, AVX2", 12.5, 4, 2, 1.5, 0.5},
             {Precision::bf16, "fast, bf16 (AMX)", 3.25, 1, 0.5, 0.3, 0.2}}};
}

void expect_same(const QualityProfile& a, const QualityProfile& b) {
    EXPECT_EQ(a.key, b.key);
    ASSERT_EQ(a.costs.size(), b.costs.size());
    for (std::size_t i = 0; i < a.costs.size(); ++i) {
        EXPECT_EQ(a.costs[i].precision, b.costs[i].precision);
        EXPECT_EQ(a.costs[i].engine, b.costs[i].engine);
        EXPECT_EQ(a.costs[i].encode_ms, b.costs[i].encode_ms);
        EXPECT_EQ(a.costs[i].first_ms, b.costs[i].first_ms);
        EXPECT_EQ(a.costs[i].third_ms, b.costs[i].third_ms);
    }
}

class ProfileCache : public testing::Test {
protected:
    CachedProfile get(const ProfileKey& key = profile().key) {
        return cached_profile(folder_.path() / "eventide", key, [&] {
            ++measured_;
            QualityProfile made = profile();
            made.key = key;
            return made;
        });
    }
    TempFolder folder_;
    int measured_ = 0;
};

TEST(QualityProfile, AFileOfBracketsAloneIsRefused) {
    constexpr int kDeep = 200'000;
    const std::string deep = std::string(kDeep, '[') + std::string(kDeep, ']');
    EXPECT_THROW(parse_profile("{\"format\": " + deep + "}", profile().key), Error);
}

TEST_F(ProfileCache, KeepsWhatWasMeasured) {
    EXPECT_TRUE(get().measured);
    const CachedProfile again = get();
    EXPECT_FALSE(again.measured);
    EXPECT_EQ(measured_, 1);
    expect_same(again.profile, profile());
    EXPECT_EQ(again.file.filename(), "some-processor-r-9000-2-ghz_avx2_auto_0123_346x260.json");
    for (const auto& entry : std::filesystem::directory_iterator{folder_.path() / "eventide"})
        EXPECT_EQ(entry.path(), again.file) << "nothing is left beside it";
}

TEST_F(ProfileCache, MeasuresAnewForAnotherProcessorModelSensorOrProgram) {
    get();
    ProfileKey key = profile().key;
    key.processor = "Another";
    EXPECT_TRUE(get(key).measured);
    key = profile().key;
    key.identity = "4567";
    EXPECT_TRUE(get(key).measured);
    key = profile().key;
    key.width = 640;
    EXPECT_TRUE(get(key).measured);
    key = profile().key;
    key.version = "1.1";  // under the same name
    EXPECT_TRUE(get(key).measured);
    EXPECT_FALSE(get(key).measured);
}

TEST_F(ProfileCache, MeasuresAnewWhatIsDamaged) {
    const std::string file = get().file;
    const std::string whole = test::read_text(file);
    const auto with = [&whole](const std::string& part, const std::string& other) {
        EXPECT_THAT(whole, HasSubstr(part));
        std::string text = whole;
        return text.replace(text.find(part), part.size(), other);
    };
    const std::string encode = "\"encode_ms\": 12.5",
                      before = whole.substr(0, whole.find("\"costs"));
    int expected = 1;
    for (const std::string& text :
         {std::string{}, whole.substr(0, whole.size() / 2), std::string{"[]"}, std::string{"null"},
          std::string(1 << 20, '{'), with("\"format\": \"e", "\"format\": \"E"),
          with("\"version\": 1", "\"version\": 2"), with(encode, "\"encode_ms\": -12.5"),
          with(encode, "\"encode_ms\": 0"), with(encode, "\"encode_ms\": 1e9"),
          with(encode, "\"encode_ms\": \"x\""),
          with("\"precision\": \"f32\"", "\"precision\": \"auto\""),
          with("\"engine\": \"fast, AVX2\"", "\"engine\": 7"), before + "\"costs\": []}"}) {
        test::write_text(file, text);
        EXPECT_TRUE(get().measured) << text.substr(0, 60);
        EXPECT_EQ(measured_, ++expected);
        EXPECT_EQ(test::read_text(file), whole) << "and is whole again";
    }
}

TEST_F(ProfileCache, WorksWhereNothingCanBeKept) {
    test::write_text(folder_ / "eventide", "a file where a folder should be");
    EXPECT_TRUE(get().measured);
    EXPECT_TRUE(get().measured);
    const CachedProfile nowhere = cached_profile({}, profile().key, [] { return profile(); });
    EXPECT_TRUE(nowhere.measured);
    EXPECT_TRUE(nowhere.file.empty());
}

TEST_F(ProfileCache, LiesWhereTheUserHasHisCache) {
    setenv("XDG_CACHE_HOME", "/somewhere", 1);
    EXPECT_EQ(cache_folder(), "/somewhere/eventide");
    setenv("XDG_CACHE_HOME", "relative", 1);
    setenv("HOME", "/home/someone", 1);
    EXPECT_EQ(cache_folder(), "/home/someone/.cache/eventide");
    unsetenv("XDG_CACHE_HOME");
    unsetenv("HOME");
    EXPECT_TRUE(cache_folder().empty());
}

TEST(QualityProfile, SaysWhatDiffers) {
    ProfileKey key = profile().key;
    key.height = 180;
    try {
        parse_profile(profile_text(profile()), key);
        FAIL();
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "expected height 180, found 260");
    }
}

TEST(MeasureProfile, MeasuresEveryStageOfANetwork) {
    ModelConfig config;
    config.widths = {8, 8};
    config.recurrent = {1, 0};
    config.bins = 2;
    config.latent = 8;
    config.mlp = {16};
    const Model model = test::random_model(config, 1);
    const ProfileKey key = profile_key("random", model, 48, 32, Kernels::automatic);
    MeasureSettings settings;
    settings.time = std::chrono::duration<double>{0};  // once each
    const QualityProfile measured = measure_profile(key, model, settings);
    ASSERT_NE(measured.of(Precision::f32), nullptr);
    for (const PrecisionCost& cost : measured.costs)
        for (const double ms :
             {cost.encode_ms, cost.first_ms, cost.full_ms, cost.half_ms, cost.third_ms})
            EXPECT_GT(ms, 0);
    expect_same(parse_profile(profile_text(measured), key), measured);
    settings.give_up = [] { return true; };
    EXPECT_THROW(measure_profile(key, model, settings), Error);
    EXPECT_NE(profile_key("other", test::random_model(config, 2), 48, 32, {}).identity,
              key.identity);
}

}  // namespace
}  // namespace eventide::app
