// Leaves out the events of pixels that fire by themselves.
#include "pipeline/filters/hot_pixels.h"

#include "src/core/error.h"
#include "src/core/text_piece.h"
#include "src/io/input_file.h"

#include <algorithm>
#include <sstream>
#include <string>

namespace eventide {

HotPixelFilter::HotPixelFilter(int width, int height) : width_{width} {
    learned_.emplace(width, height, kHotHz, SensorDuration{250'000});
}

HotPixelFilter::HotPixelFilter(int width, int height, const std::filesystem::path& list)
    : width_{width}, listed_(std::size_t(width) * std::size_t(height)) {
    constexpr std::size_t kLargestList = std::size_t{64} << 20;  // a few million pixels
    std::istringstream file{read_text_file(list, ErrorKind::usage, kLargestList)};
    int number = 0;
    for (std::string line; std::getline(file, line);) {
        ++number;
        std::string numbers = line.substr(0, line.find('#'));
        std::ranges::replace(numbers, ',', ' ');
        std::istringstream words{numbers};
        int x = 0, y = 0;
        std::string rest;
        if (!(words >> rest)) continue;  // nothing on it
        words = std::istringstream{numbers};
        if (!(words >> x >> y) || words >> rest || x < 0 || y < 0 || x >= width || y >= height)
            throw Error(ErrorKind::usage, list.string() + ":" + std::to_string(number) +
                                              ": expected \"x,y\" inside " + std::to_string(width) +
                                              "x" + std::to_string(height) + ", found '" +
                                              piece_of(line) + "'");
        listed_[std::size_t(y) * std::size_t(width) + std::size_t(x)] = 1;
    }
}

void HotPixelFilter::process(std::vector<Event>& events) {
    if (learned_) {
        std::erase_if(events, [this](const Event& event) { return learned_->is_hot(event); });
        return;
    }
    std::erase_if(events, [this](const Event& event) {
        return listed_[std::size_t(event.y) * std::size_t(width_) + event.x] != 0;
    });
}

std::size_t HotPixelFilter::hot_pixels() const {
    return learned_ ? learned_->count() : std::size_t(std::ranges::count(listed_, 1));
}

}  // namespace eventide
