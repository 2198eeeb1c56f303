// Work that its caller need not wait for to the end.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

namespace eventide::python {

/// One thread, which lives on by itself where its work does not end.
class Aside {
public:
    Aside() = default;
    ~Aside() {
        if (!thread_.joinable()) return;
        std::unique_lock lock{shared_->mutex};
        shared_->closed = true;
        shared_->changed.notify_all();
        const bool works = shared_->works;
        lock.unlock();
        works ? thread_.detach() : thread_.join();
    }
    Aside(const Aside&) = delete;
    Aside& operator=(const Aside&) = delete;

    /// Runs `work`, which does not throw, there, and waits for it: after hurry() for kPatience at
    /// most. False where it was left behind: it may end at any time, and there is no further work.
    bool run(std::function<void()> work) {
        std::unique_lock lock{shared_->mutex};
        if (!thread_.joinable()) thread_ = std::thread{&serve, shared_};
        shared_->work = std::move(work);
        shared_->works = true;
        shared_->changed.notify_all();
        const auto has_ended = [this] { return !shared_->works; };
        shared_->changed.wait(lock, [&] { return has_ended() || shared_->hurried; });
        return shared_->changed.wait_for(lock, kPatience, has_ended);
    }
    /// Thread: any.
    void hurry() {
        const std::lock_guard lock{shared_->mutex};
        shared_->hurried = true;
        shared_->changed.notify_all();
    }

private:
    static constexpr std::chrono::milliseconds kPatience{500};

    struct Handed {
        std::mutex mutex;
        std::condition_variable changed;
        std::function<void()> work;  // to begin with
        bool works = false;          // until it has ended
        bool hurried = false;
        bool closed = false;
    };

    static void serve(const std::shared_ptr<Handed>& shared) {
        std::unique_lock lock{shared->mutex};
        for (;;) {
            shared->changed.wait(lock, [&] { return shared->work != nullptr || shared->closed; });
            if (shared->work == nullptr) return;
            std::function<void()> work = std::exchange(shared->work, nullptr);
            lock.unlock();
            work();
            work = nullptr;
            lock.lock();
            shared->works = false;
            shared->changed.notify_all();
        }
    }

    const std::shared_ptr<Handed> shared_ = std::make_shared<Handed>();
    std::thread thread_;
};

}  // namespace eventide::python
