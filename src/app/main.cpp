// eventide: video with uncertainty from event cameras.
#include "src/app/program.h"
#include "src/app/signals.h"

#include <string>
#include <vector>

int main(int argc, char** argv) {
    eventide::app::Signals signals;
    return eventide::app::run_program(signals, std::vector<std::string>(argv + 1, argv + argc));
}
