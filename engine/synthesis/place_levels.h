// Relaxation of places over the levels of a surface, coarse to fine: of all points, or of some
// beside others that stay where they are.
#pragma once

#include <functional>

#include "base/monitor.h"
#include "synthesis/surface_sites.h"

namespace dapple {

struct PlaceTask {
  std::vector<std::uint8_t> open;  // n, 1: its place is sought, others keep theirs; empty: all are
  std::vector<Place> start;        // n, inside the swatch; of open points in the domain
  // The start of open points is a guess that any coarser point's place replaces. Else only those of
  // open ones do.
  bool guessed = false;
};

class PlaceLevels {
 public:
  // `surface` is what thinSurface() says of the input, or its first levels; both are kept by
  // reference.
  PlaceLevels(const SynthesisInput& input, std::span<const SurfaceLevel> surface, PlaceTask task);

  // Goes on to level l: the last one first, then the one below each time. Throws Cancelled.
  void enter(std::size_t l, Monitor& monitor);
  // `passes` over the level entered, whose step is at least a pixel; `afterClass` comes after each
  // of a pass's PlaceRelaxation::kClasses. `errors`, if any, becomes the root mean square
  // difference per term of every site, 0..1. The same bytes at any number of threads. Throws
  // Cancelled.
  void relax(int passes, const std::function<void()>& afterClass, std::vector<float>* errors,
             Monitor& monitor);

  // Of the sites of the level entered last.
  const std::vector<Place>& places() const { return places_; }
  // Calls visit(first, places) for runs of points that follow `first`, on all threads: each as its
  // ancestor on the level entered last has it.
  using Visit = std::function<void(std::size_t first, std::span<const Place> places)>;
  void visitAll(const Visit& visit, Monitor& monitor) const;

 private:
  bool isOpen(Index point) const { return task_.open.empty() || task_.open[point]; }
  void extend(std::size_t l, const std::vector<Place>& coarse, std::size_t first,
              std::span<Place> out) const;
  std::vector<Place> extended(std::size_t l, const std::vector<Place>& coarse,
                              Monitor& monitor) const;

  const SynthesisInput& input_;
  std::span<const SurfaceLevel> surface_;
  PlaceTask task_;
  PlaceDomain domain_;
  SiteWays ways_;
  std::size_t level_;
  std::vector<Place> places_;
};

}  // namespace dapple
