// What ROS 2 and Cyclone DDS take from the environment.
#include "pipeline/ros2/environment.h"

#include "src/core/error.h"
#include "src/core/number_text.h"

#include <unistd.h>

#include <string_view>

namespace eventide {

namespace {

using Variable = std::function<const char*(const char*)>;

/// The most that leaves room for the ports of a participant (RTPS 2.3, 9.6.1.1).
constexpr unsigned kLargestDomain = 232;

// A frame leaves as one burst of few large datagrams; with the usual fragments of 1.3 kB a reader
// with a small socket buffer loses more of it. The receive buffer is a wish: the system grants what
// net.core.rmem_max allows.
constexpr std::string_view kOwnConfig =
    "<CycloneDDS><Domain><General><MaxMessageSize>65500B</MaxMessageSize>"
    "<FragmentSize>65000B</FragmentSize></General>"
    "<Internal><SocketReceiveBufferSize max=\"4MB\"/></Internal></Domain></CycloneDDS>";

// As rmw_cyclonedds_cpp has it, and for machines whose loopback has no multicast: participants
// have ports that can be guessed, and ask each other there.
constexpr std::string_view kLocalhostConfig =
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address=\"127.0.0.1\"/>"
    "</Interfaces></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
    "<Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery></Domain></CycloneDDS>";

[[noreturn]] void refuse(const std::string& name, const std::string& expected,
                         const std::string& found) {
    throw Error(ErrorKind::usage, name + ": expected " + expected + ", found '" + found + "'");
}

std::string text_of(const Variable& variable, const char* name) {
    const char* value = variable(name);
    return value == nullptr ? std::string{} : std::string{value};
}

unsigned domain_of(const std::string& text) {
    if (text.empty()) return 0;
    const auto domain = number_in<unsigned>(text);
    if (!domain || *domain > kLargestDomain)
        refuse("ROS_DOMAIN_ID", "0 to " + std::to_string(kLargestDomain), text);
    return *domain;
}

std::string escaped(std::string_view text) {
    std::string safe;
    for (const char c : text) switch (c) {
            case '<':
                safe += "&lt;";
                break;
            case '&':
                safe += "&amp;";
                break;
            case '"':
                safe += "&quot;";
                break;
            default:
                safe += c;
        }
    return safe;
}

/// Names or addresses, with semicolons between them.
std::string peers_config(const std::string& peers) {
    std::string list;
    for (std::size_t begin = 0; begin < peers.size();) {
        const std::size_t end = std::min(peers.find(';', begin), peers.size());
        if (end > begin)
            list += "<Peer address=\"" + escaped(peers.substr(begin, end - begin)) + "\"/>";
        begin = end + 1;
    }
    if (list.empty()) return {};
    return "<CycloneDDS><Domain><Discovery><Peers>" + list +
           "</Peers></Discovery></Domain></CycloneDDS>";
}

/// Nobody else has this tag.
std::string alone_config() {
    return "<CycloneDDS><Domain><Discovery><Tag>eventide" + std::to_string(getpid()) +
           "</Tag></Discovery></Domain></CycloneDDS>";
}

/// ROS_LOCALHOST_ONLY wins where it is set, as in ROS.
std::string range_config(const std::string& localhost_only, const std::string& range) {
    if (localhost_only == "1") return std::string{kLocalhostConfig};
    if (!localhost_only.empty() && localhost_only != "0")
        refuse("ROS_LOCALHOST_ONLY", "0 or 1", localhost_only);
    if (range == "LOCALHOST") return std::string{kLocalhostConfig};
    if (range == "OFF") return alone_config();
    if (range.empty() || range == "SUBNET" || range == "SYSTEM_DEFAULT") return {};
    refuse("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT", range);
}

}  // namespace

Ros2Environment ros2_environment(const Variable& variable) {
    Ros2Environment environment;
    environment.domain = domain_of(text_of(variable, "ROS_DOMAIN_ID"));
    environment.config = kOwnConfig;
    environment.configured = !text_of(variable, "CYCLONEDDS_URI").empty();
    for (const std::string& more :
         {range_config(text_of(variable, "ROS_LOCALHOST_ONLY"),
                       text_of(variable, "ROS_AUTOMATIC_DISCOVERY_RANGE")),
          peers_config(text_of(variable, "ROS_STATIC_PEERS")), text_of(variable, "CYCLONEDDS_URI")})
        if (!more.empty()) environment.config += "," + more;
    return environment;
}

}  // namespace eventide
