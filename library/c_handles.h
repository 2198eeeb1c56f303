// What stands behind the handles of the C interface.
#pragma once

#include <eventide/camera.h>
#include <eventide/eventide.h>
#include <eventide/reader.h>
#include <eventide/reconstructor.h>
#include <eventide/writer.h>

#include <cstddef>
#include <variant>
#include <vector>

struct eventide_reconstructor {
    eventide::Reconstructor it;
    eventide::Frame frame{};
    std::vector<eventide::Event> events{};
    std::vector<std::byte> state{};
};

struct eventide_source {
    std::variant<eventide::EventReader, eventide::EventCamera> it;
    eventide::Batch batch{};
    std::vector<eventide_event> events{};
};

struct eventide_writer {
    eventide::EventWriter it;
    std::vector<eventide::Event> events{};
};
