// What a program with a camera has recorded.
#pragma once

#include "replay/formats.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace eventide::test {

/// While it still grows; `damaged` has what its end leaves open.
inline Batch recorded_so_far(const std::filesystem::path& path, Damage* damaged = nullptr) {
    const auto recording = open_recording(path);
    const auto parser = recording->make_parser();
    Batch data;
    for (RawPacket packet; recording->read(packet) == ReadStatus::data;)
        parser->parse(packet.bytes, data);
    parser->finish(data);
    if (damaged != nullptr) *damaged = parser->damaged();
    return data;
}

inline Batch recorded(const std::filesystem::path& path) {
    Damage damaged;
    Batch data = recorded_so_far(path, &damaged);
    EXPECT_EQ(damaged.total(), 0U) << "the file is whole";
    return data;
}

}  // namespace eventide::test
