// Several sinks behind one, for sinks that change each frame once and hand it on.
#pragma once

#include "pipeline/sink.h"

#include <memory>
#include <vector>

namespace eventide {

class FanOut {
public:
    explicit FanOut(std::vector<std::unique_ptr<Sink>> sinks);

    void write(const Frame& frame);
    void lookahead_is(int windows);
    /// Closes all; then throws the first error of those.
    void close();
    /// False as soon as one of them wants no more.
    bool wants_more() const;
    bool is_watched() const;
    HostTime::duration held() const;  ///< by all together

private:
    std::vector<std::unique_ptr<Sink>> sinks_;
};

}  // namespace eventide
