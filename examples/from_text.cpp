// from_text EVENTS.txt OUT: a line "width height", then events "t x y p" (seconds, px, px, 0 or 1)
// -> intensity and sigma of each frame, as rows of float32. With libeventide-core alone:
// find_package(eventide COMPONENTS core).
#include <eventide/error.h>
#include <eventide/reconstructor.h>

#include <cmath>
#include <fstream>
#include <iostream>
#include <string>

int main(int argc, char** argv) try {
    if (argc != 3) throw eventide::Error(eventide::ErrorKind::usage, "from_text EVENTS.txt OUT");
    std::ifstream events(argv[1]);
    int width = 0, height = 0, x = 0, y = 0, p = 0;
    if (!(events >> width >> height))
        throw eventide::Error(
            eventide::ErrorKind::input,
            std::string(argv[1]) + ": expected a line \"width height\", found none");
    eventide::Reconstructor reconstructor("default", width, height,
                                          {.window = "auto",
                                           .lookahead = 2,
                                           .lamp_flicker = "16ms",
                                           .precision = eventide::Precision::f32});
    std::ofstream out(argv[2], std::ios::binary);
    double t = 0;
    while (events) {
        if (events >> t >> x >> y >> p) {
            const eventide::Event event{eventide::from_us(std::llround(1e6 * t)), std::uint16_t(x),
                                        std::uint16_t(y), eventide::Polarity(p > 0)};
            reconstructor.push({&event, 1});
        } else {
            reconstructor.finish();
        }
        for (eventide::Frame frame; reconstructor.next(frame);)
            for (const auto* plane : {&frame.intensity, &frame.sigma})
                out.write(reinterpret_cast<const char*>(plane->values().data()),
                          std::streamsize(plane->values().size_bytes()));
    }
    if (!events.eof())
        throw eventide::Error(eventide::ErrorKind::input,
                              std::string(argv[1]) +
                                  ": expected events \"t x y p\", found a line "
                                  "that is none");
    if (!out.flush()) return std::cerr << argv[2] << ": cannot be written\n", 1;
} catch (const eventide::Error& error) {
    std::cerr << error.what() << '\n';
    return 1;
}
