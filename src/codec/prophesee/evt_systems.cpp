// The table of OpenEB's psee_raw_file_header.cpp and device_system_id.h.
#include "src/codec/prophesee/evt_systems.h"

#include <algorithm>
#include <array>

namespace eventide {
namespace {

constexpr std::array kSystems{
    EvtSystem{0x15, "Gen3.0", "evt2", 640, 480},
    EvtSystem{0x17, "Gen3.0", "evt2", 640, 480},
    EvtSystem{0x19, "Gen3.0", "evt2", 640, 480},
    EvtSystem{0x1A, "Gen4.0", "evt2", 1280, 720},
    EvtSystem{0x1C, "Gen3.1", "evt2", 640, 480},
    EvtSystem{0x1D, "Gen3.0", "evt2", 640, 480},
    EvtSystem{0x1E, "Gen4.0", "evt3", 1280, 720},
    EvtSystem{0x1F, "Gen4.0", "evt2", 1280, 720},
    EvtSystem{0x21, "Gen3.0", "evt2", 640, 480},
    EvtSystem{0x22, "Gen3.1", "evt2", 640, 480},
    EvtSystem{0x23, "Gen3.1", "evt2", 640, 480},
    EvtSystem{0x27, "Gen4.1", "evt2", 1280, 720},
    EvtSystem{0x28, "Gen3.1", "evt3", 640, 480},
    EvtSystem{0x29, "Gen3.1", "evt2", 640, 480},
    EvtSystem{0x2E, "Gen4.0", "evt3", 1280, 720},
    EvtSystem{0x30, "Gen4.1", "evt3", 1280, 720},
    EvtSystem{0x31, "IMX636", "evt3", 1280, 720},
    EvtSystem{0x32, "IMX636", "evt3", 1280, 720},
    // With 0x80: behind a proxy.
    EvtSystem{0x97, "Gen3.0", "evt2", 640, 480},
    EvtSystem{0x99, "Gen3.0", "evt2", 640, 480},
    EvtSystem{0xA1, "Gen3.0", "evt2", 640, 480},
    EvtSystem{0xA2, "Gen3.1", "evt2", 640, 480},
};

}  // namespace

const EvtSystem* find_evt_system(int number) {
    const auto found = std::ranges::find(kSystems, number, &EvtSystem::number);
    return found == kSystems.end() ? nullptr : &*found;
}

}  // namespace eventide
