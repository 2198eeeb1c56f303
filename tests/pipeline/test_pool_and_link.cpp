// Buffers come back, items stay in order, the end travels in the stream.
#include "pipeline/link.h"
#include "pipeline/pool.h"

#include <gtest/gtest.h>

#include <latch>
#include <memory>
#include <thread>
#include <vector>

namespace eventide {
namespace {

TEST(Pool, LendsEachBufferToOneHolderAtATime) {
    int made = 0;
    Pool<int> pool(3, [&] { return made++; });
    EXPECT_EQ(made, 3);
    auto a = pool.acquire(), b = pool.acquire(), c = pool.try_acquire();
    ASSERT_TRUE(c);
    EXPECT_NE(*a, *b);
    EXPECT_NE(*b, *c);
    EXPECT_FALSE(pool.try_acquire());
    const int back = *b;
    b.reset();
    EXPECT_EQ(*pool.acquire(), back);
}

TEST(Pool, WaitsForABufferThatComesBackFromAnotherThread) {
    Pool<int> pool(1, [] { return 7; });
    for (int round = 0; round < 1000; ++round) {
        auto lent = pool.acquire();
        std::jthread other{[lent = std::move(lent)]() mutable { lent.reset(); }};
        EXPECT_EQ(*pool.acquire(), 7);
    }
}

TEST(Link, KeepsOrderBetweenTwoThreads) {
    constexpr int kItems = 100'000;
    Link<std::unique_ptr<int>> link(16);
    std::jthread producer{[&] {
        for (int i = 0; i < kItems; ++i) link.push(std::make_unique<int>(i));
        link.close();
    }};
    for (int i = 0; i < kItems; ++i) {
        const auto item = link.pop();
        ASSERT_TRUE(item);
        ASSERT_EQ(**item, i);
    }
    EXPECT_FALSE(link.pop());
    EXPECT_FALSE(link.pop()) << "the end stays the end";
}

TEST(Link, EndsAnEmptyStream) {
    Link<std::unique_ptr<int>> link(4);
    link.close();
    EXPECT_FALSE(link.pop());
}

TEST(Link, MayDieWithItemsInIt) {
    Pool<int> pool(2, [] { return 1; });
    Link<Pool<int>::Handle> link(2);
    link.push(pool.acquire());
    link.push(pool.acquire());
    EXPECT_EQ(link.waiting(), 2U);
}

TEST(Link, CarriesBuffersRoundAndRound) {
    constexpr int kItems = 50'000;
    Pool<int> pool(4, [] { return 0; });
    Link<Pool<int>::Handle> link(4);
    std::jthread producer{[&] {
        for (int i = 0; i < kItems; ++i) {
            auto buffer = pool.acquire();
            *buffer = i;
            link.push(std::move(buffer));
        }
        link.close();
    }};
    int expected = 0;
    while (auto item = link.pop()) ASSERT_EQ(**item, expected++);
    EXPECT_EQ(expected, kItems);
}

}  // namespace
}  // namespace eventide
