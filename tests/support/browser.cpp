#include "tests/support/browser.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <stdexcept>
#include <thread>
#include <vector>

namespace eventide::test {

namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kTimeout{60};

/// In the child: descriptors 3 and 4 are the pipe's ends, as --remote-debugging-pipe wants them.
[[noreturn]] void become(const std::vector<std::string>& arguments, int reads, int writes) {
    const int quiet = ::open("/dev/null", O_RDWR);
    const int a = fcntl(reads, F_DUPFD, 10), b = fcntl(writes, F_DUPFD, 10);
    dup2(a, 3);
    dup2(b, 4);
    for (int standard = 0; standard < 3; ++standard) dup2(quiet, standard);
    std::vector<char*> pointers;
    for (const std::string& argument : arguments)
        pointers.push_back(const_cast<char*>(argument.c_str()));
    pointers.push_back(nullptr);
    setpgid(0, 0);
    execv(pointers[0], pointers.data());
    _exit(127);
}

std::string from_base64(const std::string& text) {
    std::string bytes;
    unsigned bits = 0;
    int have = 0;
    for (const char c : text) {
        const unsigned value = c >= 'A' && c <= 'Z'   ? unsigned(c - 'A')
                               : c >= 'a' && c <= 'z' ? unsigned(c - 'a') + 26
                               : c >= '0' && c <= '9' ? unsigned(c - '0') + 52
                               : c == '+'             ? 62U
                               : c == '/'             ? 63U
                                                      : 64U;
        if (value == 64) break;
        bits = bits << 6 | value;
        if ((have += 6) >= 8) bytes += char(bits >> (have -= 8) & 255);
    }
    return bytes;
}

}  // namespace

std::string Browser::program() {
    for (const char* path : {"/usr/bin/chromium", "/usr/bin/chromium-browser"})
        if (access(path, X_OK) == 0) return path;
    return {};
}

Browser::Browser(int width, int height) {
    int there[2], back[2];
    if (pipe2(there, O_CLOEXEC) != 0 || pipe2(back, O_CLOEXEC) != 0)
        throw std::runtime_error("no pipe for the browser");
    const std::vector<std::string> arguments{
        program(),        "--headless=new",          "--no-sandbox",
        "--disable-gpu",  "--disable-dev-shm-usage", "--disable-background-networking",
        "--no-first-run", "--remote-debugging-pipe", "--user-data-dir=" + profile_.path().string(),
        "about:blank"};
    child_ = fork();
    if (child_ == 0) become(arguments, there[0], back[1]);
    close(there[0]);
    close(back[1]);
    to_ = there[1];
    from_ = back[0];
    const std::string target =
        ask("Target.createTarget", {{"url", "about:blank"}}, false)["targetId"];
    session_ =
        ask("Target.attachToTarget", {{"targetId", target}, {"flatten", true}}, false)["sessionId"];
    ask("Emulation.setDeviceMetricsOverride",
        {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", false}});
}

Browser::~Browser() {
    close(to_);
    close(from_);
    kill(-child_, SIGKILL);
    waitpid(child_, nullptr, 0);
}

Json Browser::next_message() {
    const auto until = Clock::now() + kTimeout;
    for (;;) {
        if (const std::size_t end = received_.find('\0'); end != received_.npos) {
            Json message = Json::parse(received_.substr(0, end));
            received_.erase(0, end + 1);
            return message;
        }
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
        pollfd waited{from_, POLLIN, 0};
        char buffer[65536];
        if (left.count() <= 0 || poll(&waited, 1, int(left.count())) == 0)
            throw std::runtime_error("the browser does not answer");
        const ssize_t count = read(from_, buffer, sizeof buffer);
        if (count <= 0) throw std::runtime_error("the browser has ended");
        received_.append(buffer, std::size_t(count));
    }
}

Json Browser::ask(const std::string& method, const Json& parameters, bool of_page) {
    Json request{{"id", ++last_id_}, {"method", method}, {"params", parameters}};
    if (of_page) request["sessionId"] = session_;
    const std::string text = request.dump() + '\0';
    for (std::size_t sent = 0; sent < text.size();) {
        const ssize_t count = write(to_, text.data() + sent, text.size() - sent);
        if (count <= 0) throw std::runtime_error("the browser has ended");
        sent += std::size_t(count);
    }
    for (;;) {
        Json message = next_message();
        if (!message.contains("id") || message["id"] != last_id_) continue;  // an event
        if (message.contains("error"))
            throw std::runtime_error(method + ": " + message["error"].dump());
        return message["result"];
    }
}

void Browser::open(const std::string& url) {
    ask("Page.navigate", {{"url", url}});
}

Json Browser::value(const std::string& expression) {
    const Json answer =
        ask("Runtime.evaluate",
            {{"expression", expression}, {"returnByValue", true}, {"awaitPromise", true}});
    if (answer.contains("exceptionDetails")) return nullptr;
    return answer["result"].contains("value") ? answer["result"]["value"] : Json(nullptr);
}

bool Browser::becomes_true(const std::string& expression, std::chrono::seconds most) {
    for (const auto until = Clock::now() + most; Clock::now() < until;) {
        if (value(expression) == true) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds{50});
    }
    return false;
}

void Browser::screenshot(const std::string& file) {
    const std::string data = ask("Page.captureScreenshot", {{"format", "png"}})["data"];
    std::ofstream{file, std::ios::binary} << from_base64(data);
}

}  // namespace eventide::test
