#include "regions/field_combing.h"

#include "regions/tangent_numbers.h"

namespace dapple {
namespace {

constexpr std::size_t kCheckpointEvery = 8192;

class Comber {
 public:
  Comber(const FoldedField& field, const Monitor& monitor)
      : field_(field), monitor_(monitor), reached_(field.powers.size(), 0), root_(field.powers) {}

  // Walks the part of `first` unless that is done.
  void walkFrom(Index first, const vec3& direction) {
    if (reached_[first]) return;
    reach(first, tangentNumber(field_.points.normals[first], direction));
    for (; next_ < queue_.size(); ++next_) {
      if (next_ % kCheckpointEvery == 0) monitor_.checkpoint();
      const Index i = queue_[next_];
      for (const Index j : field_.graph.of(i)) {
        if (reached_[j]) continue;
        const vec2 turn = transport(field_.points.normals[i], field_.points.normals[j]);
        reach(j, product(turn, root_[i]));
      }
    }
  }

  std::vector<vec2> take() { return std::move(root_); }

 private:
  void reach(Index i, const vec2& direction) {
    reached_[i] = 1;
    root_[i] = nearestRoot(field_.powers[i], field_.folds, direction);
    queue_.push_back(i);
  }

  const FoldedField& field_;
  const Monitor& monitor_;
  std::vector<std::uint8_t> reached_;
  std::vector<vec2> root_;
  std::vector<Index> queue_;
  std::size_t next_ = 0;
};

}  // namespace

std::vector<vec2> combed(const FoldedField& field, std::span<const StrokeMark> marks,
                         const Monitor& monitor) {
  if (field.folds == 1) return field.powers;
  Comber comber(field, monitor);
  for (const StrokeMark& mark : marks) comber.walkFrom(mark.point, mark.direction);
  for (std::size_t i = 0; i < field.powers.size(); ++i)
    comber.walkFrom(static_cast<Index>(i), field.up);
  return comber.take();
}

}  // namespace dapple
