// A subscriber in a process of its own: ros2-listener TOPIC image|camera_info reliable|best_effort.
// Prints a line for each message (topics.h) until its output is closed.
#include "tests/ros2/topics.h"

#include <unistd.h>

#include <string_view>

int main(int argc, char** argv) {
    using namespace eventide;
    if (argc != 4) return 2;
    const MessageType& type = std::string_view{argv[2]} == "image" ? kImageType : kCameraInfoType;
    test::TopicReader reader{type, argv[1], {.reliable = std::string_view{argv[3]} == "reliable"}};
    std::string line = test::ready_line();
    if (!reader.wait_for_writers(1)) return 1;
    while (write(STDOUT_FILENO, line.data(), line.size()) == ssize_t(line.size())) {
        const auto cdr = reader.next_cdr();
        if (!cdr) return 1;
        line = test::message_line(*cdr);
    }
    return 0;
}
