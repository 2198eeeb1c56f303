// What a service manager such as systemd wants to know, by the protocol of sd_notify(3).
#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace eventide::app {

/// Says nothing where no manager asked: NOTIFY_SOCKET names its socket, a path or "@name" of Linux'
/// abstract ones. Messages that do not go through are lost: no run ends for them. Thread: one at a
/// time, alive() excepted.
class ServiceManager {
public:
    /// Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID.
    ServiceManager();
    ~ServiceManager();
    ServiceManager(const ServiceManager&) = delete;
    ServiceManager& operator=(const ServiceManager&) = delete;

    bool is_there() const { return socket_ >= 0; }

    /// How often the manager wants to hear alive(), at least; empty: it does not.
    std::optional<std::chrono::microseconds> watchdog() const { return watchdog_; }

    /// Once: later calls say nothing.
    void ready();
    void alive() { send("WATCHDOG=1"); }
    void stopping() { send("STOPPING=1"); }
    /// One line, which the manager shows.
    void status(const std::string& text);

private:
    void send(const std::string& message);

    int socket_ = -1;
    bool is_ready_ = false;
    std::string address_;  ///< as the socket wants it: a leading 0 for abstract names
    std::optional<std::chrono::microseconds> watchdog_;
};

/// Whether standard error is the journal's stream: JOURNAL_STREAM names its device and inode, by
/// systemd.exec(5). Then each line begins with its priority, "<4>" for a warning (sd-daemon(3)).
bool writes_to_journal();

/// The same for a descriptor and what JOURNAL_STREAM says, "DEVICE:INODE".
bool is_journal(int descriptor, const std::string& stream);

}  // namespace eventide::app
