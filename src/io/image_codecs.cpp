// OpenCV's imgcodecs by dlopen().
#include "src/io/image_codecs.h"

#include "src/io/late_library.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace eventide {

namespace {

struct ImageCodecs {
    decltype(cv::imread)* imread;
    decltype(cv::imencode)* imencode;
    decltype(cv::haveImageWriter)* have_writer;

    ImageCodecs() {
        const LateLibrary library{EVENTIDE_OPENCV_IMGCODECS, "image files",
                                  "libopencv-imgcodecs406"};
        library.find(imread,
                     "_ZN2cv6imreadERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEEi");
        library.find(imencode,
                     "_ZN2cv8imencodeERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE"
                     "RKNS_11_InputArrayERSt6vectorIhSaIhEERKSB_IiSaIiEE");
        library.find(have_writer,
                     "_ZN2cv15haveImageWriterERKNSt7__cxx1112basic_stringIcSt11char_"
                     "traitsIcESaIcEEE");
    }
};

const ImageCodecs& codecs() {
    static const ImageCodecs loaded;
    return loaded;
}

}  // namespace

void load_image_codecs() {
    codecs();
}

cv::Mat read_image(const std::string& path, int flags) {
    return codecs().imread(path, flags);
}

bool encode_image(const std::string& extension, const cv::Mat& image,
                  std::vector<unsigned char>& bytes, const std::vector<int>& options) {
    return codecs().imencode(extension, image, bytes, options);
}

bool can_write_image(const std::string& path) {
    return codecs().have_writer(path);
}

bool names_image(const std::filesystem::path& path) {
    constexpr std::array<std::string_view, 8> kEndings{".png", ".jpg",  ".jpeg", ".bmp",
                                                       ".tif", ".tiff", ".webp", ".pgm"};
    std::string ending = path.extension().string();
    std::ranges::transform(ending, ending.begin(),
                           [](unsigned char c) { return char(std::tolower(c)); });
    return std::ranges::count(kEndings, ending) > 0;
}

}  // namespace eventide
