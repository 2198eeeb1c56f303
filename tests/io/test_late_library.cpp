// Libraries that are loaded late say what they were wanted for where they are missing.
#include "src/core/error.h"
#include "src/io/image_codecs.h"
#include "src/io/late_library.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace eventide {
namespace {

using testing::AllOf;
using testing::HasSubstr;

template <typename Body>
std::string complaint(Body body) {
    try {
        body();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::failed);
        return error.what();
    }
    return "none";
}

TEST(LateLibrary, NamesWhatIsMissingAndWhatItWasFor) {
    EXPECT_THAT(complaint([] {
                    LateLibrary{"libnot-there.so.7", "image files", "libnot-there7"};
                }),
                AllOf(HasSubstr("image files: "), HasSubstr("libnot-there.so.7"),
                      HasSubstr("Debian's package is libnot-there7")));
    const LateLibrary libc{"libc.so.6", "everything", "libc6"};
    int (*absolute)(int) = nullptr;
    libc.find(absolute, "abs");
    EXPECT_EQ(absolute(-3), 3);
    EXPECT_THAT(complaint([&] { libc.find(absolute, "no_such_function"); }),
                AllOf(HasSubstr("libc.so.6"), HasSubstr("no_such_function")));
}

TEST(ImageCodecs, ReadWhatTheyEncode) {
    cv::Mat image(3, 4, CV_8UC1, cv::Scalar{77});
    std::vector<unsigned char> bytes;
    ASSERT_TRUE(encode_image(".png", image, bytes));
    EXPECT_THAT(std::string(bytes.begin(), bytes.begin() + 4), HasSubstr("PNG"));
    EXPECT_TRUE(can_write_image("x.png"));
    EXPECT_FALSE(can_write_image("x.unknown"));
    EXPECT_TRUE(read_image("/nowhere/x.png", cv::IMREAD_GRAYSCALE).empty());
}

}  // namespace
}  // namespace eventide
