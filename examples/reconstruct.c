/* reconstruct RECORDING OUT: intensity and sigma of each frame, as rows of float32. */
#include <eventide/eventide.h>
#include <stdio.h>

int main(int argc, char** argv) {
    eventide_source* source = NULL;
    eventide_reconstructor* network = NULL;
    eventide_options options;
    eventide_frame frame;
    int64_t end;
    FILE* out = argc == 3 ? fopen(argv[2], "wb") : NULL;
    if (out == NULL) return fprintf(stderr, "reconstruct RECORDING OUT\n"), 1;
    eventide_options_init(&options, sizeof options);
    options.window = "auto", options.lookahead = 2, options.precision = "f32";
    eventide_status status = eventide_recording_open(argv[1], NULL, 0, 0, &source), next;
    if (status == EVENTIDE_OK)
        status = eventide_reconstructor_open("default", eventide_source_width(source),
                                             eventide_source_height(source), &options, &network);
    while (status == EVENTIDE_OK) {
        status = eventide_read_into(source, network);
        if (status == EVENTIDE_NONE && eventide_source_clock(source, &end) == EVENTIDE_OK)
            eventide_finish(network, &end);
        while ((next = eventide_next(network, &frame)) == EVENTIDE_OK) {
            fwrite(frame.intensity, sizeof(float) * (size_t)frame.width, (size_t)frame.height, out);
            fwrite(frame.sigma, sizeof(float) * (size_t)frame.width, (size_t)frame.height, out);
        }
        if (next != EVENTIDE_NONE) status = next;
    }
    if (status != EVENTIDE_NONE) fprintf(stderr, "%s\n", eventide_error_message());
    return status == EVENTIDE_NONE && fclose(out) == 0 ? 0 : 1;
}
