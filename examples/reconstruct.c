/* reconstruct RECORDING OUT: intensity and sigma of each frame, as rows of float32. */
#include <eventide/eventide.h>
#include <stdio.h>

int main(int argc, char** argv) {
    eventide_source* source;
    eventide_reconstructor* network;
    eventide_options options;
    eventide_frame frame;
    if (argc != 3) return fputs("reconstruct RECORDING OUT\n", stderr), 1;
    eventide_options_init(&options, sizeof options), options.precision = "f32";
    options.window = "auto", options.lookahead = 2, options.lamp_flicker = "16ms";
    eventide_status status = eventide_recording_open(argv[1], NULL, 0, 0, &source);
    if (!status) status = eventide_reconstructor_open_for(source, "default", &options, &network);
    /* Not before: what OUT holds stays where RECORDING is none. */
    FILE* out = status ? NULL : fopen(argv[2], "wb");
    while (out && !(status = eventide_read_frame(source, network, &frame)))
        fwrite(frame.intensity, sizeof(float) * (size_t)frame.width, (size_t)frame.height, out),
            fwrite(frame.sigma, sizeof(float) * (size_t)frame.width, (size_t)frame.height, out);
    if (status && status != EVENTIDE_NONE)
        return fprintf(stderr, "%s\n", eventide_error_message()), 1;
    return out == NULL || fflush(out) || ferror(out) ? perror(argv[2]), 1 : 0;
}
