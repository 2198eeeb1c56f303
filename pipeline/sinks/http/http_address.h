// Where the live page listens: what stands after "http:" on the command line.
#pragma once

#include <string>
#include <string_view>

namespace eventide {

struct HttpAddress {
    std::string host = "127.0.0.1";  ///< a name, an IPv4 or an IPv6 address without brackets
    int port = 8080;                 ///< 0: any that is free
};

/// "127.0.0.1:8080", "[::1]:8080", "localhost:0"; "8080" and ":8080" mean the loopback address, ""
/// port 8080 of it. Throws Error (usage).
HttpAddress parse_http_address(std::string_view text);

/// An IPv4 or IPv6 address in digits, without brackets.
bool is_ip_address(std::string_view host);

/// Reached from this machine alone: localhost, 127.0.0.0/8, ::1.
bool is_loopback(std::string_view host);

/// "http://127.0.0.1:8080/"
std::string url_of(const HttpAddress& address);

}  // namespace eventide
