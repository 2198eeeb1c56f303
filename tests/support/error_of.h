// The words of errors that must come.
#pragma once

#include "src/core/error.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>

namespace eventide::test {

/// What the Error of this kind says that `call` must throw.
inline std::string error_of(const std::function<void()>& call, ErrorKind kind = ErrorKind::usage) {
    try {
        call();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), kind) << error.what();
        return error.what();
    }
    ADD_FAILURE() << "nothing was thrown";
    return {};
}

}  // namespace eventide::test
