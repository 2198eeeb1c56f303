// A program without the live page says how to get it.
#include "pipeline/sinks/http/http_sink.h"
#include "src/core/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace eventide {
namespace {

TEST(HttpSink, SaysWhatThisBuildLacks) {
    try {
        open_http({});
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage);
        EXPECT_THAT(error.what(), testing::HasSubstr("libcpp-httplib-dev"));
        EXPECT_THAT(error.what(), testing::HasSubstr("-DEVENTIDE_HTTP=ON"));
    }
}

}  // namespace
}  // namespace eventide
