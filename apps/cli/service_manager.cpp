// sd_notify(3) without libsystemd: a datagram of lines to a socket.
#include "apps/cli/service_manager.h"

#include "apps/cli/printable.h"
#include "src/core/environment.h"
#include "src/core/number_text.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstring>
#include <utility>

namespace eventide::app {

namespace {

std::string variable(const char* name) {
    const char* value = environment_value(name);
    return value == nullptr ? "" : value;
}

}  // namespace

ServiceManager::ServiceManager() : address_{variable("NOTIFY_SOCKET")} {
    if (address_.empty() || (address_[0] != '/' && address_[0] != '@')) return;
    if (address_.size() >= sizeof(sockaddr_un::sun_path)) return;
    if (address_[0] == '@') address_[0] = '\0';
    socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    const auto period = number_in<std::uint64_t>(variable("WATCHDOG_USEC"));
    const auto process = number_in<std::uint64_t>(variable("WATCHDOG_PID"));
    const bool is_ours = !process || *process == std::uint64_t(getpid());
    if (period && *period > 0 && is_ours) watchdog_ = std::chrono::microseconds{*period};
}

ServiceManager::~ServiceManager() {
    if (socket_ >= 0) close(socket_);
}

void ServiceManager::ready() {
    if (!std::exchange(is_ready_, true)) send("READY=1");
}

void ServiceManager::status(const std::string& text) {
    send("STATUS=" + printable(text));
}

void ServiceManager::send(const std::string& message) {
    if (socket_ < 0) return;
    sockaddr_un to{};
    to.sun_family = AF_UNIX;
    std::memcpy(to.sun_path, address_.data(), address_.size());
    const auto length = socklen_t(offsetof(sockaddr_un, sun_path) + address_.size());
    sendto(socket_, message.data(), message.size(), MSG_NOSIGNAL,
           reinterpret_cast<const sockaddr*>(&to), length);
}

bool writes_to_journal() {
    return is_journal(STDERR_FILENO, variable("JOURNAL_STREAM"));
}

bool is_journal(int descriptor, const std::string& stream) {
    const std::size_t colon = stream.find(':');
    if (colon == std::string::npos) return false;
    const auto device = number_in<std::uint64_t>(stream.substr(0, colon)),
               inode = number_in<std::uint64_t>(stream.substr(colon + 1));
    struct stat status {};
    return device && inode && fstat(descriptor, &status) == 0 && status.st_dev == *device &&
           status.st_ino == *inode;
}

}  // namespace eventide::app
