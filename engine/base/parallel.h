// A small pool of threads that look for work for some microseconds and then sleep (the window
// shares these cores), and loops over fixed chunks, so that results do not depend on the thread
// count.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace dapple {

// Background: gives way to whatever a person waits for. Where the system allows it (Linux), threads
// of this kind get a processor only as far as others leave it.
enum class Priority { Normal, Background };

// Of the calling thread, until its end.
void setPriority(Priority priority);

class Workers {
 public:
  // `threads` in all, the calling one included; 0 means one for each processor. The priority is
  // that of the others; the calling one keeps its own.
  explicit Workers(unsigned threads = 0, Priority priority = Priority::Normal);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  unsigned threads() const;

  // Runs body(0) ... body(count - 1), each once, in any order, on all threads; returns when all
  // are done. Of several exceptions the one of the smallest index is thrown on. Not re-entrant:
  // called by one thread at a time, and never from inside a body.
  void run(std::size_t count, const std::function<void(std::size_t)>& body);

 private:
  struct Pool;
  std::unique_ptr<Pool> pool_;
};

}  // namespace dapple
