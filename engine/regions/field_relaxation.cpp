#include "regions/field_relaxation.h"

namespace dapple {

ClassOrder classOrder(std::span<const Index> nodes) {
  static_assert(ClassOrder::kClasses == 8, "the class is three bits of the hash");
  ClassOrder order;
  for (const Index i : nodes) ++order.begin[(mixBits(i) & 7) + 1];
  for (std::size_t c = 0; c < ClassOrder::kClasses; ++c) order.begin[c + 1] += order.begin[c];
  order.ids.resize(nodes.size());
  auto next = order.begin;
  for (const Index i : nodes) order.ids[next[mixBits(i) & 7]++] = i;
  return order;
}

}  // namespace dapple
