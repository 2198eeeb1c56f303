// Packs of images: nothing lost, damage refused; and images from a folder.
#include "src/core/error.h"
#include "src/simulate/image_codec.h"
#include "src/simulate/random.h"
#include "src/simulate/scene/texture_pack.h"
#include "src/simulate/scene/textures_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace eventide {
namespace {

namespace fs = std::filesystem;

class TexturePack : public testing::Test {
protected:
    void SetUp() override {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = fs::temp_directory_path() / (std::string("eventide_pack_") + test->name());
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    fs::path file() const { return folder_ / "a.textures"; }

    std::string bytes() const {
        std::ifstream stream{file(), std::ios::binary};
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    void write(const std::string& bytes) const { std::ofstream{file(), std::ios::binary} << bytes; }
    fs::path folder_;
};

std::vector<GreyImage> some_images() {
    std::vector<GreyImage> images;
    for (std::size_t i = 0; i < 5; ++i) images.push_back(procedural_image(i, 40 + 7 * int(i), 2));
    GreyImage noise(31, 17);  // no prediction helps here
    Random random{8};
    for (std::uint8_t& v : noise.values()) v = std::uint8_t(random.integer(0, 255));
    images.push_back(noise);
    images.push_back(GreyImage(2, 3));
    return images;
}

TEST_F(TexturePack, GivesBackEveryPixel) {
    write_texture_pack(file(), some_images());
    EXPECT_EQ(read_texture_pack(file()), some_images());
}

TEST_F(TexturePack, ChoosesImagesByNumber) {
    write_texture_pack(file(), some_images());
    EXPECT_EQ(textures_from_pack(file())->size(), 7u);
    EXPECT_EQ(textures_from_pack(file(), [](std::size_t i) { return i % 2 == 1; })->size(), 3u);
}

TEST_F(TexturePack, MakesSmoothImagesSmaller) {
    const GreyImage image = procedural_image(0, 256, 1);
    EXPECT_LT(encode_grey(image).size(), image.values().size() * 3 / 4);
}

TEST_F(TexturePack, RefusesEveryCutAndAForeignFile) {
    write_texture_pack(file(), some_images());
    const std::string whole = bytes();
    for (std::size_t n = 0; n < whole.size(); n += 1 + whole.size() / 97) {
        write(whole.substr(0, n));
        EXPECT_THROW(read_texture_pack(file()), Error) << n;
    }
    write(whole + "x");
    EXPECT_THROW(read_texture_pack(file()), Error);
    write("P5 3 3 255 something else");
    EXPECT_THROW(read_texture_pack(file()), Error);
    EXPECT_THROW(read_texture_pack(folder_ / "missing"), Error);
}

TEST_F(TexturePack, DamagedBytesGiveAnErrorOrAnotherImageButNeverMore) {
    write_texture_pack(file(), some_images());
    const std::string whole = bytes();
    Random random{1};
    for (int i = 0; i < 300; ++i) {
        std::string damaged = whole;
        damaged[std::size_t(random.integer(12, int(whole.size()) - 1))] =
            char(random.integer(0, 255));
        write(damaged);
        try {
            EXPECT_EQ(read_texture_pack(file()).size(), 7u);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::input);
        }
    }
}

TEST_F(TexturePack, ShrinksByAreaMeans) {
    GreyImage image(4, 8);
    for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 4; ++y) image(y, x) = std::uint8_t(10 * x);
    const GreyImage half = shrunk(image, 4);
    ASSERT_EQ(half.width(), 4);
    ASSERT_EQ(half.height(), 2);
    for (int x = 0; x < 4; ++x) EXPECT_EQ(half(1, x), 20 * x + 5);
    EXPECT_EQ(shrunk(image, 100), image);
}

TEST_F(TexturePack, ReadsImagesOfAFolderInTheOrderOfTheirNames) {
    for (const char* name : {"b.pgm", "a.PGM"})
        std::ofstream{folder_ / name} << "P2 3 2 255\n1 2 3 4 5 " << (name[0] == 'a' ? 6 : 7)
                                      << "\n";
    std::ofstream{folder_ / "notes.txt"} << "no image";
    const auto files = image_files(folder_);
    ASSERT_EQ(files.size(), 2u);
    EXPECT_EQ(read_grey_image(files[0])(1, 2), 6);
    EXPECT_EQ(read_grey_image(files[1])(1, 2), 7);
    EXPECT_EQ(textures_from_folder(folder_)->size(), 2u);
    std::ofstream{folder_ / "c.png"} << "broken";
    EXPECT_THROW(textures_from_folder(folder_), Error);
    EXPECT_THROW(image_files(folder_ / "none"), Error);
    const std::string too_long(300, 'x');
    EXPECT_THROW(image_files(too_long), Error);
    EXPECT_THROW(open_textures(too_long, 1), Error);
}

TEST(ProceduralTextures, AreTheSameForTheSameSeedAndOtherwiseNot) {
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_EQ(procedural_image(i, 64, 3), procedural_image(i, 64, 3));
        EXPECT_NE(procedural_image(i, 64, 3), procedural_image(i, 64, 4));
    }
}

}  // namespace
}  // namespace eventide
