// The network at work, for C.
#include "library/c_call.h"
#include "library/c_handles.h"
#include "src/core/arithmetic_words.h"
#include "src/core/sensor_limits.h"

#include <algorithm>
#include <cstring>
#include <memory>

using namespace eventide;

namespace {

FrameSize size_of(const eventide_frame_size& size) {
    const eventide_region& r = size.region;
    return {size.width, size.height, {r.x, r.y, r.width, r.height}};
}

eventide_options whole_options(const eventide_options* options) {
    eventide_options defaults;
    eventide_options_init(&defaults, sizeof defaults);
    return filled_in(defaults, options, "options", ", set by eventide_options_init()");
}

ReconstructorOptions options_of(const eventide_options* given_options) {
    const eventide_options c = whole_options(given_options);
    ReconstructorOptions options;
    options.window = &given(c.window, "options.window");
    options.lookahead = c.lookahead;
    options.fps = &given(c.fps, "options.fps");
    options.size = size_of(c.size);
    options.sigma = c.sigma != 0;
    options.hot_pixels = &given(c.hot_pixels, "options.hot_pixels");
    options.precision =
        option_word("precision", &given(c.precision, "options.precision"), kPrecisionWords);
    options.kernels = option_word("kernels", &given(c.kernels, "options.kernels"), kKernelWords);
    options.threads = c.threads;
    options.reset_on_gap = c.reset_on_gap != 0;
    options.allow_silence = c.allow_silence != 0;
    options.noise_filter = &given(c.noise_filter, "options.noise_filter");
    options.images = c.images != 0;
    options.lamp_flicker = &given(c.lamp_flicker, "options.lamp_flicker");
    options.self_ensemble = c.self_ensemble;
    return options;
}

ReferenceImage image_of(const eventide_image& image) {
    const auto is_side = [](int side) { return side >= 1 && side <= kLargestSensorSide; };
    if (!is_side(image.width) || !is_side(image.height))
        throw Error(ErrorKind::usage, "image: expected 1 to " + std::to_string(kLargestSensorSide) +
                                          " px each way, found " + std::to_string(image.width) +
                                          "x" + std::to_string(image.height));
    ReferenceImage made;
    made.t = from_us(image.t);
    made.exposure_begin = from_us(image.exposure_begin);
    made.exposure_end = from_us(image.exposure_end);
    made.x0 = image.x;
    made.y0 = image.y;
    made.pixels = {image.height, image.width};
    std::copy_n(&given(image.pixels, "pixels of an image"), made.pixels.values().size(),
                made.pixels.values().begin());
    return made;
}

Reconstructor& it(eventide_reconstructor* reconstructor) {
    return given(reconstructor, "a reconstructor").it;
}

}  // namespace

