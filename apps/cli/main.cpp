// eventide: video with uncertainty from event cameras.
#include "apps/cli/program.h"
#include "apps/cli/signals.h"
#include "src/core/error.h"
#include "src/io/system_words.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <new>
#include <string>
#include <vector>

namespace {

/// Else the next file to be opened would take the number of a standard stream that is closed, and
/// what is said to people would land in it. In the wrong direction, so that using one is an error.
void occupy_closed_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (::fcntl(stream, F_GETFD) < 0)
            ::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

int run(int argc, char** argv) {
    try {
        eventide::app::Signals signals;
        return eventide::app::run_program(signals, std::vector<std::string>(argv + 1, argv + argc));
    } catch (const eventide::Error& error) {
        std::fprintf(stderr, "eventide: error: %s\n", error.what());
        return int(error.kind());
    } catch (const std::system_error& error) {  // the thread that waits for signals
        std::fprintf(stderr, "eventide: error: %s\n", eventide::system_words(error).c_str());
        return int(eventide::ErrorKind::failed);
    } catch (const std::bad_alloc&) {
        std::fputs("eventide: error: out of memory\n", stderr);
        return int(eventide::ErrorKind::failed);
    }
}

/// All is written and closed by now. The ends of libraries are left out: OpenBLAS, which OpenCV
/// brings along, waits there for threads of its own that ask for memory for ever where there is too
/// little. Sanitizers report at the ordinary end.
[[noreturn]] void leave(int code) {
    std::fflush(nullptr);
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    std::exit(code);
#else
    std::_Exit(code);
#endif
}

}  // namespace

int main(int argc, char** argv) {
    occupy_closed_streams();
    leave(run(argc, argv));
}
