// What tests of USB cameras in software do alike.
#pragma once

#include "drivers/camera.h"
#include "drivers/usb/usb_camera.h"
#include "src/codec/parser.h"
#include "src/core/error.h"
#include "src/core/event.h"
#include "tests/support/error_of.h"
#include "tests/support/usb/usb_testbed.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>

namespace eventide::test {

/// A camera in software needs no time to settle.
inline constexpr UsbWaits kNoWaits{std::chrono::milliseconds{0}, std::chrono::milliseconds{0},
                                   std::chrono::milliseconds{0}};

/// Reads until the model's scene is over and nothing more comes; no byte of it is damaged.
template <typename Model>
Batch stream_scene(Camera& camera, testing_support::UsbTestbed& bed, const Model& model) {
    const auto parser = camera.make_parser();
    Batch data;
    RawPacket packet;
    for (bool over = false; !over;) {
        const ReadStatus status = camera.read(packet);
        if (status == ReadStatus::data) parser->parse(packet.bytes, data);
        if (status == ReadStatus::timeout) bed.look([&] { over = model.is_scene_over(); });
    }
    parser->finish(data);
    for (std::size_t i = 0; i < kDamageReasons; ++i)
        EXPECT_EQ(parser->damaged()[DamageReason(i)], 0U) << name_of(DamageReason(i));
    return data;
}

/// Opens, does `stream`, stops; the words of the Error that ended it, or nothing.
template <typename SomeCamera, typename Options, typename Stream>
std::string end_of_session(const Options& options, const Stream& stream) {
    try {
        SomeCamera camera{options};
        stream(camera);
        camera.stop();
        RawPacket packet;
        camera.read(packet);
        return "";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::device);
        return error.what();
    }
}

/// A camera that reconnects is unplugged once it sends; returns when it is missed.
inline void unplug_while_sending(Camera& camera, testing_support::UsbTestbed& bed) {
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    bed.unplug();
    while (camera.read(packet) != ReadStatus::timeout) continue;
}

/// Reads so many events; those of each transfer lie within less than `most`.
inline void expect_events_held_back_less_than(SensorDuration most, Camera& camera,
                                              std::size_t events) {
    const auto parser = camera.make_parser();
    std::size_t got = 0;
    for (RawPacket packet; got < events;) {
        if (camera.read(packet) != ReadStatus::data) continue;
        Batch part;
        parser->parse(packet.bytes, part);
        if (part.events.empty()) continue;
        got += part.events.size();
        EXPECT_LT(part.events.back().t - part.events.front().t, most);
    }
}

/// A camera that reconnects and is sending is unplugged and plugged in again: its data go on, and
/// say that some are missing.
template <typename Model>
void expect_return_behind_a_gap(Camera& camera, testing_support::UsbTestbed& bed,
                                const std::shared_ptr<Model>& model) {
    RawPacket packet;
    while (camera.read(packet) != ReadStatus::data) continue;
    EXPECT_FALSE(packet.gap_before);
    bed.unplug();
    while (camera.read(packet) != ReadStatus::timeout) continue;
    bed.plug_in(model);
    while (camera.read(packet) != ReadStatus::data) continue;
    EXPECT_TRUE(packet.gap_before);
    EXPECT_TRUE(packet.reopened);
    EXPECT_EQ(camera.counters()[CameraCount::reconnects], 1U);
}

inline std::filesystem::path written(const std::string& toml) {
    const auto file = std::filesystem::path{testing::TempDir()} / "usb_camera.toml";
    std::ofstream{file} << toml;
    return file;
}

inline std::filesystem::path shipped(const char* name) {
    return std::filesystem::path{EVENTIDE_SOURCE_DIR} / "config/cameras" / name;
}

}  // namespace eventide::test
