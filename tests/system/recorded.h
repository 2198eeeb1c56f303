// What a program with a camera has recorded.
#pragma once

#include "replay/formats.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace eventide::test {

inline Batch recorded(const std::filesystem::path& path) {
    const auto recording = open_recording(path);
    const auto parser = recording->make_parser();
    Batch data;
    for (RawPacket packet; recording->read(packet) == ReadStatus::data;)
        parser->parse(packet.bytes, data);
    parser->finish(data);
    EXPECT_EQ(parser->damaged().total(), 0U) << "the file is whole";
    return data;
}

}  // namespace eventide::test
