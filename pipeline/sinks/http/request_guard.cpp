#include "pipeline/sinks/http/request_guard.h"

#include "pipeline/sinks/http/http_address.h"
#include "src/core/error.h"
#include "src/core/lower_case.h"

#include <sys/random.h>

#include <algorithm>
#include <array>

namespace eventide {

namespace {

bool is_port(std::string_view text) {
    return !text.empty() && text.size() <= 5 &&
           std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

bool is_ours(const std::string& name, const std::vector<std::string>& names) {
    return !name.empty() && (name == "localhost" || is_ip_address(name) ||
                             std::ranges::any_of(names, [&](const std::string& known) {
                                 return lower_case(known) == name;
                             }));
}

/// A proxy may speak HTTPS to the browser and HTTP to us.
bool is_same_origin(const std::string& origin, const std::string& host) {
    const std::string given = lower_case(origin), own = lower_case(host);
    return given == "http://" + own || given == "https://" + own;
}

bool is_json(std::string_view content_type) {
    const std::string type = lower_case(content_type.substr(0, content_type.find(';')));
    const auto end = type.find_last_not_of(" \t");
    return end != type.npos && type.substr(0, end + 1) == "application/json";
}

/// In a time that does not tell how much was right.
bool equal(std::string_view a, std::string_view b) {
    unsigned difference = a.size() == b.size() ? 0U : 1U;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        difference |= unsigned(static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]));
    return difference == 0;
}

bool has_token(const RequestHead& request, const std::string& token) {
    constexpr std::string_view kBearer = "bearer ";
    const std::string& given = request.authorization;
    if (lower_case(given.substr(0, kBearer.size())) == kBearer &&
        equal(std::string_view{given}.substr(kBearer.size()), token))
        return true;
    return equal(request.token, token);
}

bool is_of_another_site(const RequestHead& request) {
    const std::string site = lower_case(request.fetch_site);
    if (site.empty() || site == "same-origin" || site == "none") return false;
    // A link to the page itself does no harm, wherever it stands.
    return request.method == "POST" || request.path != "/";
}

}  // namespace

std::string host_name(std::string_view host) {
    if (host.starts_with('[')) {
        const std::size_t end = host.find(']');
        if (end == host.npos) return {};
        const std::string_view rest = host.substr(end + 1);
        if (!rest.empty() && !(rest.front() == ':' && is_port(rest.substr(1)))) return {};
        std::string name = lower_case(host.substr(1, end - 1));
        return name.find(':') != name.npos && is_ip_address(name) ? name : "";
    }
    const std::size_t colon = host.find(':');
    if (colon != host.npos && !is_port(host.substr(colon + 1))) return {};
    return lower_case(host.substr(0, colon));
}

std::optional<Refusal> judge(const RequestHead& request, const GuardSettings& settings) {
    if (request.method != "GET" && request.method != "HEAD" && request.method != "POST")
        return Refusal{405, "expected GET, HEAD or POST"};
    if (request.hosts != 1 || !is_ours(host_name(request.host), settings.names))
        return Refusal{421,
                       "the Host of the request is not this one; --http-name NAME allows a name"};
    if (!request.origin.empty() && !is_same_origin(request.origin, request.host))
        return Refusal{403, "requests of pages of other sites are refused"};
    if (is_of_another_site(request))
        return Refusal{403, "requests of pages of other sites are refused"};
    if (request.method == "POST" && !is_json(request.content_type))
        return Refusal{415, "expected Content-Type: application/json"};
    if (request.method == "POST" && !request.has_length)
        return Refusal{411, "expected Content-Length"};
    if (!request.content_encoding.empty() && lower_case(request.content_encoding) != "identity")
        return Refusal{415, "expected no Content-Encoding"};
    const bool open = request.path == "/page.js" || request.path == "/page.css";
    if (!settings.token.empty() && !open && !has_token(request, settings.token))
        return Refusal{401, "expected the token: ?token=TOKEN or Authorization: Bearer TOKEN"};
    return std::nullopt;
}

std::string make_token() {
    std::array<unsigned char, 16> bits{};
    if (getrandom(bits.data(), bits.size(), 0) != ssize_t(bits.size()))
        throw Error(ErrorKind::failed, "--http-token: the system gave no random numbers");
    std::string token;
    for (const unsigned char byte : bits) {
        token += "0123456789abcdef"[byte >> 4];
        token += "0123456789abcdef"[byte & 15];
    }
    return token;
}

}  // namespace eventide
