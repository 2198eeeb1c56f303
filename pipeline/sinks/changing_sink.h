// A sink that changes each frame once and hands it to all the sinks behind it.
#pragma once

#include "pipeline/sink.h"

#include <memory>
#include <vector>

namespace eventide {

class ChangingSink : public Sink {
public:
    explicit ChangingSink(std::vector<std::unique_ptr<Sink>> behind);

    void write(const Frame& frame) final;
    void lookahead_is(int windows) final;
    /// Closes all; then throws the first error of those.
    void close() final;
    /// False as soon as one of them wants no more.
    bool wants_more() const final;
    bool is_watched() const final;
    HostTime::duration held() const final;  ///< by all together

private:
    /// The changed frame, borrowed until the next call.
    virtual const Frame& changed(const Frame& frame) = 0;

    std::vector<std::unique_ptr<Sink>> behind_;
};

}  // namespace eventide
