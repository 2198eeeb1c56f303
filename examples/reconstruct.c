/* reconstruct RECORDING OUT: intensity and sigma of each frame, as rows of float32. */
#include <eventide/eventide.h>
#include <stdio.h>
#include <stdlib.h>

static eventide_status check(eventide_status status) {
    if (status == EVENTIDE_OK || status == EVENTIDE_NONE) return status;
    fprintf(stderr, "%s\n", eventide_error_message());
    exit(1);
}

int main(int argc, char** argv) {
    eventide_source* source = NULL;
    eventide_reconstructor* reconstructor = NULL;
    eventide_options options;
    eventide_frame frame;
    eventide_status status = EVENTIDE_OK;
    FILE* out = argc == 3 ? fopen(argv[2], "wb") : NULL;
    if (out == NULL) return fprintf(stderr, "reconstruct RECORDING OUT\n"), 1;
    check(eventide_recording_open(argv[1], NULL, 0, 0, &source));
    eventide_options_init(&options, sizeof options);
    options.window = "auto";
    options.lookahead = 2;
    options.precision = "f32";
    check(eventide_reconstructor_open("default", eventide_source_width(source),
                                      eventide_source_height(source), &options, &reconstructor));
    while (status != EVENTIDE_NONE) {
        int64_t end;
        status = check(eventide_read_into(source, reconstructor));
        if (status == EVENTIDE_NONE && check(eventide_source_clock(source, &end)) == EVENTIDE_OK)
            check(eventide_finish(reconstructor, &end));
        while (check(eventide_next(reconstructor, &frame)) == EVENTIDE_OK) {
            const size_t pixels = (size_t)frame.width * (size_t)frame.height;
            fwrite(frame.intensity, sizeof(float), pixels, out);
            fwrite(frame.sigma, sizeof(float), pixels, out);
        }
    }
    eventide_reconstructor_close(reconstructor);
    eventide_source_close(source);
    return fclose(out) == 0 ? 0 : 1;
}
