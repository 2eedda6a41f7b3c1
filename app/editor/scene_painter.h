// Makes what the window shows of a snapshot ready on a thread of its own: of a million points that
// takes as long as a frame. The window's thread only exchanges it.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/render/cpu_splatter.h"
#include "app/render/level_order.h"
#include "app/render/picking.h"
#include "app/render/views.h"
#include "document/engine.h"

namespace dapple {

// What is drawn of one scan, whatever its colours. n elements a column.
struct SceneGeometry {
  // Either: a scan, or the points of one that is being opened.
  std::shared_ptr<const OpenedScan> scan;
  std::shared_ptr<const PointSet> opening;
  std::vector<vec3> normals;  // of `opening` without any: 0
  std::vector<float> radii;
  std::vector<vec3>
      around;  // some thousand points whose convex hull holds them all, and little more
  Bounds bounds;
  float typicalRadius = 0;
  LevelOrder levels;

  const void* of() const {
    return scan ? static_cast<const void*>(scan.get()) : static_cast<const void*>(opening.get());
  }
  const PointSet& points() const { return scan ? scan->prepared.scan.points : *opening; }
  SplatColumns columns(const std::vector<vec3>& colours, const std::vector<float>& shown) const {
    return {points().positions, normals.empty() ? points().normals : normals, colours, shown};
  }
};

// Of which SceneGeometry::of() is, or will be, in the picture of this snapshot; null: nothing is.
const void* shownPoints(const Snapshot& snapshot);

// What is to be seen.
struct SceneWish {
  std::shared_ptr<const Snapshot> snapshot;
  View show = View::Colour;
};

struct PaintedScene {
  std::uint64_t number = 0;  // of the wish
  SceneWish wish;
  std::shared_ptr<const SceneGeometry> geometry;
  std::shared_ptr<const std::vector<float>> radii;    // as drawn: 0 in hidden regions
  std::shared_ptr<const std::vector<Index>> regions;  // of each point; null: there is only one
  // Null: as in the last one.
  std::shared_ptr<SplatScene> splats;
  std::shared_ptr<const PickColumns> picked;
  std::vector<std::uint32_t> colours;  // as CpuSplatter::swapColours() takes them
  std::optional<HeatRange> legend;
  std::string missing;  // why the view that was asked for cannot be shown; empty: it is
};

// What lies over points that are selected, or about to be.
inline constexpr Tint kSelectedTint{{1.0f, 0.62f, 0.22f}, 0.45f};

class ScenePainter {
 public:
  // `ready`, if any, is called from the painter's thread when there is something to take().
  explicit ScenePainter(std::function<void()> ready);
  ~ScenePainter();

  // What is to be made next, in place of what has been asked for and is not begun; its snapshot has
  // points. Returns the wish's number: from 1, ever larger.
  std::uint64_t ask(SceneWish wish);
  // The last that has been made since the last call; null: none.
  std::unique_ptr<PaintedScene> take();
  // What is not shown any more, to be used again or let go by the painter's thread.
  void giveBack(std::unique_ptr<PaintedScene> used);

 private:
  class Studio;
  void serve();

  const std::function<void()> ready_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool quit_ = false;
  std::uint64_t asked_ = 0;
  std::optional<SceneWish> wish_;
  std::vector<std::shared_ptr<const Snapshot>> passedOver_;
  std::unique_ptr<PaintedScene> done_, used_;
  std::thread thread_;
};

}  // namespace dapple
