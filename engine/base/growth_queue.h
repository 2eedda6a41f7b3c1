// The queue of [Zhang] section 3.1: points by how many of their neighbours are done already.
#pragma once

#include <vector>

#include "base/types.h"

namespace dapple {

// Pops the entry of the largest key, first come first served among equals. An entry is pushed anew
// whenever its key grows; the caller skips the stale ones, whose key is not the current one.
class GrowthQueue {
 public:
  explicit GrowthQueue(std::size_t largestKey) : buckets_(largestKey + 1) {}

  void push(std::size_t key, Index id) {
    buckets_[key].entries.push_back(id);
    if (key > top_) top_ = key;
  }

  struct Entry {
    std::size_t key = 0;
    Index id = kNone;  // kNone: the queue is empty
  };
  Entry pop() {
    for (;;) {
      Bucket& bucket = buckets_[top_];
      if (bucket.head < bucket.entries.size()) return {top_, bucket.entries[bucket.head++]};
      bucket.entries.clear();
      bucket.head = 0;
      if (top_ == 0) return {};
      --top_;
    }
  }

  void clear() {
    for (Bucket& bucket : buckets_) bucket.entries.clear(), bucket.head = 0;
    top_ = 0;
  }

 private:
  struct Bucket {
    std::vector<Index> entries;
    std::size_t head = 0;
  };
  std::vector<Bucket> buckets_;
  std::size_t top_ = 0;
};

}  // namespace dapple
