// Progress of long work that is not a run.
#pragma once

#include "apps/cli/run/fitted_line.h"
#include "apps/cli/terminal.h"

#include <chrono>
#include <mutex>
#include <string>

namespace eventide::app {

/// A bar on a terminal, redrawn a few times a second. Thread: any.
class Progress {
public:
    explicit Progress(bool quiet) : line_{quiet} {}

    void show(double share, const std::string& what = {}) {
        const std::lock_guard lock{mutex_};
        const auto now = std::chrono::steady_clock::now();
        if (!line_.active() || now - shown_ < std::chrono::milliseconds{100}) return;
        shown_ = now;
        constexpr std::size_t kShare = 0, kLeft = 1, kWhat = 2;
        constexpr std::size_t kGivesWay[]{kShare, kShare, kLeft, kWhat};
        line_.show(fitted_line({share_part(share), left_part(now - begun_, share), {what, ""}},
                               kGivesWay, line_.columns()));
    }
    void clear() {
        const std::lock_guard lock{mutex_};
        line_.clear();
    }

private:
    std::mutex mutex_;
    ProgressLine line_;
    const std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
    std::chrono::steady_clock::time_point shown_{};
};

}  // namespace eventide::app
