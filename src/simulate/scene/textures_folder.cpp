// Reads image files with OpenCV.
#include "src/simulate/scene/textures_folder.h"

#include "src/core/error.h"
#include "src/io/image_codecs.h"
#include "src/simulate/scene/texture_pack.h"

#include <algorithm>

namespace eventide {

namespace fs = std::filesystem;

std::vector<fs::path> image_files(const fs::path& folder) {
    std::error_code none;
    if (!fs::is_directory(folder, none))
        throw Error(ErrorKind::input, folder.string() + ": expected a folder of images");
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator{folder})
        if (entry.is_regular_file() && names_image(entry.path())) files.push_back(entry.path());
    if (files.empty())
        throw Error(ErrorKind::input, folder.string() + ": expected images, found none");
    std::ranges::sort(files);
    return files;
}

namespace {

cv::Mat checked_image(const fs::path& file, int how) {
    cv::Mat read = read_image(file.string(), how);
    if (read.empty() || read.rows < 2 || read.cols < 2)
        throw Error(ErrorKind::input, file.string() + ": expected an image of at least 2 x 2 px");
    return read;
}

GreyImage image_of(const cv::Mat& read) {
    GreyImage image(read.rows, read.cols);
    for (int y = 0; y < read.rows; ++y)
        std::copy_n(read.ptr<std::uint8_t>(y), read.cols, image.row(y).begin());
    return image;
}

}  // namespace

GreyImage read_grey_image(const fs::path& file) {
    return image_of(checked_image(file, cv::IMREAD_GRAYSCALE));
}

std::array<GreyImage, 3> read_colour_image(const fs::path& file) {
    const cv::Mat read = checked_image(file, cv::IMREAD_COLOR);
    const auto plane = [&read](int channel) {
        cv::Mat one;
        cv::extractChannel(read, one, channel);
        return image_of(one);
    };
    return {plane(0), plane(1), plane(2)};
}

std::array<std::shared_ptr<const TextureLibrary>, 3> colour_textures_from_folder(
    const fs::path& folder, int longest) {
    std::array<std::shared_ptr<TextureLibrary>, 3> libraries;
    for (auto& library : libraries) library = std::make_shared<TextureLibrary>();
    for (const fs::path& file : image_files(folder)) {
        const std::array<GreyImage, 3> image = read_colour_image(file);
        for (std::size_t channel = 0; channel < 3; ++channel)
            libraries[channel]->add(longest > 0 ? shrunk(image[channel], longest) : image[channel]);
    }
    return {libraries[0], libraries[1], libraries[2]};
}

std::shared_ptr<TextureLibrary> textures_from_folder(const fs::path& folder, int longest) {
    auto library = std::make_shared<TextureLibrary>();
    for (const fs::path& file : image_files(folder)) {
        const GreyImage image = read_grey_image(file);
        library->add(longest > 0 ? shrunk(image, longest) : image);
    }
    return library;
}

std::shared_ptr<const TextureLibrary> open_textures(const fs::path& path, std::size_t procedural) {
    if (path.empty()) return procedural_textures(procedural);
    std::error_code none;  // what cannot be looked at cannot be read either, which is said then
    if (fs::is_directory(path, none)) return textures_from_folder(path);
    return textures_from_pack(path);
}

}  // namespace eventide
