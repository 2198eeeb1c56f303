// Frames to nowhere, counted: for measuring, and for runs that only want the state at their end.
#pragma once

#include "pipeline/sink.h"

#include <cstdint>

namespace eventide {

class NullSink : public Sink {
public:
    void write(const Frame&) override { ++frames_; }
    std::uint64_t frames() const { return frames_; }

private:
    std::uint64_t frames_ = 0;
};

}  // namespace eventide
