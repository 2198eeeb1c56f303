// Chromium without a window, told what to do through its debugging pipe (no port, no WebSocket).
#pragma once

#include "tests/system/process.h"

#include <nlohmann/json.hpp>

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>

namespace eventide::test {

/// One page of one browser. Throws std::runtime_error where the browser does not answer.
class Browser {
public:
    /// Where Debian's chromium is; empty where it is not installed.
    static std::string program();

    Browser(int width, int height);
    ~Browser();
    Browser(const Browser&) = delete;
    Browser& operator=(const Browser&) = delete;

    void open(const std::string& url);
    /// The value of an expression, or of the promise that it is.
    nlohmann::json value(const std::string& expression);
    /// Asks again and again until it is true; false where it was not in time.
    bool becomes_true(const std::string& expression, std::chrono::seconds most);
    /// PNG.
    void screenshot(const std::string& file);

private:
    nlohmann::json ask(const std::string& method, const nlohmann::json& parameters,
                       bool of_page = true);
    nlohmann::json next_message();

    TempFolder profile_;
    pid_t child_ = -1;
    int to_ = -1, from_ = -1;
    int last_id_ = 0;
    std::string session_, received_;
};

}  // namespace eventide::test
