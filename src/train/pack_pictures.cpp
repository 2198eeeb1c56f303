// eventide-pack-pictures: photographs into the one file that eventide-train reads.
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

cv::Mat shrink(const cv::Mat& image, int side) {
    const double scale = double(side) / std::max(image.rows, image.cols);
    cv::Mat small;
    if (scale >= 1) return image;
    cv::resize(image, small, {}, scale, scale, cv::INTER_AREA);
    return small;
}

std::vector<fs::path> pictures_below(const fs::path& folder) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator{folder})
        if (entry.is_regular_file()) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

}  // namespace

/// eventide-pack-pictures OUT.pgm SIDE (FOLDER FIRST COUNT)...: pictures FIRST .. FIRST + COUNT - 1
/// of each folder, by name (COUNT 0: all from FIRST on), at most SIDE px large.
int main(int argc, char** argv) {
    if (argc < 6 || (argc - 3) % 3 != 0) {
        std::cerr << "eventide-pack-pictures OUT.pgm SIDE (FOLDER FIRST COUNT)...\n";
        return 2;
    }
    std::ofstream out{argv[1], std::ios::binary};
    int written = 0;
    for (int a = 3; a < argc; a += 3) {
        const std::vector<fs::path> files = pictures_below(argv[a]);
        const auto first = std::size_t(std::atoi(argv[a + 1]));
        const auto count = std::size_t(std::atoi(argv[a + 2]));
        const std::size_t end = count == 0 ? files.size() : std::min(files.size(), first + count);
        for (std::size_t i = first; i < end; ++i) {
            const cv::Mat image = cv::imread(files[i].string(), cv::IMREAD_GRAYSCALE);
            if (image.empty()) {
                std::cerr << files[i].string() << ": not a picture, left out\n";
                continue;
            }
            const cv::Mat small = shrink(image, std::atoi(argv[2]));
            out << "P5\n" << small.cols << " " << small.rows << "\n255\n";
            for (int y = 0; y < small.rows; ++y)
                out.write(reinterpret_cast<const char*>(small.ptr(y)), small.cols);
            ++written;
        }
    }
    std::cout << written << " pictures\n";
    return out ? 0 : 1;
}
