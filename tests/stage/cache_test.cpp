// A shared table is built once, whoever asks.

#include "stage/cache.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "stage/stage.h"

namespace {

using brume::StageCache;

std::atomic<int> built{0};
std::vector<int>* destroyed = nullptr;

void* build_int(void* argument) {
  ++built;
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  return new int(*static_cast<int*>(argument));
}
void destroy_int(void* p) {
  if (destroyed) destroyed->push_back(*static_cast<int*>(p));
  delete static_cast<int*>(p);
}

TEST(StageCache, OneThreadBuildsAndTheOthersWait) {
  built = 0;
  StageCache cache;
  std::vector<const void*> got(8);
  std::vector<std::thread> threads;
  int seven = 7;
  for (auto& g : got)
    threads.emplace_back([&] { g = cache.get("sky:7", build_int, &seven, destroy_int); });
  for (auto& t : threads) t.join();
  EXPECT_EQ(built, 1);
  for (const void* g : got) {
    ASSERT_EQ(g, got[0]);
    EXPECT_EQ(*static_cast<const int*>(g), 7);
  }
}

TEST(StageCache, WhatFailsIsTriedAgain) {
  StageCache cache;
  int calls = 0;
  const auto fails = [](void* n) -> void* { return ++*static_cast<int*>(n), nullptr; };
  EXPECT_EQ(cache.get("k", fails, &calls, destroy_int), nullptr);
  EXPECT_EQ(cache.get("k", fails, &calls, destroy_int), nullptr);
  EXPECT_EQ(calls, 2);
  const auto throws = [](void*) -> void* { throw 1; };
  EXPECT_EQ(cache.get("k", throws, nullptr, destroy_int), nullptr);
  EXPECT_EQ(cache.get("k", nullptr, nullptr, destroy_int), nullptr);
  EXPECT_NE(cache.get("k", build_int, &calls, destroy_int), nullptr);
}

TEST(StageCache, ABuildMayAskForAnotherTableButNotForItself) {
  struct Job {
    StageCache* cache;
    const void* itself;
  };
  std::vector<int> order;
  destroyed = &order;
  {
    StageCache cache;
    Job job{&cache, &job};
    const void* outer = cache.get(
        "outer",
        [](void* j) -> void* {
          auto& asked = *static_cast<Job*>(j);
          asked.itself = asked.cache->get("outer", build_int, nullptr, destroy_int);
          int one = 1;
          asked.cache->get("inner", build_int, &one, destroy_int);
          return new int(2);
        },
        &job, destroy_int);
    EXPECT_EQ(*static_cast<const int*>(outer), 2);
    EXPECT_EQ(job.itself, nullptr);
  }
  // The outer table may point into the inner one, so it goes first.
  EXPECT_EQ(order, (std::vector<int>{2, 1}));
  destroyed = nullptr;
}

}  // namespace
