// What tests of commands look at: what info says of a file.
#pragma once

#include "tests/system/program_test.h"

#include <nlohmann/json.hpp>

#include <string>

namespace eventide::test {

using Json = nlohmann::json;

class Commands : public ProgramTest {
protected:
    Json info(const std::string& file) const {
        const Result result = eventide({"info", file, "--json"});
        EXPECT_EQ(result.exit_code, 0) << result.error;
        return Json::parse(result.output);
    }
    void expect_same_events(const Json& a, const Json& b) const {
        for (const char* key : {"events", "on", "first_us", "last_us", "width", "height"})
            EXPECT_EQ(a[key], b[key]) << key;
    }
};

}  // namespace eventide::test
