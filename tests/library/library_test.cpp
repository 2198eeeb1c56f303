// The library as a program uses it.
#include "tests/library/library_test.h"

namespace eventide::test {

ReconstructorOptions LibraryTest::repeatable(const std::string& window, int lookahead) {
    ReconstructorOptions options;
    options.window = window;
    options.lookahead = lookahead;
    options.fps = "100";
    options.precision = Precision::f32;
    options.kernels = Kernels::own;
    options.threads = 1;
    return options;
}

std::vector<std::string> LibraryTest::repeatable_arguments(const std::string& window, int lookahead,
                                                           bool images) {
    return {"--window",    window,
            "--lookahead", std::to_string(lookahead),
            "--fps",       "100",
            "--precision", "f32",
            "--kernels",   "own",
            "--threads",   "1",
            "--frames",    images ? "auto" : "ignore"};
}

Reconstructor LibraryTest::reconstructor(const ReconstructorOptions& options) {
    return Reconstructor{model(), 64, 48, options};
}

std::string LibraryTest::frames_of_run(const std::vector<std::string>& arguments) const {
    std::vector<std::string> all{
        "run",           recording(), "--model",       model(), "--out",      "grayf32:frames",
        "--uncertainty", "separate",  "--sigma-white", "1",     "--overwrite"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const Result result = eventide(all);
    EXPECT_EQ(result.exit_code, 0) << result.error;
    return read_text(temp_ / "frames");
}

std::vector<Event> events_of(const std::string& recording) {
    EventReader reader{recording};
    std::vector<Event> events;
    for (Batch batch; reader.read(batch);)
        events.insert(events.end(), batch.events.begin(), batch.events.end());
    return events;
}

void append_frame(const Frame& frame, std::string& bytes) {
    for (const Array2<float>* plane : {&frame.intensity, &frame.sigma}) {
        const auto values = std::as_bytes(plane->values());
        bytes.append(reinterpret_cast<const char*>(values.data()), values.size());
    }
}

void append_frames(Reconstructor& reconstructor, std::string& bytes) {
    for (Frame frame; reconstructor.next(frame);) append_frame(frame, bytes);
}

}  // namespace eventide::test
