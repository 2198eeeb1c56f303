// What ROS 2's tools for diagnostics are told of the stamps.
#pragma once

#include "pipeline/ros2/participant.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace eventide {

/// "stamps are the sensor's time + 1.500000 s"
std::string offset_words(double offset_us);

/// /diagnostics (diagnostic_msgs/DiagnosticArray): the offset between the sensor's time and the
/// stamps, once when it is set, and again each second of the stamps, for those who come late and
/// because aggregators take what is silent for dead. Nothing is written while nobody reads. Render
/// thread.
class DiagnosticsTopic {
public:
    static constexpr const char* kTopic = "/diagnostics";
    static constexpr std::int64_t kPeriodUs = 1'000'000;

    /// `name` is the sink's: "/camera". Throws Error (failed).
    DiagnosticsTopic(std::shared_ptr<Participant> participant, const std::string& name);

    struct Told {
        std::int64_t stamp_us = 0;   ///< of the frame at hand, since 1970
        std::int64_t sensor_us = 0;  ///< its time by the sensor
        double offset_us = 0;        ///< added to the sensor's time
        bool set_anew = false;       ///< is not what was told before
    };
    /// For each frame.
    void tell(const Told& told);

    Ros2Writer writer;

private:
    void write(const Told& told);

    std::string name_, hardware_;
    std::optional<std::int64_t> told_us_;  // the stamp of the last message
};

}  // namespace eventide
