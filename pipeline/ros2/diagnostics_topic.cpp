// The stamps' offset as a diagnostic of ROS 2.
#include "pipeline/ros2/diagnostics_topic.h"

#include "pipeline/ros2/message_parts.h"

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace eventide {

namespace {

using KeyValue = diagnostic_msgs_msg_dds__KeyValue_;

constexpr std::uint8_t kOk = 0;  // DiagnosticStatus.msg

std::string seconds(double us) {
    char text[64];
    std::snprintf(text, sizeof text, "%.6f", us / 1e6);
    return text;
}

}  // namespace

std::string offset_words(double offset_us) {
    const std::string words = "stamps are the sensor's time";
    return offset_us == 0 ? words : words + " + " + seconds(offset_us) + " s";
}

DiagnosticsTopic::DiagnosticsTopic(std::shared_ptr<Participant> participant,
                                   const std::string& name)
    : writer{std::move(participant), kDiagnosticArrayType, kTopic},
      name_{"eventide: " + (name.empty() ? "/" : name) + " stamps"},
      hardware_{name.empty() ? "/" : name} {}

void DiagnosticsTopic::tell(const Told& told) {
    if (writer.readers() == 0) {
        told_us_.reset();  // who comes is told at once
        return;
    }
    if (!told.set_anew && told_us_ && told.stamp_us - *told_us_ < kPeriodUs) return;
    told_us_ = told.stamp_us;
    write(told);
}

void DiagnosticsTopic::write(const Told& told) {
    const std::vector<std::pair<std::string, std::string>> pairs{
        {"offset_s", seconds(told.offset_us)},
        {"stamp_s", seconds(double(told.stamp_us))},
        {"sensor_time_s", seconds(double(told.sensor_us))}};
    std::vector<KeyValue> values;
    values.reserve(pairs.size());
    for (const auto& [key, value] : pairs) values.push_back({borrowed(key), borrowed(value)});
    const std::string words = offset_words(told.offset_us);
    std::vector<diagnostic_msgs_msg_dds__DiagnosticStatus_> status(1);
    status[0].level = kOk;
    status[0].name = borrowed(name_);
    status[0].message = borrowed(words);
    status[0].hardware_id = borrowed(hardware_);
    borrow(status[0].values, values);
    diagnostic_msgs_msg_dds__DiagnosticArray_ message{};
    const std::string no_frame;
    message.header = header_of(told.stamp_us, no_frame);
    borrow(message.status, status);
    writer.write(&message);
}

}  // namespace eventide
