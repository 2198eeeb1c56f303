// reconstruct RECORDING OUT: intensity and sigma of each frame, as rows of float32.
#include <eventide/eventide.hpp>

#include <fstream>
#include <iostream>

int main(int argc, char** argv) try {
    if (argc != 3) throw eventide::Error(eventide::ErrorKind::usage, "reconstruct RECORDING OUT");
    eventide::EventReader reader(argv[1]);
    eventide::Reconstructor reconstructor("default", reader.width(), reader.height(),
                                          {.window = "auto",
                                           .lookahead = 2,
                                           .lamp_flicker = "16ms",
                                           .precision = eventide::Precision::f32});
    std::ofstream out(argv[2], std::ios::binary);
    for (eventide::Frame frame; eventide::read_frame(reader, reconstructor, frame);)
        for (const auto* plane : {&frame.intensity, &frame.sigma})
            out.write(reinterpret_cast<const char*>(plane->values().data()),
                      std::streamsize(plane->values().size_bytes()));
    if (!out.flush()) return std::cerr << argv[2] << ": cannot be written\n", 1;
} catch (const eventide::Error& error) {
    return std::cerr << error.what() << '\n', 1;
}
