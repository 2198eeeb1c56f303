// davis-throughput [EVENTS_PER_SECOND [SECONDS [TRANSFERS KIB]]]: whether the driver keeps up with
// a camera, and what that costs.
//
// The real driver and the real libusb fetch from a DAVIS346 in software which sends in real time
// and drops what nobody fetched in time. Every event that arrives is compared with the one that was
// sent.
#include "drivers/usb/davis_camera.h"
#include "src/core/error.h"
#include "tests/support/preload.h"
#include "tests/support/usb/davis_fire_hose.h"
#include "tests/support/usb/usb_testbed.h"

#include <time.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>

namespace eventide {
namespace {

using testing_support::DavisFireHose;
using testing_support::FireHoseSettings;
using testing_support::UsbTestbed;

SensorTime real_time() {
    return SensorTime{std::chrono::duration_cast<SensorDuration>(
        std::chrono::steady_clock::now().time_since_epoch())};
}

unsigned long long as_number(std::uint64_t n) {
    return n;
}

double processor_seconds() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return double(time.tv_sec) + double(time.tv_nsec) * 1e-9;
}

struct Outcome {
    std::uint64_t events = 0, wrong = 0;
    double read = 0, parse = 0;     ///< processor time of the driver's thread, s
    SensorDuration longest_away{};  ///< of this thread, between two reads
};

Outcome fetch(DavisCamera& camera, const DavisFireHose& hose, SensorDuration time) {
    Outcome outcome;
    const auto parser = camera.make_parser();
    Batch batch;
    RawPacket packet;
    SensorTime last = real_time();
    for (const SensorTime end = last + time; last < end;) {
        const double begun = processor_seconds();
        const ReadStatus status = camera.read(packet);
        const double fetched = processor_seconds();
        outcome.read += fetched - begun;
        outcome.longest_away = std::max(outcome.longest_away, real_time() - last);
        last = real_time();
        if (status != ReadStatus::data) continue;
        batch.clear();
        parser->parse(packet.bytes, batch);
        outcome.parse += processor_seconds() - fetched;
        for (const Event& event : batch.events)
            outcome.wrong += event == hose.event(outcome.events++) ? 0 : 1;
    }
    return outcome;
}

int run(double events_per_second, double seconds, int transfers, std::size_t kib) {
    FireHoseSettings settings;
    settings.events_per_us = std::max(1, int(events_per_second / 1e6));
    settings.buffer_bytes = std::size_t(transfers) * (kib << 10);
    settings.now = real_time;
    const auto hose = std::make_shared<DavisFireHose>(settings);
    UsbTestbed bed;
    bed.plug_in(hose);
    DavisOptions options;
    options.settings.transfers = {transfers, kib << 10};
    options.settings.imu = options.settings.frames = false;
    DavisCamera camera{options};
    const Outcome outcome = fetch(camera, *hose, SensorDuration{std::int64_t(seconds * 1e6)});
    std::uint64_t lost = 0;
    bed.look([&] { lost = hose->dropped(); });
    std::printf(
        "%d million events/s for %.0f s through %d transfers of %zu KiB: %llu arrived, %llu not as "
        "sent, %llu lost; longest pause between two reads %.1f ms\n"
        "processor time of the driver's thread: fetching %.2f s (%.1f %% of one core), parsing "
        "%.2f "
        "s (%.1f %%, %.0f million events/s)\n",
        settings.events_per_us, seconds, transfers, kib, as_number(outcome.events),
        as_number(lost == 0 ? outcome.wrong : 0), as_number(lost),
        double(outcome.longest_away.count()) / 1000, outcome.read, 100 * outcome.read / seconds,
        outcome.parse, 100 * outcome.parse / seconds,
        double(outcome.events) * 1e-6 / outcome.parse);
    return lost == 0 && outcome.wrong == 0 ? 0 : 1;
}

}  // namespace
}  // namespace eventide

int main(int argc, char** argv) {
    const auto number = [&](int i, double otherwise) {
        return argc > i ? std::strtod(argv[i], nullptr) : otherwise;
    };
    eventide::testing_support::enter_testbed(argv);
    try {
        return eventide::run(number(1, 12e6), number(2, 60), int(number(3, 16)),
                             std::size_t(number(4, 64)));
    } catch (const eventide::Error& error) {
        std::fprintf(stderr, "davis-throughput: %s\n", error.what());
        return int(error.kind());
    }
}
