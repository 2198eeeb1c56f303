// Not a test: ros2-throughput FPS SECONDS [WIDTH HEIGHT [KEYS [FASTDDS_PEER]]] publishes frames of
// random numbers with --out ros2:'s sink to a subscriber in a process of its own, of Cyclone DDS or
// that of Fast DDS which is named, and tells what was lost and how long it took.
#include "pipeline/ros2/ros2_sink.h"
#include "tests/ros2/topics.h"
#include "tests/system/process.h"

#include <signal.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <thread>
#include <vector>

namespace {

using namespace eventide;
using namespace std::chrono;

std::int64_t system_us() {
    return duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
}

void print_times(const char* what, std::vector<double>& ms) {
    if (ms.empty()) return;
    std::ranges::sort(ms);
    const auto part = [&](double share) { return ms[std::size_t(share * double(ms.size() - 1))]; };
    std::printf("%s: p50 %.2f  p99 %.2f  max %.2f ms\n", what, part(0.5), part(0.99), ms.back());
}

struct Seen {
    std::atomic<std::size_t> images = 0;
    std::vector<double> late_ms;
};

/// Until the subscriber is told to go.
void read_all(test::Process& subscriber, Seen& seen) {
    while (true) {
        const std::string line = subscriber.read_output(test::kLineBytes);
        if (line.size() < test::kLineBytes) return;
        if (line[0] == '-') continue;
        ++seen.images;
        seen.late_ms.push_back(double(system_us() - std::stoll(line, nullptr, 16)) / 1000);
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3) {
        std::fprintf(stderr, "ros2-throughput FPS SECONDS [WIDTH HEIGHT [KEYS [FASTDDS_PEER]]]\n");
        return 2;
    }
    const double fps = std::atof(argv[1]), length = std::atof(argv[2]);
    const int width = argc > 4 ? std::atoi(argv[3]) : 640,
              height = argc > 4 ? std::atoi(argv[4]) : 480;
    const std::string name = test::own_name("/throughput");
    Ros2SinkSettings settings;
    settings.name = parse_ros2_sink_name(
        name + "?subscribers=1" + (argc > 5 && *argv[5] != 0 ? std::string{"&"} + argv[5] : ""));
    settings.with_sigma = false;
    settings.warn = [](const std::string& text) { std::printf("%s\n", text.c_str()); };
    const auto sink = open_ros2_sink(std::move(settings));
    const std::string topic = name + "/image_raw";
    test::Process subscriber{
        argc > 6 ? std::vector<std::string>{argv[6], "listen", topic, "reliable"}
                 : std::vector<std::string>{EVENTIDE_ROS2_LISTENER, topic, "image", "reliable"},
        {.output_to_pipe = true}};
    Seen seen;
    std::jthread reading{[&] { read_all(subscriber, seen); }};

    Frame frame;
    frame.intensity = Array2<float>{height, width};
    std::mt19937 random{1};
    for (float& value : frame.intensity.values()) value = float(random() % 256) / 255;
    const auto frames = std::size_t(fps * length);
    std::vector<double> write_ms;
    const auto begun = steady_clock::now();
    for (std::size_t k = 0; k < frames; ++k) {
        std::this_thread::sleep_until(
            begun + duration_cast<steady_clock::duration>(duration<double>(double(k) / fps)));
        frame.t = from_us(system_us());
        frame.window = {frame.t, frame.t};
        frame.intensity.values()[k % frame.intensity.values().size()] = 0.5F;
        const auto before = steady_clock::now();
        sink->write(frame);
        if (k > 0)
            write_ms.push_back(duration<double, std::milli>(steady_clock::now() - before).count());
    }
    const double took = duration<double>(steady_clock::now() - begun).count();
    sink->close();
    for (int waits = 0; waits < 500 && seen.images < frames; ++waits)
        std::this_thread::sleep_for(10ms);
    subscriber.signal(SIGTERM);
    reading.join();
    std::printf("%zu images of %dx%d in %.1f s: lost %zu\n", frames, width, height, took,
                frames - seen.images.load());
    print_times("write", write_ms);
    print_times("until the subscriber had read it", seen.late_ms);
    return seen.images == frames ? 0 : 1;
}
