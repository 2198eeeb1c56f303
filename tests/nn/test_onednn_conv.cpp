// What the rest of the program may rely on where oneDNN convolves: one thread, settings of OpenMP
// as they were, few allocations, and a refusal where it was not built in.
#include "src/core/error.h"
#include "src/nn/onednn_conv.h"
#include "tests/nn/fills.h"
#include "tests/support/allocation_counter.h"

#include <gtest/gtest.h>

#include <thread>

#if EVENTIDE_ONEDNN
extern "C" {
int omp_get_max_threads();
void omp_set_num_threads(int n);
}
#endif

namespace eventide {
namespace {

using test::Fill;

plain::ConvWeights<float> weights_of(int out, int in) {
    test::Numbers numbers{4};
    plain::ConvWeights<float> weights{out, in, {}, {}};
    weights.weight = numbers.many(std::size_t(9 * in * out), Fill::ordinary);
    weights.bias = numbers.many(std::size_t(out), Fill::ordinary);
    return weights;
}

/// A convolution of 16 to 24 channels over 20 x 31 outputs, with all it reads and writes.
struct Work {
    static constexpr int kHeight = 20, kWidth = 31, kIn = 16, kOut = 24;
    std::vector<float> in =
        test::Numbers{5}.many((kHeight + 2) * (kWidth + 2) * kIn, Fill::ordinary);
    std::vector<float> out = std::vector<float>(kHeight * kWidth * kOut);
    std::vector<float> scratch;

    ConvCall call() {
        return {in.data(), (kWidth + 2) * kIn, out.data(), kWidth * kOut, kHeight, kWidth};
    }
    void run(const OnednnConv& conv) {
        scratch.resize(conv.scratch_size());
        conv.run(call(), scratch.data());
    }
};

#if EVENTIDE_ONEDNN

const OnednnConv& convolution() {
    static const OnednnConv kConv{
        weights_of(Work::kOut, Work::kIn), 1, true, nullptr, {{Work::kHeight, Work::kWidth}}};
    return kConv;
}

TEST(OnednnConv, LeavesOpenMpAsItWas) {
    omp_set_num_threads(3);
    Work work;
    work.run(convolution());
    EXPECT_EQ(omp_get_max_threads(), 3);
    omp_set_num_threads(1);
    work.run(convolution());
    EXPECT_EQ(omp_get_max_threads(), 1);
}

TEST(OnednnConv, GivesTheSameBitsOnEveryThreadAtOnce) {
    Work alone;
    alone.run(convolution());
    std::vector<Work> works(4);
    std::vector<std::thread> threads;
    for (Work& work : works)
        threads.emplace_back([&work] {
            for (int i = 0; i < 20; ++i) work.run(convolution());
        });
    for (std::thread& thread : threads) thread.join();
    for (const Work& work : works) EXPECT_EQ(work.out, alone.out);
}

TEST(OnednnConv, AllocatesNoMoreThanItsArgumentLists) {
    if (!test::can_count_allocations()) GTEST_SKIP() << "sanitizers bring their own malloc";
    Work work;
    work.run(convolution());
    test::AllocationCount count;
    for (int i = 0; i < 10; ++i) work.run(convolution());
    const std::int64_t allocations = count.stop();
    std::printf("  %.1f per call\n", double(allocations) / 10);
    EXPECT_LE(allocations, 10 * 20);
}

#else

TEST(OnednnConv, IsRefusedWhereItWasNotBuiltIn) {
    EXPECT_FALSE(onednn_available());
    EXPECT_THROW(OnednnConv(weights_of(1, 1), 1, true, nullptr, {{1, 1}}), Error);
}

#endif

}  // namespace
}  // namespace eventide
