// The C interface: any bytes as events, in batches of any size, with frames, instants and resets in
// between.
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
            default:
                break;
        }
        while (frames < 50 && eventide_next(reconstructor, &frame) == EVENTIDE_OK) ++frames;
    }
    return 0;
}
