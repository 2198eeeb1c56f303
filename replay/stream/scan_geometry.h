// The size of the sensor where a recording does not say it: from the events themselves.
#pragma once

#include "replay/stream/file_recording.h"
#include "src/core/damage.h"
#include "src/core/sensor_limits.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace eventide {

/// Looks for the smallest sensor known that holds all events but damaged ones (one in a thousand).
class SensorSizeSearch {
public:
    void add(const Batch& batch);

    /// Sets width and height of the header and adds a remark that says so. `left_out`: what was not
    /// given to add(). Throws Error (input) naming `path` where there was no event or there is no
    /// such sensor: one bad coordinate may not make a run allocate gigabytes.
    void conclude(const std::string& path, const Damage& left_out, StreamHeader& header,
                  std::vector<std::string>& remarks) const;

private:
    static constexpr std::size_t kSensors = 8;

    void count(int width, int height, std::uint64_t weight);
    std::size_t smallest() const;

    std::array<std::uint64_t, kSensors> outside_{};  ///< of each known sensor
    std::uint64_t total_ = 0;
    int width_ = 0, height_ = 0;  ///< that hold all
};

/// Reads the whole file once, in bounded memory. Throws as SensorSizeSearch.
void scan_geometry(const ByteFile& file, OpenedStream& stream);

}  // namespace eventide
