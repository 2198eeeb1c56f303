// So many at once, and no more.
#pragma once

#include <atomic>
#include <memory>

namespace eventide {

/// Thread: any.
class Slots {
public:
    explicit Slots(int most) : most_{most} {}

    /// Held for as long as the pointer or a copy of it; null where all are taken.
    std::shared_ptr<const void> take() {
        if (taken_.fetch_add(1) >= most_) {
            taken_.fetch_sub(1);
            return nullptr;
        }
        return {this, [this](const void*) { taken_.fetch_sub(1); }};
    }
    int taken() const { return taken_; }

private:
    const int most_;
    std::atomic<int> taken_{0};
};

}  // namespace eventide
