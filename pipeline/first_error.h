// The first error of several threads: the others are its consequences.
#pragma once

#include <exception>
#include <mutex>
#include <utility>

namespace eventide {

/// Thread: keep() and is_there() any; rethrow_if_any() when the threads have ended.
class FirstError {
public:
    void keep(std::exception_ptr error) {
        const std::lock_guard lock{mutex_};
        if (!error_) error_ = std::move(error);
    }
    bool is_there() const {
        const std::lock_guard lock{mutex_};
        return error_ != nullptr;
    }
    void rethrow_if_any() const {
        if (error_) std::rethrow_exception(error_);
    }

private:
    mutable std::mutex mutex_;
    std::exception_ptr error_;
};

}  // namespace eventide
