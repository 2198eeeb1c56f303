// Images in one array, or each in its own.
#include "replay/hdf5/hdf5_tables.h"

#include "src/core/error.h"
#include "src/core/sensor_limits.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace eventide {

namespace {

/// 8 bit as 16, where all numbers of the file are of 8 bit.
bool read_pixels(const Hdf5Data& data, std::uint64_t row, std::uint64_t rows, bool narrow,
                 ReferenceImage& image) {
    const std::span<std::uint16_t> pixels = image.pixels.values();
    if (pixels.size() != rows * data.row_length()) return false;
    if (!data.read<std::uint16_t>(row, pixels)) return false;
    if (narrow)
        for (std::uint16_t& value : pixels) value = std::uint16_t(std::min<int>(value, 255) * 257);
    return true;
}

class Stack final : public ImageTable {
public:
    Stack(const Hdf5File& file, const std::string& images, const std::string& times)
        : images_(file.data(images)), times_(file.data(times)) {
        if (images_.shape().size() != 3 || images_.kind() != Hdf5Data::Kind::integer)
            images_.refuse("[image][y][x]", images_.shape_text());
        size_ = size_of_images(images_, 1);
        if (times_.shape().size() != 1 || times_.rows() != images_.rows())
            times_.refuse("a time for each of " + std::to_string(images_.rows()) + " images",
                          times_.shape_text());
    }
    std::uint64_t rows() const override { return images_.rows(); }
    std::int64_t time_us(std::uint64_t row) override {
        const auto t = times_.number<double>(row);
        return t ? us_from_seconds(*t) : kNoTimeUs;
    }
    std::optional<ReferenceImage> read(std::uint64_t row) override {
        ReferenceImage image;
        image.pixels = Array2<std::uint16_t>(size_.height, size_.width);
        return read_pixels(images_, row, 1, images_.is_narrow(), image)
                   ? std::optional(std::move(image))
                   : std::nullopt;
    }

private:
    Hdf5Data images_, times_;
    Hdf5Size size_;
};

class Images final : public ImageTable {
public:
    Images(const Hdf5File& file, std::string group, std::vector<std::string> names)
        : file_(file), group_(std::move(group)), names_(std::move(names)) {}
    std::uint64_t rows() const override { return names_.size(); }
    std::int64_t time_us(std::uint64_t row) override {
        const auto data = open(row);
        const auto t = data ? data->number_attribute("timestamp") : std::nullopt;
        return t ? us_from_seconds(*t) : kNoTimeUs;
    }
    std::optional<ReferenceImage> read(std::uint64_t row) override {
        const auto opened = open(row);
        if (!opened) return {};
        const Hdf5Data& data = *opened;
        const auto& shape = data.shape();
        const bool grey = shape.size() == 2, colour = shape.size() == 3 && shape[2] == 3;
        const auto fits = [](std::uint64_t n) { return n > 0 && n <= kLargestSensorSide; };
        if ((!grey && !colour) || data.kind() != Hdf5Data::Kind::integer || !fits(shape[0]) ||
            !fits(shape[1]))
            return {};
        const Hdf5Size size = size_of_images(data, 0);
        ReferenceImage image;
        image.channels = colour ? 3 : 1;
        image.pixels = Array2<std::uint16_t>(size.height, size.width * image.channels);
        if (!read_pixels(data, 0, data.rows(), data.is_narrow(), image)) return {};
        return image;
    }

private:
    /// Empty where it is none: one bad image is no reason to refuse the rest.
    std::optional<Hdf5Data> open(std::uint64_t row) const {
        try {
            return file_.data(group_ + "/" + names_[std::size_t(row)]);
        } catch (const Error& error) {
            if (error.kind() == ErrorKind::input) return {};
            throw;
        }
    }
    const Hdf5File& file_;
    std::string group_;
    std::vector<std::string> names_;
};

}  // namespace

Hdf5Size size_of_images(const Hdf5Data& images, std::size_t rows_at) {
    const std::uint64_t height = images.shape()[rows_at], width = images.shape()[rows_at + 1];
    constexpr auto kLargest = std::uint64_t(kLargestSensorSide);
    if (width < 1 || height < 1 || width > kLargest || height > kLargest)
        images.refuse("images of at most " + std::to_string(kLargest) + " px each way",
                      images.shape_text());
    return {int(width), int(height)};
}

std::unique_ptr<ImageTable> open_hdf5_stack(const Hdf5File& file, const std::string& images,
                                            const std::string& times) {
    return std::make_unique<Stack>(file, images, times);
}

std::unique_ptr<ImageTable> open_hdf5_images(const Hdf5File& file, const std::string& group) {
    if (!file.has(group)) return nullptr;
    std::vector<std::string> names = file.names_in(group);
    std::erase_if(names, [](const std::string& name) { return !name.starts_with("image"); });
    if (names.empty()) return nullptr;
    return std::make_unique<Images>(file, group, std::move(names));
}

}  // namespace eventide
