// What people are told while a camera is waited for.
#pragma once

#include "src/core/error.h"

#include <cstddef>
#include <functional>
#include <set>
#include <string>
#include <utility>

namespace eventide {

/// It is looked for fifty times a second, so each reason why it is not there yet is told once,
/// until it is back.
class WaitWarnings {
public:
    explicit WaitWarnings(std::function<void(const std::string&)> warn) : warn_{std::move(warn)} {}

    /// What opening it threw. Settings that do not fit what came back are told, too, and waited
    /// with: a camera that is half there has neither its size nor its controls yet.
    void tell(const Error& error) {
        if (told_.size() < kMost && told_.insert(error.what()).second && warn_)
            warn_(std::string{"waiting for the camera: "} + error.what());
    }
    void is_back() { told_.clear(); }

private:
    static constexpr std::size_t kMost = 20;
    std::function<void(const std::string&)> warn_;
    std::set<std::string> told_;
};

}  // namespace eventide
