// Part of every test program here, and of the programs they start: a DDS domain on loopback,
// without multicast, that tests running beside this one hardly share; topics carry the process's
// number besides.
#include <stdlib.h>
#include <unistd.h>

#include <string>

namespace {

/// As with the temporary folder: a child has its parent's.
constexpr const char* kOwner = "TEST_DOMAIN_OF";

const bool done = [] {
    if (getenv(kOwner) != nullptr) return true;
    setenv(kOwner, std::to_string(getpid()).c_str(), 1);
    setenv("ROS_DOMAIN_ID", std::to_string(1 + getpid() % 97).c_str(), 1);
    setenv("CYCLONEDDS_URI",
           "<CycloneDDS><Domain><General><Interfaces><NetworkInterface "
           "address=\"127.0.0.1\"/></Interfaces>"
           "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</"
           "ParticipantIndex>"
           "<MaxAutoParticipantIndex>60</MaxAutoParticipantIndex><Peers><Peer "
           "address=\"127.0.0.1\"/></Peers>"
           "</Discovery><Tracing><Category>error</Category>"
           "<OutputFile>/dev/null</OutputFile></Tracing></Domain></CycloneDDS>",
           1);
    for (const char* name :
         {"ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_STATIC_PEERS"})
        unsetenv(name);
    return true;
}();

}  // namespace

/// So that a linker takes this file out of its library.
extern "C" bool eventide_own_domain() {
    return done;
}
