// Leaves out the events of pixels that fire by themselves.
#include "pipeline/filters/hot_pixels.h"

#include "src/core/error.h"
#include "src/io/input_file.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>
#include <string>

namespace eventide {

namespace {

constexpr double kSeconds = std::chrono::duration<double>(HotPixelFilter::kInterval).count();
constexpr auto kHotCount = std::uint32_t(HotPixelFilter::kHotHz * kSeconds);

}  // namespace

HotPixelFilter::HotPixelFilter(int width, int height)
    : width_{width},
      height_{height},
      learns_{true},
      counts_(std::size_t(width) * std::size_t(height)),
      hot_(counts_.size()) {}

HotPixelFilter::HotPixelFilter(int width, int height, const std::filesystem::path& list)
    : HotPixelFilter{width, height} {
    learns_ = false;
    std::ifstream file = open_to_read(list, ErrorKind::usage);
    int number = 0;
    for (std::string line; std::getline(file, line);) {
        ++number;
        line.resize(std::min(line.find('#'), line.size()));
        std::ranges::replace(line, ',', ' ');
        std::istringstream words{line};
        int x = 0, y = 0;
        std::string rest;
        if (!(words >> rest)) continue;  // nothing on it
        words = std::istringstream{line};
        if (!(words >> x >> y) || words >> rest || x < 0 || y < 0 || x >= width || y >= height)
            throw Error(ErrorKind::usage, list.string() + ":" + std::to_string(number) +
                                              ": expected \"x,y\" inside " + std::to_string(width) +
                                              "x" + std::to_string(height) + ", found '" + line +
                                              "'");
        hot_[std::size_t(y) * std::size_t(width) + std::size_t(x)] = 1;
    }
}

void HotPixelFilter::process(std::vector<Event>& events) {
    std::size_t kept = 0;
    for (const Event& event : events) {
        if (learns_) {
            // After a reset of the clock an old end would never come.
            if (!interval_end_ || event.t + kInterval < *interval_end_)
                interval_end_ = event.t + kInterval;
            if (event.t >= *interval_end_) {
                end_interval();
                // Intervals without any event change nothing a second time: one step over them.
                if (event.t >= *interval_end_) {
                    end_interval();
                    interval_end_ = event.t + kInterval;
                }
            }
            ++counts_[pixel_of(event)];
        }
        if (hot_[pixel_of(event)] == 0) events[kept++] = event;
    }
    events.resize(kept);
}

std::size_t HotPixelFilter::hot_pixels() const {
    return std::size_t(std::ranges::count(hot_, std::uint8_t{1}));
}

void HotPixelFilter::end_interval() {
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
            const std::size_t i = std::size_t(y) * std::size_t(width_) + std::size_t(x);
            if (hot_[i] != 0)
                hot_[i] = counts_[i] >= kHotCount / 2;
            else if (counts_[i] >= kHotCount)
                hot_[i] = counts_[i] >= kTimesNeighbours * median_around(y, x);
        }
    std::ranges::fill(counts_, 0U);
    *interval_end_ += kInterval;
}

std::uint32_t HotPixelFilter::median_around(int y, int x) const {
    std::array<std::uint32_t, 24> around{};
    std::size_t n = 0;
    for (int v = std::max(y - 2, 0); v <= std::min(y + 2, height_ - 1); ++v)
        for (int u = std::max(x - 2, 0); u <= std::min(x + 2, width_ - 1); ++u)
            if (v != y || u != x)
                around[n++] = counts_[std::size_t(v) * std::size_t(width_) + std::size_t(u)];
    if (n == 0) return 0;
    std::nth_element(around.begin(), around.begin() + n / 2, around.begin() + n);
    return around[n / 2];
}

}  // namespace eventide
