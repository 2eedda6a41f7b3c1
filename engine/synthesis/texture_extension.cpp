#include "synthesis/texture_extension.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "points/tangent_frames.h"
#include "swatch/swatch_search.h"

namespace dapple {
namespace {

constexpr std::size_t kOpinions = 12;     // of decided neighbours, the nearest
constexpr std::size_t kSearched = 16;     // of decided neighbours, for a place that fits
constexpr float kTolerance = 0.5f;        // of the step: opinions that far apart are alike
constexpr float kLeastTolerance = 0.75f;  // pixels
constexpr int kSearchPhases = 2;
constexpr std::size_t kCheckpointEvery = 256;

struct Opinion {
  vec2 texel;
  vec3 up;
  float step;    // pixels to the neighbour
  float weight;  // the nearer the more
};

class Front {
 public:
  Front(const ExtensionInput& input, const std::vector<bool>& decided,
        std::span<const Index> beyond)
      : in_(input), decided_(decided), beyond_(beyond) {
    out_.reached.assign(beyond.size(), false);
    out_.texel.assign(beyond.size(), vec2(0));
    out_.up.assign(beyond.size(), vec3(0, 1, 0));
    out_.scale.assign(beyond.size(), 1);
    for (std::size_t b = 0; b < beyond.size(); ++b) place_.emplace(beyond[b], b);
  }

  Extension grow(Monitor& monitor) {
    for (std::size_t b = 0; b < beyond_.size(); ++b) {
      if (b % kCheckpointEvery == 0) monitor.checkpoint();
      decide(b, monitor);
    }
    return std::move(out_);
  }

 private:
  // The texel and axes of a point that has them.
  bool known(Index i, vec2& texel, TangentFrame& frame) const {
    if (decided_[i]) {
      texel = in_.texel[i], frame = in_.frame[i];
      return true;
    }
    const auto at = place_.find(i);
    if (at == place_.end() || !out_.reached[at->second]) return false;
    texel = out_.texel[at->second];
    frame = orthonormalFrame(in_.points.normals[i], out_.up[at->second]);
    return true;
  }

  // Beyond the rim the pattern keeps the scale that it has there.
  float scaleOf(Index i) const {
    if (!in_.scale) return 1;
    if (decided_[i]) return (*in_.scale)[i];
    return out_.scale[place_.at(i)];
  }

  // Neighbours that have texels and do not look away, nearest first.
  void gather(Index i, std::span<const Index> neighbours) {
    opinions_.clear();
    around_.clear();
    vec2 texel;
    TangentFrame frame;
    for (const Index j : neighbours) {
      if (around_.size() == kSearched) return;
      if (glm::dot(in_.points.normals[i], in_.points.normals[j]) <= 0) continue;
      if (!known(j, texel, frame)) continue;
      const vec3 way = in_.points.positions[i] - in_.points.positions[j];
      if (around_.empty()) out_.scale[place_.at(i)] = scaleOf(j);
      const float unit = in_.unit * scaleOf(j);
      const vec2 step = vec2(glm::dot(way, frame.s), -glm::dot(way, frame.t)) / unit;
      around_.push_back({-step, sampleSwatch(in_.swatch, texel)});
      if (opinions_.size() == kOpinions) continue;
      const float length = glm::length(way) / unit;
      opinions_.push_back({texel + step, frame.t, length, 1 / (length * length + 1e-6f)});
    }
  }

  vec2 difference(vec2 a, vec2 b) const {
    vec2 d = a - b;
    if (!in_.swatch.tileable) return d;
    const vec2 size(in_.swatch.width, in_.swatch.height);
    return d - size * glm::round(d / size);
  }

  // The mean of what is like opinion `o`, and how much that counts.
  float support(std::size_t o, vec2& texel, vec3& up) const {
    vec2 offset(0);
    vec3 ups(0);
    float sum = 0;
    for (const Opinion& other : opinions_) {
      const vec2 d = difference(other.texel, opinions_[o].texel);
      const float most = std::max(kLeastTolerance, kTolerance * (other.step + opinions_[o].step));
      if (glm::dot(d, d) > most * most || glm::dot(other.up, opinions_[o].up) < 0.5f) continue;
      offset += other.weight * d;
      ups += other.weight * other.up;
      sum += other.weight;
    }
    texel = wrapTexel(in_.swatch, opinions_[o].texel + offset / sum);
    up = ups;
    return sum;
  }

  void decide(std::size_t b, Monitor& monitor) {
    const Index i = beyond_[b];
    gather(i, in_.neighborhoods.of(i));
    // Its own neighbours may all lie further out, where the points are dense.
    if (opinions_.empty()) {
      if (!reverse_) reverse_ = reverseNeighborhoods(in_.neighborhoods, monitor);
      gather(i, reverse_->of(i));
    }
    if (opinions_.empty()) return;
    float best = 0;
    vec2 texel;
    vec3 up;
    for (std::size_t o = 0; o < opinions_.size(); ++o) {
      const float weight = support(o, texel, up);
      if (!(weight > best) || !usableTexel(in_.swatch, texel)) continue;
      best = weight;
      out_.texel[b] = texel, out_.up[b] = up;
    }
    if (best == 0) {
      support(0, texel, out_.up[b]);
      out_.texel[b] = fitting();
    }
    out_.up[b] = orthonormalFrame(in_.points.normals[i], out_.up[b]).t;
    out_.reached[b] = true;
  }

  // The place of the swatch that fits the colours around.
  vec2 fitting() {
    if (!search_) search_.emplace(in_.swatch, 0, kSearchPhases);
    for (std::size_t terms = around_.size(); terms > 0; terms /= 2) {
      const SearchResult found = search_->search({around_.data(), terms});
      if (found.found) return found.texel;
    }
    return opinions_.front().texel;
  }

  const ExtensionInput& in_;
  const std::vector<bool>& decided_;
  const std::span<const Index> beyond_;
  std::unordered_map<Index, std::size_t> place_;  // in beyond_
  std::optional<ReverseNeighborhoods> reverse_;
  std::optional<SwatchSearch> search_;
  std::vector<Opinion> opinions_;
  std::vector<SearchTerm> around_;
  Extension out_;
};

}  // namespace

Extension extendTexture(const ExtensionInput& input, const std::vector<bool>& decided,
                        std::span<const Index> beyond, Monitor& monitor) {
  return Front(input, decided, beyond).grow(monitor);
}

}  // namespace dapple
