// A machine that gives no more threads: pthread_create() is this program's own.
#include "tests/pipeline/toy_pipeline.h"

#include <gtest/gtest.h>

#include <dlfcn.h>
#include <pthread.h>

#include <atomic>
#include <cerrno>
#include <limits>
#include <system_error>

namespace {

constexpr int kAll = std::numeric_limits<int>::max();
std::atomic<int> threads_left{kAll};

}  // namespace

extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes,
                              void* (*start)(void*), void* argument) noexcept {
    using Create = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
    static const auto create = reinterpret_cast<Create>(dlsym(RTLD_NEXT, "pthread_create"));
    return threads_left-- > 0 ? create(thread, attributes, start, argument) : EAGAIN;
}

namespace eventide {
namespace {

TEST(PipelineThreads, OneThatCannotStartIsAnErrorAndNothingWaitsForIt) {
    for (const int started : {0, 1, 2}) {
        test::PipelineUnderTest line(test::one_frame_per_packet(500), test::quick_settings());
        line.made();
        threads_left = started;
        EXPECT_THROW(line.run(), std::system_error) << started << " of three";
        threads_left = kAll;
        EXPECT_EQ(line.sink.closed, 1);
    }
}

}  // namespace
}  // namespace eventide
