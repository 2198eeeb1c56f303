// eventide-pack-images: photographs into the one file that eventide-train reads.
#include "src/core/error.h"
#include "src/io/output_file.h"
#include "src/simulate/texture_pack.h"
#include "src/simulate/textures_folder.h"

#include <algorithm>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using namespace eventide;

constexpr const char* kUsage =
    "eventide-pack-pictures OUT LONGEST (FOLDER FIRST COUNT)...\n"
    "Pictures FIRST .. FIRST + COUNT - 1 of each folder, by name (COUNT 0: all from FIRST on),\n"
    "as grey images of at most LONGEST px.\n";

std::vector<GreyImage> photos(const std::vector<std::string>& words) {
    const int longest = std::stoi(words[1]);
    std::vector<GreyImage> images;
    for (std::size_t i = 2; i < words.size(); i += 3) {
        const auto files = image_files(words[i]);
        const std::size_t first = std::stoul(words[i + 1]), count = std::stoul(words[i + 2]);
        const std::size_t end = count == 0 ? files.size() : std::min(files.size(), first + count);
        for (std::size_t k = first; k < end; ++k)
            images.push_back(shrunk(read_grey_image(files[k]), longest));
    }
    return images;
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> words(argv + 1, argv + argc);
    if (words.size() < 5 || (words.size() - 2) % 3 != 0) {
        std::cerr << kUsage;
        return int(ErrorKind::usage);
    }
    try {
        refuse_existing(words[0], false);
        const auto images = photos(words);
        write_texture_pack(words[0], images);
        std::cout << images.size() << " pictures\n";
    } catch (const std::logic_error&) {
        std::cerr << "eventide-pack-pictures: a number is not one\n" << kUsage;
        return int(ErrorKind::usage);
    } catch (const Error& error) {
        std::cerr << "eventide-pack-pictures: " << error.what() << "\n";
        return int(error.kind());
    }
    return 0;
}
