// What is written on the command line and in the environment.
#include "drivers/ros2/ros2_source_name.h"
#include "pipeline/ros2/environment.h"
#include "pipeline/ros2/message_types.h"
#include "pipeline/ros2/participant.h"
#include "pipeline/ros2/ros2_name.h"
#include "pipeline/ros2/socket_buffer.h"
#include "src/core/error.h"
#include "tests/support/error_of.h"
#include "tests/system/process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <string>

namespace eventide {
namespace {

using testing::HasSubstr;
using testing::Not;

using test::error_of;

TEST(Ros2Name, ASinkIsANameSpaceAndKeys) {
    const Ros2SinkName plain = parse_ros2_sink_name("/camera");
    EXPECT_EQ(plain.name_space, "/camera");
    EXPECT_EQ(plain.frame_id, "camera");
    EXPECT_EQ(plain.encoding, ImageEncoding::mono8);
    EXPECT_EQ(plain.uncertainty, ImageEncoding::mono16);
    EXPECT_EQ(plain.compressed, ImageCompression::none);
    EXPECT_FALSE(plain.lazy);
    const Ros2SinkName full = parse_ros2_sink_name(
        "/robot/cam0?encoding=32FC1&uncertainty=32FC1&calibration=a/"
        "b.yaml&calibration_camera=cam1&frame_id=left&"
        "lazy=yes&subscribers=2&stamp=sensor");
    EXPECT_EQ(full.name_space, "/robot/cam0");
    EXPECT_EQ(full.encoding, ImageEncoding::float32);
    EXPECT_EQ(full.uncertainty, ImageEncoding::float32);
    EXPECT_EQ(full.calibration, "a/b.yaml");
    EXPECT_EQ(full.calibration_camera, "cam1");
    EXPECT_EQ(full.frame_id, "left");
    EXPECT_TRUE(full.lazy);
    EXPECT_EQ(full.subscribers, 2);
    EXPECT_EQ(full.stamp, StampRule::sensor);
    EXPECT_EQ(parse_ros2_sink_name("/robot/cam0").frame_id, "cam0");
    EXPECT_EQ(parse_ros2_sink_name("/").name_space, "");
    EXPECT_EQ(parse_ros2_sink_name("/c?compressed=jpeg").compressed, ImageCompression::jpeg);
    EXPECT_EQ(parse_ros2_sink_name("/c?encoding=mono16&compressed=png").compressed,
              ImageCompression::png);
}

TEST(Ros2Name, WhatMakesNoSenseIsNamed) {
    for (const char* name : {"camera", "/camera/", "//camera", "/9lives", "/a-b", "/a b", ""})
        EXPECT_THAT(error_of([&] { parse_ros2_sink_name(name); }), HasSubstr("such as /camera"))
            << name;
    const std::map<std::string, std::string> cases{
        {"/c?encoding=rgb8", "encoding: expected mono8, mono16 or 32FC1, found 'rgb8'"},
        {"/c?lazy=1", "lazy: expected no or yes, found '1'"},
        {"/c?subscribers=-1", "subscribers: expected 0 to 1000, found '-1'"},
        {"/c?subscribers=two", "found 'two'"},
        {"/c?stamp=now", "stamp: expected auto, sensor or arrival"},
        {"/c?fps=3", "found 'fps'"},
        {"/c?lazy", "expected KEY=VALUE, found 'lazy'"},
        {"/c?calibration=", "calibration: expected a value"},
        {"/c?encoding=32FC1&compressed=png", "found 'png of 32FC1'"},
        {"/c?encoding=mono16&compressed=jpeg", "found 'jpeg of mono16'"}};
    for (const auto& [name, expected] : cases)
        EXPECT_THAT(error_of([&, &name = name] { parse_ros2_sink_name(name); }),
                    HasSubstr(expected))
            << name;
}

TEST(Ros2Name, ASourceIsATopic) {
    EXPECT_EQ(parse_ros2_source_name("/event_camera/events").topic, "/event_camera/events");
    EXPECT_EQ(parse_ros2_source_name("/e?wait=250ms").wait, SensorDuration{250'000});
    EXPECT_THAT(error_of([] { parse_ros2_source_name("/e?wait=5"); }),
                HasSubstr("such as 10s, found '5'"));
    EXPECT_THAT(error_of([] { parse_ros2_source_name("/e?lazy=yes"); }),
                HasSubstr("expected wait, found 'lazy'"));
    EXPECT_THAT(error_of([] { parse_ros2_source_name("events"); }), HasSubstr("found 'events'"));
}

Ros2Environment environment_of(const std::map<std::string, std::string>& variables) {
    return ros2_environment([&](const char* name) {
        const auto found = variables.find(name);
        return found == variables.end() ? nullptr : found->second.c_str();
    });
}

TEST(Ros2Environment, TakesWhatRosTakes) {
    const Ros2Environment none = environment_of({});
    EXPECT_EQ(none.domain, 0U);
    EXPECT_THAT(none.config, HasSubstr("<FragmentSize>65000B"));
    EXPECT_THAT(none.config, Not(HasSubstr("127.0.0.1")));
    EXPECT_EQ(environment_of({{"ROS_DOMAIN_ID", "42"}}).domain, 42U);
    EXPECT_EQ(environment_of({{"ROS_DOMAIN_ID", ""}}).domain, 0U);
    for (const auto& [name, value] : std::map<std::string, std::string>{
             {"ROS_LOCALHOST_ONLY", "1"}, {"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"}})
        EXPECT_THAT(environment_of({{name, value}}).config,
                    HasSubstr("NetworkInterface address=\"127.0.0.1\""));
    EXPECT_EQ(environment_of({{"ROS_LOCALHOST_ONLY", "0"}}).config, none.config);
    EXPECT_EQ(environment_of({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET"}}).config, none.config);
    EXPECT_THAT(environment_of({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF"}}).config,
                HasSubstr("<Tag>"));
    EXPECT_THAT(environment_of({{"ROS_STATIC_PEERS", "10.0.0.1;robot\"<&"}}).config,
                HasSubstr("<Peer address=\"10.0.0.1\"/><Peer address=\"robot&quot;&lt;&amp;\"/>"));
}

TEST(Ros2Environment, WhatTheUserSaysOfCycloneWins) {
    const std::string own = "<CycloneDDS><Domain/></CycloneDDS>";
    const std::string config =
        environment_of(
            {{"CYCLONEDDS_URI", own}, {"ROS_LOCALHOST_ONLY", "1"}, {"ROS_STATIC_PEERS", "a"}})
            .config;
    EXPECT_TRUE(config.ends_with("," + own)) << config;
}

/// A machine whose interfaces are down fails here, too, and has no such variable.
TEST(Ros2Environment, ADomainThatCannotBeSetUpSaysWhereToLook) {
    EXPECT_FALSE(environment_of({{"ROS_DOMAIN_ID", "1"}}).configured);
    EXPECT_TRUE(environment_of({{"CYCLONEDDS_URI", "<Nonsense/>"}}).configured);
    const auto words = [](bool configured) {
        return error_of([=] { Participant{{231, "<Nonsense/>", configured}}; }, ErrorKind::failed);
    };
    EXPECT_THAT(words(true), HasSubstr("set up domain 231, with what CYCLONEDDS_URI says ("));
    EXPECT_THAT(words(false), HasSubstr("which takes a network interface that is up ("));
}

TEST(Ros2Environment, WhatMakesNoSenseIsNamed) {
    const std::map<std::string, std::string> cases{{"ROS_DOMAIN_ID", "233"},
                                                   {"ROS_LOCALHOST_ONLY", "yes"},
                                                   {"ROS_AUTOMATIC_DISCOVERY_RANGE", "near"}};
    for (const auto& [name, value] : cases)
        EXPECT_THAT(error_of([&, &name = name, &value = value] {
                        environment_of({{name, value}});
                    }),
                    testing::AllOf(HasSubstr(name), HasSubstr("found '" + value + "'")));
}

/// As measured: of the usual 212992 bytes 640x480 fits at 8 bits, at 32 not, and 1280x720 not at
/// all.
TEST(SocketBuffer, KnowsWhatFits) {
    constexpr std::size_t kVga = 640 * 480, kHd = 1280 * 720, kDebian = 212'992;
    EXPECT_TRUE(fits_socket_buffer(kVga, kDebian));
    EXPECT_FALSE(fits_socket_buffer(4 * kVga, kDebian));
    EXPECT_FALSE(fits_socket_buffer(kHd, kDebian));
    EXPECT_TRUE(fits_socket_buffer(4 * kHd, 4 << 20));
    EXPECT_TRUE(fits_socket_buffer(kHd, 0)) << "nothing is known";
    EXPECT_EQ(socket_buffer_command(kHd), "sudo sysctl -w net.core.rmem_max=4194304");
    EXPECT_EQ(socket_buffer_command(4 * kHd), "sudo sysctl -w net.core.rmem_max=8388608");
}

TEST(TypeHashes, AreThoseOfTheTypeDescriptions) {
    const test::Result computed =
        test::run({"python3", EVENTIDE_SOURCE_DIR "/tests/ros2/type_hashes.py",
                   EVENTIDE_SOURCE_DIR "/pipeline/ros2/ros2_messages.idl"});
    ASSERT_EQ(computed.exit_code, 0) << computed.error;
    for (const MessageType* type : {&kImageType, &kCompressedImageType, &kCameraInfoType,
                                    &kDiagnosticArrayType, &kEventPacketType})
        EXPECT_THAT(computed.output,
                    HasSubstr(std::string{type->name} + " " + std::string{type->hash} + "\n"));
    // Published by others, in the type description files of ROS 2: what the script makes of the
    // parts is right, too.
    EXPECT_THAT(
        computed.output,
        HasSubstr("builtin_interfaces/msg/Time "
                  "RIHS01_b106235e25a4c5ed35098aa0a61a3ee9c9b18d197f398b0e4206cea9acf9c197"));
    EXPECT_THAT(
        computed.output,
        HasSubstr("std_msgs/msg/Header "
                  "RIHS01_f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01"));
}

}  // namespace
}  // namespace eventide
