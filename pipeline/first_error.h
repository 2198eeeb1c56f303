// The first error of several threads, or of things that are all to be done: the others are its
// consequences.
#pragma once

#include <exception>
#include <mutex>
#include <utility>

namespace eventide {

/// Thread: keep(), guard() and is_there() any; rethrow_if_any() when the threads have ended.
class FirstError {
public:
    void keep(std::exception_ptr error) {
        const std::lock_guard lock{mutex_};
        if (!std::exchange(there_, true)) error_ = std::move(error);
    }
    /// False where `body` threw, which is kept.
    template <typename Body>
    bool guard(Body&& body) noexcept {
        try {
            std::forward<Body>(body)();
            return true;
        } catch (...) {
            keep(std::current_exception());
            return false;
        }
    }
    bool is_there() const {
        const std::lock_guard lock{mutex_};
        return there_;
    }
    /// Throws it once, and holds it no longer: an error may hold on to a lot, those of Python to
    /// all that the functions it went through knew.
    void rethrow_if_any() {
        if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
    }

private:
    mutable std::mutex mutex_;
    bool there_ = false;
    std::exception_ptr error_;
};

}  // namespace eventide
