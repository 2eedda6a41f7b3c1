// Working memory for bodies of parallel loops: as many objects as run at the same time.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <vector>

namespace dapple {

// Objects are handed out as they were left; what they hold must not make a difference to a result.
template <class Scratch>
class ScratchPool {
 public:
  explicit ScratchPool(std::function<std::unique_ptr<Scratch>()> make) : make_(std::move(make)) {}

  // Calls body with an object that nobody else has meanwhile.
  template <class Body>
  void use(Body body) {
    std::unique_ptr<Scratch> scratch = take();
    body(*scratch);
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(scratch));
  }

 private:
  std::unique_ptr<Scratch> take() {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        std::unique_ptr<Scratch> scratch = std::move(idle_.back());
        idle_.pop_back();
        return scratch;
      }
    }
    return make_();
  }

  std::function<std::unique_ptr<Scratch>()> make_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Scratch>> idle_;
};

}  // namespace dapple
