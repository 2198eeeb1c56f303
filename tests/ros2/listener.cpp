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
    while (true) {
        const auto cdr = reader.next_cdr();
        if (!cdr) return 1;
        const std::string line = test::message_line(*cdr);
        if (write(STDOUT_FILENO, line.data(), line.size()) != ssize_t(line.size())) return 0;
    }
}
