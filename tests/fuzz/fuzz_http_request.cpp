// Any bytes as the head of a request and its body: what is let through keeps to the rules, and a
// change is of a control that can be changed, in its range.
#include "pipeline/sinks/http/control.h"
#include "pipeline/sinks/http/http_address.h"
#include "pipeline/sinks/http/request_guard.h"
#include "src/core/error.h"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

namespace {

using namespace eventide;

/// Up to the next line's end, which is taken away.
std::string line_of(std::string_view& text) {
    const std::size_t end = text.find('\n');
    const std::string line{text.substr(0, end)};
    text.remove_prefix(end == text.npos ? text.size() : end + 1);
    return line;
}

void require(bool holds) {
    if (!holds) std::abort();
}

void judge_head(std::string_view& text) {
    RequestHead head;
    for (std::string* field :
         {&head.method, &head.path, &head.host, &head.origin, &head.fetch_site, &head.content_type,
          &head.content_encoding, &head.authorization, &head.token})
        *field = line_of(text);
    head.hosts = 1;
    head.has_length = true;
    const GuardSettings open{"", {"camera.example"}}, closed{"secret", {"camera.example"}};
    const auto refusal = judge(head, open);
    if (!refusal) {
        require(head.method == "GET" || head.method == "HEAD" || head.method == "POST");
        const std::string name = host_name(head.host);
        require(name == "camera.example" || name == "localhost" ||
                name.find_first_not_of("0123456789abcdef:.") == name.npos);
        require(head.origin.empty() || head.origin.size() > head.host.size());
    }
    if (!judge(head, closed)) {
        require(!refusal);
        require(head.token == "secret" || head.authorization.ends_with("secret") ||
                head.path.starts_with("/page."));
    }
    RequestHead two = head;
    two.hosts = 2;
    require(judge(two, open).has_value());
}

void change_controls(std::string_view body) {
    static const std::vector<HttpControl> controls{
        {"fps", "", "", 1, 1000, 1, [] { return 30.0; }, [](double) {}},
        {"scale", "", "", 0.25, 4, 0.25, [] { return 1.0; }, [](double) {}},
        {"window", "", "", 0, 1, 1, {}, {}, "fixed", "50ms"}};
    try {
        for (const auto& [control, value] : parse_changes(body, controls)) {
            require(bool(control->set));
            require(std::isfinite(value) && value >= control->least && value <= control->most);
        }
    } catch (const Error& error) {
        require(error.kind() == ErrorKind::usage);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::string_view text{reinterpret_cast<const char*>(data), size};
    judge_head(text);
    change_controls(text);
    try {
        const HttpAddress address = parse_http_address(text);
        require(address.port >= 0 && address.port <= 65535);
        is_loopback(address.host);
    } catch (const Error&) {
    }
    return 0;
}
