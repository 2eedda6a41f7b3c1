// How long work takes, by the wall.
#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <vector>

namespace dapple::bench {

inline double secondsOf(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// Median of `runs`, after one run that is not counted.
inline double medianSeconds(int runs, const std::function<void()>& work) {
  work();
  std::vector<double> seconds;
  for (int r = 0; r < runs; ++r) seconds.push_back(secondsOf(work));
  return median(seconds);
}

}  // namespace dapple::bench
