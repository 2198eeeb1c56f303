// Named pipes that are opened in whatever order their readers come.
#include "src/io/held_pipes.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>

namespace eventide {

void HeldPipes::look() {
    // Without O_NONBLOCK it would wait for a reader where no signal can end it.
    std::erase_if(waiting_, [this](const std::filesystem::path& pipe) {
        const int file = ::open(pipe.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
        if (file >= 0) files_.push_back(file);
        return file >= 0 || errno != ENXIO;
    });
}

void HeldPipes::wait(const std::function<bool()>& give_up) {
    constexpr int kAskAgainMs = 20;
    for (;;) {
        look();
        if (waiting_.empty() || (give_up && give_up())) return;
        ::poll(nullptr, 0, kAskAgainMs);
    }
}

void HeldPipes::let_go() {
    for (const int file : files_) ::close(file);
    files_.clear();
}

}  // namespace eventide
