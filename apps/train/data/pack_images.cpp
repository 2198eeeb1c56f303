// eventide-pack-images: photographs into the one file that eventide-train reads.
#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/io/output_file.h"
#include "src/simulate/scene/texture_pack.h"
#include "src/simulate/scene/textures_folder.h"

#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

namespace {

using namespace eventide;

constexpr const char* kUsage =
    "eventide-pack-images OUT LONGEST (FOLDER FIRST COUNT)...\n"
    "Images FIRST .. FIRST + COUNT - 1 of each folder, by name (COUNT 0: all from FIRST on),\n"
    "as grey images of at most LONGEST px.\n";

std::size_t whole(const std::string& text, std::size_t least = 0) {
    const auto value = number_in<std::size_t>(text);
    if (!value || *value < least || *value > 1'000'000)
        throw Error(ErrorKind::usage, "expected a whole number from " + std::to_string(least) +
                                          " on, found '" + text + "'");
    return *value;
}

std::vector<GreyImage> photos(const std::vector<std::string>& words) {
    const int longest = int(whole(words[1], 1));
    std::vector<GreyImage> images;
    for (std::size_t i = 2; i < words.size(); i += 3) {
        const auto files = image_files(words[i]);
        const std::size_t first = whole(words[i + 1]), count = whole(words[i + 2]);
        if (first >= files.size())
            throw Error(ErrorKind::usage,
                        words[i] + ": expected FIRST below " + std::to_string(files.size()) +
                            ", as many images as there are, found " + words[i + 1]);
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
        std::cout << counted(images.size(), "image") << "\n";
    } catch (const Error& error) {
        std::cerr << "eventide-pack-images: " << error.what() << "\n";
        return int(error.kind());
    }
    return 0;
}
