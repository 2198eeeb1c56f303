// The C interface: any bytes as events, in batches of any size, with frames, images, instants and
// resets in between.
#include <eventide/eventide.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

namespace {

constexpr int kWidth = 12, kHeight = 9;

eventide_reconstructor* opened() {
    eventide_options options;
    eventide_options_init(&options, sizeof options);
    options.window = "10ms";
    eventide_reconstructor* reconstructor = nullptr;
    if (eventide_reconstructor_open(EVENTIDE_FUZZ_MODEL, kWidth, kHeight, &options,
                                    &reconstructor) != EVENTIDE_OK)
        std::abort();
    return reconstructor;
}

/// Some size and place in and beside the sensor, at some time before or after.
void push_image(eventide_reconstructor* reconstructor, std::int64_t t, const std::uint8_t* bytes) {
    constexpr int kMost = 15;
    std::uint16_t pixels[kMost * kMost];
    for (std::size_t i = 0; i < kMost * kMost; ++i)
        pixels[i] = std::uint16_t(bytes[i % 4] * (i + 1));
    const eventide_image image{.t = t + 100 * std::int8_t(bytes[0]),
                               .exposure_begin = t - 50 * std::int8_t(bytes[1]),
                               .exposure_end = t,
                               .x = std::int8_t(bytes[1]) / 8,
                               .y = std::int8_t(bytes[2]) / 8,
                               .width = bytes[3] % (kMost + 1),
                               .height = bytes[0] % (kMost + 1),
                               .pixels = pixels};
    eventide_push_image(reconstructor, &image);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static eventide_reconstructor* const reconstructor = opened();
    eventide_reset(reconstructor);
    eventide_frame frame;
    std::vector<eventide_event> events;
    std::int64_t t = 0;
    int frames = 0;
    for (std::size_t at = 0; at + 4 <= size && frames < 50; at += 4) {
        std::int16_t step = 0;
        std::memcpy(&step, data + at, 2);
        t += step;
        events.push_back({t, std::uint16_t(data[at + 2] % 16), std::uint16_t(data[at + 3] % 16),
                          std::uint8_t(data[at + 3] >> 7)});
        if (data[at + 2] < 0xE0) continue;
        eventide_push(reconstructor, events.data(), events.size());
        events.clear();
        switch (data[at + 2] % 8) {
            case 0:
                eventide_mark_gap(reconstructor);
                break;
            case 1:
                eventide_advance(reconstructor, t + 20'000);
                break;
            case 2:
                eventide_render(reconstructor, t - 5'000, nullptr, &frame);
                break;
            case 3:
                eventide_finish(reconstructor, nullptr);
                break;
            case 4:
                push_image(reconstructor, t, data + at);
                break;
            default:
                break;
        }
        while (frames < 50 && eventide_next(reconstructor, &frame) == EVENTIDE_OK) ++frames;
    }
    return 0;
}
