// What a service manager hears while a source is waited for, however long that takes.
#pragma once

#include "apps/cli/service_manager.h"

#include <chrono>
#include <string>
#include <utility>

namespace eventide::app {

/// A start has a time limit and a source that is waited for without one has none, so the service
/// counts as started from the first wait on. Thread: the one that opens the source.
class SourceWait {
public:
    /// `source`: its name, for people. `manager` is borrowed.
    SourceWait(ServiceManager& manager, std::string source)
        : manager_{manager}, source_{std::move(source)} {}

    /// Called again and again while there is nothing.
    void go_on() {
        const auto now = std::chrono::steady_clock::now();
        if (now < next_) return;
        next_ = now + kTick;
        manager_.ready();
        manager_.status("waiting for " + source_);
        if (manager_.watchdog()) manager_.alive();
    }

private:
    static constexpr std::chrono::milliseconds kTick{250};

    ServiceManager& manager_;
    const std::string source_;
    std::chrono::steady_clock::time_point next_{};
};

}  // namespace eventide::app