extern "C" {

void eventide_options_init(eventide_options* options, size_t struct_size) {
    if (options == nullptr) return;
    const eventide_options defaults{.struct_size = sizeof(eventide_options),
                                    .window = "model",
                                    .lookahead = 0,
                                    .fps = "30",
                                    .size = {},
                                    .sigma = 1,
                                    .hot_pixels = "off",
                                    .precision = "auto",
                                    .kernels = "auto",
                                    .threads = 0,
                                    .reset_on_gap = 0,
                                    .allow_silence = 0,
                                    .noise_filter = "model",
                                    .images = 1,
                                    .lamp_flicker = "auto",
                                    .self_ensemble = 1};
    std::memcpy(options, &defaults, std::min(struct_size, sizeof defaults));
    if (struct_size >= sizeof options->struct_size) options->struct_size = struct_size;
}

eventide_status eventide_reconstructor_open(const char* model, int width, int height,
                                            const eventide_options* options,
                                            eventide_reconstructor** opened) {
    return c_call([&] {
        given(opened, "a place for the reconstructor") = nullptr;
        auto made = std::make_unique<eventide_reconstructor>(eventide_reconstructor{
            Reconstructor{&given(model, "a model"), width, height, options_of(options)}});
        *opened = made.release();
        return EVENTIDE_OK;
    });
}

void eventide_reconstructor_close(eventide_reconstructor* reconstructor) {
    delete reconstructor;
}

eventide_status eventide_push(eventide_reconstructor* reconstructor, const eventide_event* events,
                              size_t count) {
    return c_call([&] {
        Reconstructor& into = it(reconstructor);
        into.push(events_of(events, count, reconstructor->events));
        return EVENTIDE_OK;
    });
}

eventide_status eventide_push_image(eventide_reconstructor* reconstructor,
                                    const eventide_image* image) {
    return c_call([&] {
        Batch batch;
        batch.images.push_back(image_of(given(image, "an image")));
        it(reconstructor).push(batch);
        return EVENTIDE_OK;
    });
}

eventide_status eventide_advance(eventide_reconstructor* reconstructor, int64_t now) {
    return c_call([&] {
        it(reconstructor).advance(from_us(now));
        return EVENTIDE_OK;
    });
}

eventide_status eventide_mark_gap(eventide_reconstructor* reconstructor) {
    return c_call([&] {
        it(reconstructor).mark_gap();
        return EVENTIDE_OK;
    });
}

eventide_status eventide_finish(eventide_reconstructor* reconstructor, const int64_t* end) {
    return c_call([&] {
        it(reconstructor).finish(end == nullptr ? std::nullopt : std::optional{from_us(*end)});
        return EVENTIDE_OK;
    });
}

eventide_status eventide_next(eventide_reconstructor* reconstructor, eventide_frame* frame) {
    return c_call([&] {
        Reconstructor& from = it(reconstructor);
        eventide_frame& into = given(frame, "a frame");
        if (!from.next(reconstructor->frame)) return EVENTIDE_NONE;
        return show_frame(*reconstructor, into);
    });
}

eventide_status eventide_ready(eventide_reconstructor* reconstructor, int64_t t) {
    return c_call(
        [&] { return it(reconstructor).ready(from_us(t)) ? EVENTIDE_OK : EVENTIDE_NONE; });
}

eventide_status eventide_newest(eventide_reconstructor* reconstructor, int64_t* t) {
    return c_call([&] {
        const auto newest = it(reconstructor).newest();
        int64_t& into = given(t, "a place for the time");
        if (!newest) return EVENTIDE_NONE;
        into = to_us(*newest);
        return EVENTIDE_OK;
    });
}

eventide_status eventide_render(eventide_reconstructor* reconstructor, int64_t t,
                                const eventide_frame_size* size, eventide_frame* frame) {
    return c_call([&] {
        Reconstructor& from = it(reconstructor);
        eventide_frame& into = given(frame, "a frame");
        if (size == nullptr)
            from.render(from_us(t), reconstructor->frame);
        else
            from.render(from_us(t), size_of(*size), reconstructor->frame);
        return show_frame(*reconstructor, into);
    });
}

eventide_status eventide_reset(eventide_reconstructor* reconstructor) {
    return c_call([&] {
        it(reconstructor).reset();
        return EVENTIDE_OK;
    });
}

eventide_status eventide_state(eventide_reconstructor* reconstructor, const void** bytes,
                               size_t* size) {
    return c_call([&] {
        std::vector<std::byte>& state = given(reconstructor, "a reconstructor").state;
        const void*& at = given(bytes, "a place for the state");
        given(size, "a place for the number of bytes") = 0;
        state = reconstructor->it.state();
        at = state.data();
        *size = state.size();
        return EVENTIDE_OK;
    });
}

eventide_status eventide_restore(eventide_reconstructor* reconstructor, const void* bytes,
                                 size_t size) {
    return c_call([&] {
        it(reconstructor).restore({&given(static_cast<const std::byte*>(bytes), "a state"), size});
        return EVENTIDE_OK;
    });
}

eventide_status eventide_save_state(eventide_reconstructor* reconstructor, const char* file,
                                    int overwrite) {
    return c_call([&] {
        it(reconstructor).save_state(&given(file, "a file's name"), overwrite != 0);
        return EVENTIDE_OK;
    });
}

eventide_status eventide_restore_state(eventide_reconstructor* reconstructor, const char* file) {
    return c_call([&] {
        it(reconstructor).restore_state(&given(file, "a file's name"));
        return EVENTIDE_OK;
    });
}

eventide_status eventide_count(const eventide_reconstructor* reconstructor,
                               eventide_counters* counters) {
    return c_call([&] {
        const ReconstructorCounters c = given(reconstructor, "a reconstructor").it.counters();
        given(counters, "counters") = {.events = c.events,
                                       .off_sensor = c.off_sensor,
                                       .time_backwards = c.time_backwards,
                                       .bad_time = c.bad_time,
                                       .filtered = c.filtered,
                                       .late = c.late,
                                       .left_out = c.left_out,
                                       .time_resets = c.time_resets,
                                       .event_windows = c.event_windows,
                                       .frames = c.frames,
                                       .used_images = c.used_images,
                                       .dropped_images = c.dropped_images};
        return EVENTIDE_OK;
    });
}
}
