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

#if defined(__linux__)
#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>
#endif

#include "base/errors.h"

namespace dapple {
namespace {

// How often a thread looks for work, or for the end of it, before it sleeps: some 20 us. Going to
// sleep and waking costs more than many a loop that follows the last one at once.
constexpr int kLooks = 400;

// A third of the weight of a usual thread: enough for the window, and on a busy machine enough of
// it for the work to get on.
constexpr int kBackgroundNice = 5;

void pauseBriefly() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

}  // namespace

// Whoever claims an index runs it. A thread that wakes late finds nothing to claim, and nobody
// waits for it.
struct Workers::Pool {
  // Number of the run << 32 | indices not claimed yet: one word, so that a thread cannot claim an
  // index of a run that it has not seen begin.
  std::atomic<std::uint64_t> open{0};
  std::atomic<std::size_t> finished{0};
  std::atomic<int> sleepers{0};
  std::atomic<bool> quit{false}, failed{false};
  // Of the run: read by those who hold an index of it only.
  const std::function<void(std::size_t)>* body = nullptr;
  std::size_t count = 0;

  std::mutex mutex;
  std::condition_variable wake, done;
  std::exception_ptr failure;
  std::size_t failedAt = 0;
  std::vector<std::jthread> threads;

  static std::uint64_t left(std::uint64_t state) { return state & 0xffffffff; }

  void runOne(std::size_t i) {
    if (!failed.load(std::memory_order_relaxed)) {  // else what has not begun is not begun
      try {
        (*body)(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure || i < failedAt) failure = std::current_exception(), failedAt = i;
        failed.store(true, std::memory_order_relaxed);
      }
    }
    const std::size_t all = count;  // may be the next run's after the next line
    if (finished.fetch_add(1) + 1 < all) return;
    const std::lock_guard lock(mutex);
    done.notify_one();
  }

  void drain() {
    std::uint64_t state = open.load();
    while (left(state) > 0)
      if (open.compare_exchange_weak(state, state - 1)) {
        runOne(count - left(state));
        state = open.load();
      }
  }

  void serve() {
    while (!quit.load()) {
      drain();
      for (int look = 0; look < kLooks && left(open.load()) == 0; ++look) pauseBriefly();
      if (left(open.load()) > 0) continue;
      std::unique_lock lock(mutex);
      ++sleepers;
      wake.wait(lock, [&] { return quit.load() || left(open.load()) > 0; });
      --sleepers;
    }
  }

  void wakeAll() {
    if (sleepers.load() == 0) return;
    { const std::lock_guard lock(mutex); }  // nobody is between looking and sleeping
    wake.notify_all();
  }

  void awaitEnd() {
    for (int look = 0; look < kLooks && finished.load() < count; ++look) pauseBriefly();
    if (finished.load() == count) return;
    std::unique_lock lock(mutex);
    done.wait(lock, [&] { return finished.load() == count; });
  }
};

void setPriority(Priority priority) {
  if (priority == Priority::Normal) return;
#if defined(__linux__)
  // On Linux both are of the thread. Where they are refused everything works, only less smoothly.
  const sched_param none{};
  static_cast<void>(pthread_setschedparam(pthread_self(), SCHED_BATCH, &none));
  static_cast<void>(setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kBackgroundNice));
#endif
}

Workers::Workers(unsigned threads, Priority priority) : pool_(std::make_unique<Pool>()) {
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  for (unsigned i = 1; i < threads; ++i)
    pool_->threads.emplace_back([this, priority] {
      setPriority(priority);
      pool_->serve();
    });
}

Workers::~Workers() {
  pool_->quit = true;
  pool_->wakeAll();
  pool_->threads.clear();
}

unsigned Workers::threads() const {
  return static_cast<unsigned>(pool_->threads.size()) + 1;
}

void Workers::run(std::size_t count, const std::function<void(std::size_t)>& body) {
  if (count == 0) return;
  DAPPLE_CHECK(count, <=, std::numeric_limits<std::uint32_t>::max());
  Pool& pool = *pool_;
  pool.body = &body;
  pool.count = count;
  pool.failure = nullptr;
  pool.failed = false;
  pool.finished = 0;
  pool.open = ((pool.open.load() >> 32) + 1) << 32 | count;
  pool.wakeAll();
  pool.drain();
  pool.awaitEnd();
  if (pool.failure) std::rethrow_exception(std::exchange(pool.failure, nullptr));
}

}  // namespace dapple
