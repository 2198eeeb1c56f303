#include "pipeline/sinks/http/http_address.h"

#include "src/core/error.h"
#include "src/core/number_text.h"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>

namespace eventide {

namespace {

[[noreturn]] void refuse(std::string_view text) {
    throw Error(ErrorKind::usage, "--out http:" + std::string{text} +
                                      ": expected an address and a port such as "
                                      "http:127.0.0.1:8080, http:[::1]:8080 or http:8080");
}

int parse_port(std::string_view digits, std::string_view text) {
    const int port = number_in<int>(digits).value_or(-1);
    if (port < 0 || port > 65535) refuse(text);
    return port;
}

bool is_name_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '.' || c == '_';
}

}  // namespace

HttpAddress parse_http_address(std::string_view text) {
    HttpAddress address;
    if (text.empty()) return address;
    if (std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; })) {
        address.port = parse_port(text, text);
        return address;
    }
    const std::size_t colon = text.rfind(':');
    if (colon == text.npos) refuse(text);
    address.port = parse_port(text.substr(colon + 1), text);
    std::string_view host = text.substr(0, colon);
    if (host.empty()) return address;
    if (host.starts_with('[') && host.ends_with(']')) {
        host = host.substr(1, host.size() - 2);
        if (!is_ip_address(host) || host.find(':') == host.npos) refuse(text);
    } else if (!std::ranges::all_of(host, is_name_letter)) {
        refuse(text);
    }
    address.host = host;
    return address;
}

/// inet_pton() stops at a zero, and whatever follows it would be let through.
bool is_ip_address(std::string_view host) {
    const auto may_be = [](char c) {
        return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F') ||
               c == '.' || c == ':';
    };
    const std::string name{host};
    in_addr four{};
    in6_addr six{};
    return std::ranges::all_of(name, may_be) && (inet_pton(AF_INET, name.c_str(), &four) == 1 ||
                                                 inet_pton(AF_INET6, name.c_str(), &six) == 1);
}

bool is_loopback(std::string_view host) {
    if (!is_ip_address(host)) return host == "localhost";
    const std::string name{host};
    in_addr four{};
    in6_addr six{};
    if (inet_pton(AF_INET, name.c_str(), &four) == 1) return ntohl(four.s_addr) >> 24 == 127;
    if (inet_pton(AF_INET6, name.c_str(), &six) == 1) return IN6_IS_ADDR_LOOPBACK(&six);
    return false;
}

std::string url_of(const HttpAddress& address) {
    const bool six = address.host.find(':') != std::string::npos;
    return "http://" + (six ? "[" + address.host + "]" : address.host) + ":" +
           std::to_string(address.port) + "/";
}

}  // namespace eventide
