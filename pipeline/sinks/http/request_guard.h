// Who may ask: judged from a request's head alone, before anything is done.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace eventide {

struct GuardSettings {
    std::string token = {};               ///< empty: nobody is asked for one
    std::vector<std::string> names = {};  ///< of this host or its proxy, beside addresses and
                                          ///< localhost
};

/// What of a request is judged; empty where it did not say.
struct RequestHead {
    std::string method, path;
    std::size_t hosts = 0;    ///< number of Host headers
    bool has_length = false;  ///< of its body, or that it comes in chunks
    std::string host, origin, fetch_site, content_type, content_encoding, authorization;
    std::string token;  ///< of the query
};

struct Refusal {
    int status = 403;
    std::string words;  ///< one line for whoever asked
};

/// Empty: the request may go on. In this order:
///
/// - only GET, HEAD and POST are known (405);
/// - exactly one Host, and it is an address, localhost or one of the names (421): a page of another
///   site that had its own name point here (DNS rebinding) says that name;
/// - an Origin is the host itself, and a browser that tells where a request comes from (Sec-Fetch-
///   Site) does not say another site, unless somebody followed a link to the page (403);
/// - a POST is JSON (415), which other sites cannot send without asking first, and nobody answers;
///   it says how long it is (411), as nobody waits for an end; and it is not packed (415): a few
///   hundred bytes could become a gigabyte;
/// - the token, where there is one, as "Authorization: Bearer" or in the query (401). The page's
///   script and style need none.
std::optional<Refusal> judge(const RequestHead& request, const GuardSettings& settings);

/// The name in `host`, which is "name", "name:port" or "[::1]:port", in lower case; empty where it
/// is none of these.
std::string host_name(std::string_view host);

/// 128 random bits as 32 digits. Throws Error (failed).
std::string make_token();

}  // namespace eventide
