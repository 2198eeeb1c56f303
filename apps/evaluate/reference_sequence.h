// A recording as an evaluation needs it: all events, all reference images, and how they are cut
// into event windows.
#pragma once

#include "replay/open_options.h"
#include "src/core/damage.h"
#include "src/core/event.h"
#include "src/core/frame_data.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace eventide {

class EventFilter;

struct ReferenceSequence {
    std::string name;  ///< of the folder or file
    int width = 0, height = 0;
    /// Time of the recording's first event or image, also where that was not kept: times in seconds
    /// are told from here.
    SensorTime first{};
    Damage damaged;                      ///< what was left out of it, by reason
    std::vector<std::string> warnings;   ///< for people, with its path
    std::vector<Event> events;           ///< in order of time
    std::vector<ReferenceImage> images;  ///< in order of time
};

/// A file's name without its extension, all of a folder's: "speed.5", also of "speed.5/" and of "."
/// in it.
std::string sequence_name(const std::filesystem::path& path);

/// Reads a recording of any format. Where given, only data in [from, to]
/// (s from `first`) are kept, which may be none; where the clock was reset, of the part with the
/// most images. Image times are mended; mosaics, by `bayer` or else by what the recording says, are
/// in colour. Throws Error(input) where the recording has no events, no images, or no sensor size.
ReferenceSequence read_reference_sequence(const std::filesystem::path& path,
                                          std::optional<double> from_s = {},
                                          std::optional<double> to_s = {},
                                          const OpenOptions& input = {},
                                          std::optional<ColourFilter> bayer = {});

/// A single time that lies after the next one is taken as the middle of its neighbours, as EVREAL
/// does (HQF has one); then images are in order of time.
void mend_times(std::vector<ReferenceImage>& images);

/// Throws Error(input) naming `file` for a sensor that no model is to be made for, whatever the
/// file says: its memory would be.
void check_sensor_size(const std::string& file, std::int64_t width, std::int64_t height);

/// A reference image as intensity: grey, 0 to 1.
Array2<float> intensity_of(const ReferenceImage& image);

/// One event window between consecutive images, in order: frame i ends with image i, and the first
/// has no events. An event belongs to the frame in which begin < t <= end, which is EVREAL's
/// searchsorted(times, t, right) - 1 as the last event of a frame.
void for_each_reference_window(const ReferenceSequence& sequence,
                               const std::function<void(const EventWindow&)>& use);

/// Event windows as `window` says (slicer_settings.h), of what the filter leaves, as the pipeline
/// cuts them. Null: of all.
void for_each_cut_window(const ReferenceSequence& sequence, const std::string& window,
                         EventFilter* filter, const std::function<void(const EventWindow&)>& use);

}  // namespace eventide
