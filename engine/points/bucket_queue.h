// Which point to visit next: the one with most visited neighbours, first come first served among
// equals ([Zhang] sections 3, 4 and 4.1 all grow in this order).
#pragma once

#include <cstdint>
#include <vector>

#include "base/types.h"

namespace dapple {

// Keys start at 0 and only grow, by one at a time. A point enters the queue with its first raise().
// Every raise() appends the point to the bucket of its new key; what stands in lower buckets is
// stale and skipped when met.
class BucketQueue {
 public:
  explicit BucketQueue(std::size_t points) : keys_(points, 0) {}

  bool retired(Index i) const { return keys_[i] == kRetired; }

  // A point that will never be handed out (any more).
  void retire(Index i) { keys_[i] = kRetired; }

  // One more neighbour of i is visited. Does nothing to retired points.
  void raise(Index i) {
    if (keys_[i] == kRetired) return;
    const std::uint16_t key = ++keys_[i];
    if (key >= buckets_.size()) buckets_.resize(key + 1);
    buckets_[key].ids.push_back(i);
    if (key > top_) top_ = key;
  }

  // The key of the point that pop() gave last.
  std::size_t lastKey() const { return lastKey_; }

  // Takes out and retires the point with the largest key; kNone when no point has a key above 0.
  Index pop() {
    for (; top_ > 0; --top_) {
      Bucket& bucket = buckets_[top_];
      while (bucket.head < bucket.ids.size()) {
        const Index i = bucket.ids[bucket.head++];
        if (keys_[i] != top_) continue;
        keys_[i] = kRetired;
        lastKey_ = top_;
        return i;
      }
      bucket.ids.clear();
      bucket.head = 0;
    }
    return kNone;
  }

 private:
  static constexpr std::uint16_t kRetired = 0xffff;
  struct Bucket {
    std::vector<Index> ids;
    std::size_t head = 0;
  };

  std::vector<std::uint16_t> keys_;  // n
  std::vector<Bucket> buckets_;
  std::size_t top_ = 0, lastKey_ = 0;
};

}  // namespace dapple
