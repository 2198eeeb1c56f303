#include "src/train/picture_pack.h"

#include "src/core/error.h"

#include <cctype>
#include <fstream>
#include <limits>
#include <string>

namespace eventide {
namespace {

constexpr int kLargestSide = 1 << 14;  // px

[[noreturn]] void refuse(const std::filesystem::path& path, std::size_t picture,
                         const std::string& expected) {
    throw Error(ErrorKind::input,
                path.string() + ": picture " + std::to_string(picture) + ": expected " + expected);
}

/// A number of the header; comments run from # to the line's end.
int header_number(std::istream& in) {
    for (in >> std::ws; in.peek() == '#'; in >> std::ws)
        in.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
    int value = -1;
    in >> value;
    return in ? value : -1;
}

}  // namespace

std::shared_ptr<TextureLibrary> load_picture_pack(const std::filesystem::path& path) {
    std::ifstream in{path, std::ios::binary};
    if (!in) throw Error(ErrorKind::input, path.string() + ": cannot be opened");
    auto library = std::make_shared<TextureLibrary>();
    for (; (in >> std::ws).peek() != std::istream::traits_type::eof();) {
        const std::size_t picture = library->size();
        if (in.get() != 'P' || in.get() != '5') refuse(path, picture, "a binary PGM picture (P5)");
        const int width = header_number(in), height = header_number(in), top = header_number(in);
        if (width < 2 || height < 2 || width > kLargestSide || height > kLargestSide || top != 255)
            refuse(path, picture, "a size from 2 x 2 and 255 as largest value");
        in.get();  // the one white space before the pixels
        GreyImage image{height, width};
        in.read(reinterpret_cast<char*>(image.values().data()),
                std::streamsize(image.values().size()));
        if (!in) refuse(path, picture, "more bytes: the file ends inside its pixels");
        library->add(image);
    }
    if (library->empty()) throw Error(ErrorKind::input, path.string() + ": holds no picture");
    return library;
}

}  // namespace eventide
