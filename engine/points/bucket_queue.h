// Which point to visit next: the one with most visited neighbours, first come first served among
// equals ([Zhang] sections 3, 4 and 4.1 all grow in this order).
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "base/types.h"

namespace dapple {

// Points in buckets by key. A point is pushed anew whenever its key grows; whoever pops skips the
// stale entries, whose key is not the point's current one.
class KeyBuckets {
 public:
  void push(std::size_t key, Index id) {
    if (key >= buckets_.size()) buckets_.resize(key + 1);
    buckets_[key].ids.push_back(id);
    if (key > top_) top_ = key;
  }

  struct Entry {
    std::size_t key = 0;
    Index id = kNone;  // kNone: all buckets are empty
  };
  // Takes out the first entry of the largest key.
  Entry pop() {
    if (buckets_.empty()) return {};
    for (;; --top_) {
      Bucket& bucket = buckets_[top_];
      if (bucket.head < bucket.ids.size()) return {top_, bucket.ids[bucket.head++]};
      bucket.ids.clear();
      bucket.head = 0;
      if (top_ == 0) return {};
    }
  }

 private:
  struct Bucket {
    std::vector<Index> ids;
    std::size_t head = 0;
  };
  std::vector<Bucket> buckets_;
  std::size_t top_ = 0;
};

// The same with the keys kept here: they start at 0 and only grow, by one at a time. A point enters
// the queue with its first raise().
class BucketQueue {
 public:
  explicit BucketQueue(std::size_t points) : keys_(points, 0) {}

  bool retired(Index i) const { return keys_[i] == kRetired; }

  // A point that will never be handed out (any more).
  void retire(Index i) { keys_[i] = kRetired; }

  // One more neighbour of i is visited. Does nothing to retired points.
  void raise(Index i) {
    if (keys_[i] != kRetired) buckets_.push(++keys_[i], i);
  }

  // The same for several.
  void raiseAll(std::span<const Index> ids) {
    raised_.resize(std::max(raised_.size(), ids.size()));
    std::size_t count = 0;
    for (const Index i : ids) {  // no branch: which ones are retired cannot be foreseen
      raised_[count] = i;
      const bool waits = keys_[i] != kRetired;
      keys_[i] = static_cast<std::uint16_t>(keys_[i] + (waits ? 1 : 0));
      count += waits ? 1 : 0;
    }
    for (std::size_t r = 0; r < count; ++r) buckets_.push(keys_[raised_[r]], raised_[r]);
  }

  // The key of the point that pop() gave last.
  std::size_t lastKey() const { return lastKey_; }

  // Takes out and retires the point with the largest key; kNone when no point has a key above 0.
  Index pop() {
    for (;;) {
      const KeyBuckets::Entry next = buckets_.pop();
      if (next.id == kNone) return kNone;
      if (keys_[next.id] != next.key) continue;
      keys_[next.id] = kRetired;
      lastKey_ = next.key;
      return next.id;
    }
  }

 private:
  static constexpr std::uint16_t kRetired = 0xffff;

  std::vector<std::uint16_t> keys_;  // n
  std::vector<Index> raised_;
  KeyBuckets buckets_;
  std::size_t lastKey_ = 0;
};

}  // namespace dapple
