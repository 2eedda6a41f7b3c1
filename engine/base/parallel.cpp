#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <limits>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace dapple {

struct Workers::Pool {
  std::mutex mutex;
  std::condition_variable wake, done;
  const std::function<void(std::size_t)>* body = nullptr;
  std::size_t count = 0;
  std::atomic<std::size_t> next{0};
  std::uint64_t generation = 0;
  std::size_t busy = 0;
  bool quit = false;
  std::exception_ptr failure;
  std::size_t failedAt = 0;
  std::vector<std::jthread> threads;

  void drain() {
    for (;;) {
      const std::size_t i = next.fetch_add(1, std::memory_order_relaxed);
      if (i >= count) return;
      try {
        (*body)(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure || i < failedAt) {
          failure = std::current_exception();
          failedAt = i;
        }
        next.store(count, std::memory_order_relaxed);  // what has not begun is not begun
      }
    }
  }

  void serve() {
    std::uint64_t seen = 0;
    std::unique_lock lock(mutex);
    for (;;) {
      wake.wait(lock, [&] { return quit || generation != seen; });
      if (quit) return;
      seen = generation;
      lock.unlock();
      drain();
      lock.lock();
      if (--busy == 0) done.notify_one();
    }
  }
};

Workers::Workers(unsigned threads) : pool_(std::make_unique<Pool>()) {
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  for (unsigned i = 1; i < threads; ++i) pool_->threads.emplace_back([this] { pool_->serve(); });
}

Workers::~Workers() {
  {
    const std::lock_guard lock(pool_->mutex);
    pool_->quit = true;
  }
  pool_->wake.notify_all();
  pool_->threads.clear();
}

unsigned Workers::threads() const {
  return static_cast<unsigned>(pool_->threads.size()) + 1;
}

void Workers::run(std::size_t count, const std::function<void(std::size_t)>& body) {
  if (count == 0) return;
  Pool& pool = *pool_;
  {
    const std::lock_guard lock(pool.mutex);
    pool.body = &body;
    pool.count = count;
    pool.next.store(0, std::memory_order_relaxed);
    pool.failure = nullptr;
    pool.busy = pool.threads.size();
    ++pool.generation;
  }
  if (!pool.threads.empty()) pool.wake.notify_all();
  pool.drain();
  std::unique_lock lock(pool.mutex);
  pool.done.wait(lock, [&] { return pool.busy == 0; });
  if (pool.failure) std::rethrow_exception(std::exchange(pool.failure, nullptr));
}

}  // namespace dapple
