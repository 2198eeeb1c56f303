// ROS 1 bags of one event camera, as HQF comes: dvs_msgs/EventArray and sensor_msgs/Image.
#pragma once

#include "src/core/event.h"
#include "src/io/bag_records.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <span>
#include <string>

namespace eventide {

/// By its name.
inline bool is_bag_file(const std::filesystem::path& path) {
    return path.extension() == ".bag";
}

/// Of several cameras the first of each kind of message is taken. Errors as BagRecords'.
class BagFile {
public:
    explicit BagFile(const std::filesystem::path& path) : records_(path) {}

    /// Appends what the next record holds of events and images (8 bit grey); false at the end.
    bool read(Batch& into);

    /// px, as the messages say; 0 before the first.
    int width() const { return width_; }
    int height() const { return height_; }

    /// Types of messages seen, for who looks for others.
    std::string types() const;

private:
    void take_connection(const BagRecord& record);
    void take_events(std::span<const std::byte> message, Batch& into);
    void take_image(std::span<const std::byte> message, Batch& into);
    void take_size(std::uint32_t width, std::uint32_t height);

    BagRecords records_;
    std::optional<std::uint32_t> events_, images_;  ///< connections
    std::set<std::string> types_;
    int width_ = 0, height_ = 0;
};

}  // namespace eventide
