#include "base/parallel.h"

#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "base/errors.h"
#include "base/monitor.h"

using namespace dapple;

TEST_CASE("every index runs exactly once at any number of threads") {
  for (unsigned threads : {1u, 2u, 3u, 7u}) {
    Workers workers(threads);
    CHECK(workers.threads() == threads);
    for (int round = 0; round < 50; ++round) {
      std::vector<std::atomic<int>> hits(997);
      workers.run(hits.size(), [&](std::size_t i) { ++hits[i]; });
      for (const auto& h : hits) REQUIRE(h == 1);
    }
  }
}

TEST_CASE("an exception in a loop reaches the caller and the pool goes on working") {
  Workers workers(3);
  CHECK_THROWS_AS(workers.run(100,
                              [](std::size_t i) {
                                if (i == 40) throw std::runtime_error("40");
                              }),
                  std::runtime_error);
  std::atomic<int> sum = 0;
  workers.run(10, [&](std::size_t i) { sum += static_cast<int>(i); });
  CHECK(sum == 45);
}

TEST_CASE("a stopped monitor ends a loop with Cancelled") {
  Workers workers(2);
  std::stop_source stop;
  Monitor monitor(workers, stop.get_token());
  std::atomic<std::size_t> done = 0;
  CHECK_THROWS_AS(parallelFor(monitor, 1000, 1,
                              [&](std::size_t, std::size_t) {
                                if (++done == 10) stop.request_stop();
                              }),
                  Cancelled);
  CHECK(done < 1000);
}

TEST_CASE("progress runs from 0 to 1 and never shows a fraction above 1") {
  Workers workers(1);
  std::vector<double> seen;
  Monitor monitor(workers, {},
                  {.progress = [&](const Progress& p) { seen.push_back(p.fraction); }});
  monitor.begin(Stage::Synthesis, 100);
  monitor.advance(250);
  REQUIRE(!seen.empty());
  CHECK(seen.front() == 0.0);
  for (double f : seen) CHECK(f <= 1.0);
}

TEST_CASE("previews that take long leave time for the work") {
  using Clock = std::chrono::steady_clock;
  Workers workers(1);
  Clock::duration took{};
  std::vector<Clock::time_point> asked;
  MonitorCallbacks callbacks;
  callbacks.preview = [&](const Preview&) {
    const auto start = Clock::now();
    std::this_thread::sleep_for(std::chrono::milliseconds(40));
    if (asked.size() < 3) took += Clock::now() - start;
  };
  Monitor monitor(workers, {}, callbacks);
  while (asked.size() < 3) {
    if (!monitor.wantsPreview()) continue;
    asked.push_back(Clock::now());
    monitor.publish({});
  }
  CHECK(asked[2] - asked[0] >= 3 * took);
}

TEST_CASE("a broken promise names both values") {
  try {
    DAPPLE_CHECK(1 + 1, ==, 3);
    FAIL("no exception");
  } catch (const Bug& bug) {
    const std::string text = bug.what();
    CHECK(text.find("left is 2 and right is 3") != std::string::npos);
  }
}
