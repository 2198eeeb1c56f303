// EVENTIDE_TEST_ISA=avx512 (all but AMX), avx2 or sse4: the tests of a program run with the kernels
// of an older processor.
#include "src/kernels/vector_kernels.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <stdexcept>
#include <string>

namespace eventide::test {
namespace {

class IsaLimit final : public testing::Environment {
    void SetUp() override {
        const char* value = std::getenv("EVENTIDE_TEST_ISA");
        const std::string isa = value == nullptr ? "" : value;
        if (isa == "avx512")
            limit_kernels_to_avx512();
        else if (isa == "avx2")
            limit_kernels_to_avx2();
        else if (isa == "sse4")
            limit_kernels_to_sse4();
        else if (!isa.empty())
            throw std::runtime_error("EVENTIDE_TEST_ISA: expected avx512, avx2 or sse4, found " +
                                     isa);
        std::printf("kernels: %s\n", vector_kernels().name);
    }
};

const testing::Environment* const kLimit =
    testing::AddGlobalTestEnvironment(std::make_unique<IsaLimit>().release());

}  // namespace
}  // namespace eventide::test
