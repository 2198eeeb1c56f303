// Recordings made for a measurement.
#include "apps/cli/bench/packets_in_memory.h"

#include "drivers/simulated/simulated_camera.h"
#include "src/codec/aedat/aedat3.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace eventide::app {

SimRecordingSettings recording_of(const std::string& scene, const Size& size) {
    SimRecordingSettings settings = parse_simulated_name("sim:" + scene).recording;
    settings.width = size.width;
    settings.height = size.height;
    return settings;
}

std::shared_ptr<const RecordedPackets> simulated_packets(const std::string& scene, const Size& size,
                                                         double seconds) {
    SimulatedSourceSettings settings = parse_simulated_name("sim:" + scene);
    settings.recording = recording_of(scene, size);
    settings.recording.seconds = seconds;
    settings.recording.images_per_second = kImagesPerSecond;
    settings.speed = 0;
    const auto camera = std::make_shared<SimulatedCamera>(settings);
    auto data = std::make_shared<RecordedPackets>();
    data->info = camera->info();
    data->make_parser = [camera] { return camera->make_parser(); };
    for (RawPacket packet; camera->read(packet) == ReadStatus::data;) {
        data->bytes += packet.bytes.size();
        data->packets.push_back(packet.bytes);
    }
    return data;
}

std::shared_ptr<const RecordedPackets> random_packets(const Size& size, double rate,
                                                      double seconds) {
    constexpr std::int64_t kChunkUs = 2000;
    std::minstd_rand random{1};
    Aedat3Writer writer;
    auto data = std::make_shared<RecordedPackets>();
    std::vector<std::byte> bytes;
    StreamHeader header;
    header.format = "aedat3";
    header.width = size.width;
    header.height = size.height;
    writer.begin(header, bytes);
    const Aedat3Header read = read_aedat3_header(bytes);
    const auto in_chunk = std::size_t(std::llround(rate * kChunkUs * 1e-6));
    Batch batch;
    for (std::int64_t begin = 0; begin < std::llround(seconds * 1e6); begin += kChunkUs) {
        batch.clear();
        for (std::size_t i = 0; i < in_chunk; ++i)
            batch.events.push_back(
                {from_us(begin + std::int64_t(i) * kChunkUs / std::int64_t(in_chunk)),
                 std::uint16_t(random() % unsigned(size.width)),
                 std::uint16_t(random() % unsigned(size.height)), Polarity(random() % 2)});
        writer.write(batch, bytes);
        data->bytes += bytes.size();
        data->packets.push_back(std::exchange(bytes, {}));
    }
    data->info.width = size.width;
    data->info.height = size.height;
    data->info.format = "aedat3";
    data->make_parser = [read, size] {
        return std::make_unique<Aedat3Parser>(read, size.width, size.height);
    };
    return data;
}

}  // namespace eventide::app
