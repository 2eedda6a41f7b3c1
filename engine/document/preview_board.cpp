#include "document/preview_board.h"

namespace dapple {

PreviewBoard::PreviewBoard(const Document& document)
    : colours_(shownColours(document)), states_(document.size(), PointState::Free) {}

void PreviewBoard::begins(std::span<const Index> points, std::size_t before, std::size_t total) {
  points_.assign(points.begin(), points.end());
  const std::size_t count = points.empty() ? colours_.size() : points.size();
  total_ = static_cast<double>(total);
  before_ = static_cast<double>(before) / total_;
  share_ = static_cast<double>(count) / total_;
}

// Gap points keep what they had until they have a colour, which may be late: black is none yet.
void PreviewBoard::show(const Preview& preview) {
  for (std::size_t r = 0; r < preview.states.size(); ++r) {
    const PointState state = preview.states[r];
    const std::size_t i = at(r);
    states_[i] = state;
    const bool coloured = state == PointState::Patch || state == PointState::Matched ||
                          (state == PointState::Gap && preview.colours[r] != vec3(0));
    if (coloured) colours_[i] = preview.colours[r];
  }
}

void PreviewBoard::ends(const SourceMap& map) {
  for (std::size_t r = 0; r < map.colour.size(); ++r)
    colours_[at(r)] = map.colour[r], states_[at(r)] = map.state[r];
}

Progress PreviewBoard::overall(Progress progress) const {
  if (total_ == 0) return progress;
  const double done = progress.stage == Stage::Synthesis ? progress.fraction : 0;
  progress.fraction = before_ + share_ * done;
  if (progress.pointsPerSecond > 0 && progress.stage == Stage::Synthesis)
    progress.secondsLeft += (1 - before_ - share_) * total_ / progress.pointsPerSecond;
  return progress;
}

}  // namespace dapple
