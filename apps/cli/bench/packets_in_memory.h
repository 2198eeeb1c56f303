// Recordings made for a measurement, in memory: reading them costs nothing.
#pragma once

#include "apps/cli/commands/recording_in_memory.h"
#include "src/settings/values.h"
#include "src/simulate/sim_recording.h"

#include <memory>
#include <string>

namespace eventide::app {

/// Images in a simulated recording, each the truth of a frame: an event window of 50 ms ends there.
constexpr int kImagesPerSecond = 20;

/// Settings of the scene of this name, for a sensor of this size.
SimRecordingSettings recording_of(const std::string& scene, const Size& size);

/// Throws Error (usage) for an unknown scene.
std::shared_ptr<const RecordedPackets> simulated_packets(const std::string& scene, const Size& size,
                                                         double seconds);

/// Events at random places and times, `rate` of them a second: the parser's and the binner's worst.
std::shared_ptr<const RecordedPackets> random_packets(const Size& size, double rate,
                                                      double seconds);

}  // namespace eventide::app
