/// @file
/// What a sensor says: events, and beside them reference images, inertial samples and triggers; and
/// which sensor it is.
#pragma once

#include <eventide/array.h>
#include <eventide/sensor_time.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace eventide {

/// The colours of a sensor's pixels, 2x2 from the top left corner on, row by row.
enum class ColourFilter : std::uint8_t { none, rggb, grbg, gbrg, bggr };

/// What a recording or a camera says about its sensor.
struct SensorInfo {
    std::string name;    ///< "DAVIS346", or what the recording says; may be empty
    std::string serial;  ///< may be empty
    std::string format;  ///< "aedat4", "evt3", "davis", "text", ...
    int width = 0;       ///< px; 0 where a recording does not say
    int height = 0;      ///< px; 0 where a recording does not say
    ColourFilter colour_filter = ColourFilter::none;  ///< of a colour camera that says so
};

/// Which way brightness changed.
enum class Polarity : std::uint8_t {
    off,  ///< darker
    on,   ///< brighter
};

/// One change of brightness at one pixel.
struct Event {
    SensorTime t;                       ///< when it was
    std::uint16_t x = 0;                ///< px, from the left
    std::uint16_t y = 0;                ///< px, from the top
    Polarity polarity = Polarity::off;  ///< brighter or darker

    friend constexpr bool operator==(const Event&, const Event&) = default;  ///< all members
};
static_assert(sizeof(Event) == 16);

/// An image taken by the sensor itself (APS), or given beside a recording: what reconstructions
/// are compared with.
struct ReferenceImage {
    /// The time the image stands for: the middle of the exposure where it is known, else the
    /// format's own stamp.
    SensorTime t{};
    SensorTime exposure_begin{};               ///< equal to t where the format does not say
    SensorTime exposure_end{};                 ///< equal to t where the format does not say
    int x0 = 0;                                ///< px, left edge of the image in the sensor
    int y0 = 0;                                ///< px, its top edge
    int channels = 1;                          ///< 1 grey, 3 BGR, 4 BGRA; interleaved in `pixels`
    ColourFilter filter = ColourFilter::none;  ///< the sensor's, of a mosaic: channels is 1
    Array2<std::uint16_t>
        pixels{};  ///< [y][x * channels], 0 to 65535; 8-bit data are scaled by 257

    /// All members.
    friend bool operator==(const ReferenceImage&, const ReferenceImage&) = default;
};

/// What the sensor's inertial unit measured at one time.
struct ImuSample {
    SensorTime t{};                         ///< when it was
    std::array<float, 3> acceleration_g{};  ///< x y z, in units of 9.81 m/s^2
    std::array<float, 3> gyro_dps{};        ///< x y z, degrees per second
    std::array<float, 3> magnetic_ut{};  ///< x y z, microtesla; zero where there is no magnetometer
    float temperature_c = 0;             ///< of the unit, degrees Celsius

    friend bool operator==(const ImuSample&, const ImuSample&) = default;  ///< all members
};

/// An edge or pulse on an external input, or a special mark of the camera.
struct Trigger {
    /// What it marks.
    enum class Kind : std::uint8_t {
        timestamp_reset,  ///< the sensor's clock was reset
        rising,           ///< edge
        falling,          ///< edge
        pulse,            ///< both edges in one
        frame_begin,      ///< an image begins
        frame_end,        ///< and ends
        exposure_begin,   ///< an image's exposure begins
        exposure_end,     ///< and ends
        other             ///< any other mark
    };
    SensorTime t{};           ///< when it was
    Kind kind = Kind::other;  ///< what it marks
    std::uint8_t source = 0;  ///< number of the input, from 0, or kGenerator

    /// Not an input, but the camera's own generator of pulses.
    static constexpr std::uint8_t kGenerator = 255;

    friend bool operator==(const Trigger&, const Trigger&) = default;  ///< all members
};

/// What a parser makes of some bytes. Each vector is in the order of the stream.
struct Batch {
    std::vector<Event> events;           ///< changes of brightness
    std::vector<ReferenceImage> images;  ///< the sensor's own images, or those beside a recording
    /// For each image, in order, how many of `events` came before it; for those beyond this
    /// vector's end none did.
    std::vector<std::size_t> image_places;
    std::vector<ImuSample> imu;     ///< inertial samples
    std::vector<Trigger> triggers;  ///< edges, pulses and marks

    /// How many of `events` came before image number i; at most all.
    std::size_t place_of_image(std::size_t i) const {
        return i < image_places.size() ? std::min(image_places[i], events.size()) : 0;
    }
    /// The next image, after the events so far.
    void add_image(ReferenceImage image) {
        image_places.resize(images.size());
        image_places.push_back(events.size());
        images.push_back(std::move(image));
    }

    /// Empties each vector and keeps its memory.
    void clear() {
        events.clear();
        images.clear();
        image_places.clear();
        imu.clear();
        triggers.clear();
    }
    /// Whether there is no event, image, sample or trigger.
    bool empty() const {
        return events.empty() && images.empty() && imu.empty() && triggers.empty();
    }
};

}  // namespace eventide
