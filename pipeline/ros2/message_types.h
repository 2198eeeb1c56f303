// The messages as DDS has to be told of them.
#pragma once

#include <ros2_messages.h>

#include <string_view>

namespace eventide {

/// `hash` is of the type description (REP-2011, RIHS01); ROS 2 from Iron on looks for it in the
/// USER_DATA of writers and readers. tests/ros2/type_hashes.py computes them from the IDL.
struct MessageType {
    const dds_topic_descriptor_t& descriptor;
    std::string_view name;  ///< as ROS has it
    std::string_view hash;
};

inline const MessageType kImageType{
    sensor_msgs_msg_dds__Image__desc, "sensor_msgs/msg/Image",
    "RIHS01_d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47"};
inline const MessageType kCompressedImageType{
    sensor_msgs_msg_dds__CompressedImage__desc, "sensor_msgs/msg/CompressedImage",
    "RIHS01_15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a"};
inline const MessageType kCameraInfoType{
    sensor_msgs_msg_dds__CameraInfo__desc, "sensor_msgs/msg/CameraInfo",
    "RIHS01_b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275"};
inline const MessageType kDiagnosticArrayType{
    diagnostic_msgs_msg_dds__DiagnosticArray__desc, "diagnostic_msgs/msg/DiagnosticArray",
    "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"};
inline const MessageType kEventPacketType{
    event_camera_msgs_msg_dds__EventPacket__desc, "event_camera_msgs/msg/EventPacket",
    "RIHS01_d6fa176260b1f37e5a40845305315e150a0f18191241eb64f407442aa29844aa"};

}  // namespace eventide
