// The library as a program in C uses it.
#pragma once

#include "tests/library/library_test.h"

#include <eventide/eventide.h>

#include <cstring>

namespace eventide::test {

class CInterface : public LibraryTest {
protected:
    void TearDown() override { eventide_reconstructor_close(reconstructor_); }

    eventide_options repeatable_options() {
        eventide_options options;
        eventide_options_init(&options, sizeof options);
        options.window = "7ms";
        options.lookahead = 1;
        options.fps = "100";
        options.precision = "f32";
        options.kernels = "own";
        options.threads = 1;
        return options;
    }
    void open() {
        const eventide_options options = repeatable_options();
        ASSERT_EQ(eventide_reconstructor_open(model().c_str(), 64, 48, &options, &reconstructor_),
                  EVENTIDE_OK)
            << eventide_error_message();
    }
    eventide_status open_with(const eventide_options& options) {
        return eventide_reconstructor_open(model().c_str(), 64, 48, &options, &reconstructor_);
    }
    static bool said(const char* words) {
        return std::strstr(eventide_error_message(), words) != nullptr;
    }

    eventide_reconstructor* reconstructor_ = nullptr;
};

}  // namespace eventide::test
