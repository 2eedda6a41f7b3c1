#include "app/editor/scene_painter.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "app/render/splats.h"
#include "base/errors.h"
#include "document/channels.h"

namespace dapple {
namespace {

constexpr std::size_t kChunk = 65536;  // points, a multiple of a mask's words
constexpr unsigned kThreads = 2;       // more would wait for the memory

// One region's points as the list shows them.
std::vector<vec3> regionColours(const Document& document) {
  std::array<vec3, kMostRegions + 1> colours;
  colours.fill(kBare);
  for (const Region& region : *document.regions) colours[region.id] = region.colour;
  std::vector<vec3> out(document.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = colours[(*document.labels)[i]];
  return out;
}

// Sides of the squares that points own, roughly, without neighbourhoods: from how near the nearest
// is among those that are near in the points' order, for some of them.
float roughSpacing(const std::vector<vec3>& positions) {
  constexpr std::size_t kAsked = 2048, kAround = 48;
  // Of points strewn at random the nearest is half of such a side away, on a grid a whole one; few
  // are not among those looked at.
  constexpr float kPerNearest = 1.6f;
  const std::size_t n = positions.size(), step = std::max<std::size_t>(1, n / kAsked);
  std::vector<float> nearest;
  for (std::size_t i = 0; i < n; i += step) {
    float least = std::numeric_limits<float>::infinity();
    for (std::size_t j = i - std::min(i, kAround); j < std::min(n, i + kAround + 1); ++j)
      if (j != i) least = std::min(least, distanceBetween(positions[i], positions[j]));
    nearest.push_back(least);
  }
  const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2);
  std::nth_element(nearest.begin(), middle, nearest.end());
  return kPerNearest * *middle;
}

// Corners of the boxes of points in a row, which lie together (Morton order); of few points
// themselves.
std::vector<vec3> pointsAround(const std::vector<vec3>& positions) {
  constexpr std::size_t kBoxes = 4096;
  const std::size_t n = positions.size(), row = (n + kBoxes - 1) / kBoxes;
  if (row <= 1) return positions;
  std::vector<vec3> around;
  for (std::size_t begin = 0; begin < n; begin += row) {
    vec3 low = positions[begin], high = low;
    for (std::size_t i = begin; i < std::min(n, begin + row); ++i)
      low = glm::min(low, positions[i]), high = glm::max(high, positions[i]);
    for (int corner = 0; corner < 8; ++corner)
      around.push_back(glm::mix(low, high, vec3(corner & 1, corner >> 1 & 1, corner >> 2)));
  }
  return around;
}

std::shared_ptr<const SceneGeometry> geometryOf(const Snapshot& snapshot) {
  auto out = std::make_shared<SceneGeometry>();
  out->opening = snapshot.opening;
  if (!out->opening) out->scan = snapshot.document.scan;
  const std::vector<vec3>& positions = out->points().positions;
  out->bounds = boundsOf(positions);
  out->around = pointsAround(positions);
  out->levels = levelOrder(positions.size());
  if (out->scan) {
    out->radii = splatRadii(out->scan->prepared.neighborhoods, positions);
    out->typicalRadius = splatRadius(out->scan->prepared.spacing);
  } else {
    out->typicalRadius = splatRadius(roughSpacing(positions));
    out->radii.assign(positions.size(), out->typicalRadius);
    if (out->opening->normals.empty()) out->normals.assign(positions.size(), vec3(0));
  }
  return out;
}

template <class T>
std::span<const T> spanOf(const Column<T>& column) {
  return column ? std::span<const T>(*column) : std::span<const T>();
}

// Colours by point: the document's own where they need not be copied.
struct PointColours {
  std::span<const vec3> shown;  // empty: all bare
  std::vector<vec3> made;       // that `shown` is of, or nothing
};

void show(std::vector<vec3> made, PointColours& out) {
  out.made = std::move(made);
  out.shown = out.made;
}

template <class Body>
void forChunks(Workers& workers, std::size_t n, const Body& body) {
  workers.run((n + kChunk - 1) / kChunk,
              [&](std::size_t c) { body(c * kChunk, std::min(n, (c + 1) * kChunk)); });
}

// By point. Whole words of the selection that hold nothing are passed over.
void pack(std::span<const vec3> colours, const PointMask* selection, Workers& workers,
          std::vector<std::uint32_t>& packed) {
  forChunks(workers, packed.size(), [&](std::size_t begin, std::size_t end) {
    if (colours.empty())
      std::fill(packed.begin() + begin, packed.begin() + end, packedColour(kBare));
    else
      std::transform(colours.begin() + begin, colours.begin() + end, packed.begin() + begin,
                     [](const vec3& colour) { return packedColour(colour); });
    if (!selection) return;
    for (std::size_t w = begin / 64; 64 * w < end; ++w)
      for (std::uint64_t left = selection->words()[w]; left != 0; left &= left - 1) {
        std::uint32_t& own = packed[64 * w + static_cast<std::size_t>(std::countr_zero(left))];
        own = kSelectedTint.over(own);
      }
  });
}

}  // namespace

const void* shownPoints(const Snapshot& snapshot) {
  return snapshot.opening ? static_cast<const void*>(snapshot.opening.get())
                          : static_cast<const void*>(snapshot.document.scan.get());
}

// What the painter's thread keeps from one scene to the next.
class ScenePainter::Studio {
 public:
  void paint(PaintedScene& out) {
    const Snapshot& snapshot = *out.wish.snapshot;
    out.splats = nullptr, out.picked = nullptr;
    out.legend.reset(), out.missing.clear();
    if (!geometry_ || geometry_->of() != shownPoints(snapshot)) {
      geometry_ = geometryOf(snapshot);
      radii_ = nullptr, labels_ = nullptr, channelsOf_ = {};
    }
    followRegions(snapshot.document, out);
    PointColours colours;
    findColours(out, colours);
    const PointMask* selection = geometry_->scan ? snapshot.document.selection.get() : nullptr;
    const std::vector<Index>& order = geometry_->levels.order;
    packed_.resize(order.size()), out.colours.resize(order.size());
    pack(colours.shown, selection, workers_, packed_);
    forChunks(workers_, order.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) out.colours[i] = packed_[order[i]];
    });
    out.geometry = geometry_, out.radii = radii_, out.regions = regions_;
  }

 private:
  // Points of hidden regions have no size.
  void followRegions(const Document& document, PaintedScene& out) {
    std::array<bool, kMostRegions + 1> visible;
    visible.fill(true);
    if (geometry_->scan)
      for (const Region& region : *document.regions) visible[region.id] = region.visible;
    const bool same = radii_ && visible == visible_ && document.labels == labels_;
    const bool several = geometry_->scan && document.regions->size() > 1;
    if (same && several == (regions_ != nullptr)) return;
    auto radii = std::make_shared<std::vector<float>>(geometry_->radii);
    if (geometry_->scan)
      for (std::size_t i = 0; i < radii->size(); ++i)
        if (!visible[(*document.labels)[i]]) (*radii)[i] = 0;
    const bool shows = !radii_ || *radii != *radii_;
    visible_ = visible, labels_ = document.labels;
    regions_ = several
                   ? std::make_shared<const std::vector<Index>>(labels_->begin(), labels_->end())
                   : nullptr;
    if (!shows) return;
    radii_ = std::move(radii);
    const std::vector<vec3> bare(radii_->size(), kBare);
    SplatColumns columns = geometry_->columns(bare, *radii_);
    columns.order = &geometry_->levels.order;
    out.splats = makeSplatScene(columns, workers_);
    out.picked = makePickColumns(columns.positions, columns.normals, *radii_);
  }

  const PointChannels& channels(const Snapshot& snapshot) {
    const std::array of{snapshot.of(Part::Scan), snapshot.of(Part::Regions),
                        snapshot.of(Part::Colour), snapshot.of(Part::Texel)};
    if (channelsOf_ == of) return channels_;
    Monitor monitor(workers_);
    channels_ = dapple::channelsOf(snapshot.document, monitor);
    channelsOf_ = of;
    return channels_;
  }

  // By the view, nothing selected.
  void findColours(PaintedScene& out, PointColours& colours) {
    const Snapshot& snapshot = *out.wish.snapshot;
    if (geometry_->opening) {
      colours.shown = geometry_->opening->colours;
      return;
    }
    const Document& document = snapshot.document;
    const bool preview = snapshot.previewColour != nullptr;
    colours.shown = preview                   ? spanOf(snapshot.previewColour)
                    : document.results.colour ? spanOf(document.results.colour)
                                              : std::span(document.points().colours);
    if (out.wish.show == View::Colour) return;
    if (out.wish.show == View::Regions) return show(regionColours(document), colours);
    try {
      ViewColours view = viewColours(out.wish.show, viewColumns(out.wish, colours.shown));
      out.legend = view.legend;
      show(std::move(view.colours), colours);
    } catch (const InvalidInput&) {
      out.missing = "Nothing to show here yet: synthesize a region first.";
    }
  }

  ViewColumns viewColumns(const SceneWish& wish, std::span<const vec3> shown) {
    const Snapshot& snapshot = *wish.snapshot;
    const Results& results = snapshot.document.results;
    ViewColumns columns{
        .colours = shown,
        .normals = snapshot.document.points().normals,
        .state = spanOf(snapshot.previewColour ? snapshot.previewState : results.state),
        .patch = spanOf(results.patch),
        .error = spanOf(results.error),
        .order = spanOf(results.order),
        .texel = spanOf(results.texel)};
    if (!isChannel(wish.show)) return columns;
    const PointChannels& made = channels(snapshot);
    const auto scalar = [&](Channel channel) -> std::span<const float> {
      return made.scalar[static_cast<std::size_t>(channel)];
    };
    columns.roughness = scalar(Channel::Roughness);
    columns.height = scalar(Channel::Height);
    columns.metallic = scalar(Channel::Metallic);
    columns.occlusion = scalar(Channel::Occlusion);
    columns.mappedNormals = made.normal;
    return columns;
  }

  Workers workers_{kThreads};
  std::vector<std::uint32_t> packed_;  // by point
  std::shared_ptr<const SceneGeometry> geometry_;
  std::array<bool, kMostRegions + 1> visible_{};
  Column<RegionId> labels_;
  std::shared_ptr<const std::vector<float>> radii_;
  std::shared_ptr<const std::vector<Index>> regions_;
  PointChannels channels_;
  std::array<std::uint64_t, 4> channelsOf_{};  // versions that they were made of
};

ScenePainter::ScenePainter(std::function<void()> ready)
    : ready_(std::move(ready)), thread_([this] { serve(); }) {}

ScenePainter::~ScenePainter() {
  {
    const std::lock_guard lock(mutex_);
    quit_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

std::uint64_t ScenePainter::ask(SceneWish wish) {
  std::uint64_t number = 0;
  {
    const std::lock_guard lock(mutex_);
    // It may be the last to hold large columns: those are let go by the other thread.
    if (wish_) passedOver_.push_back(std::move(wish_->snapshot));
    wish_ = std::move(wish);
    number = ++asked_;
  }
  wake_.notify_all();
  return number;
}

std::unique_ptr<PaintedScene> ScenePainter::take() {
  const std::lock_guard lock(mutex_);
  return std::move(done_);
}

void ScenePainter::giveBack(std::unique_ptr<PaintedScene> used) {
  const std::lock_guard lock(mutex_);
  if (used_) return;
  used_ = std::move(used);
  wake_.notify_all();
}

void ScenePainter::serve() {
  Studio studio;
  // What it showed last is kept till the next: the window's thread has let go of it by then.
  SceneWish last;
  std::vector<std::uint32_t> colours;
  for (;;) {
    auto next = std::make_unique<PaintedScene>();
    std::unique_ptr<PaintedScene> used;
    std::vector<std::shared_ptr<const Snapshot>> passedOver;
    bool wished = false;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [&] { return quit_ || wish_ || used_; });
      if (quit_) return;
      used = std::move(used_);
      passedOver.swap(passedOver_);
      wished = wish_.has_value();
      if (wished) next->wish = std::move(*wish_), next->number = asked_;
      wish_.reset();
    }
    if (used) colours = std::move(used->colours);
    used.reset(), passedOver.clear();
    if (!wished) continue;
    next->colours = std::move(colours);
    colours = {};
    studio.paint(*next);
    last = next->wish;
    {
      const std::lock_guard lock(mutex_);
      // What nobody has taken is now the older one; its points may be those of this one.
      if (done_ && !next->splats)
        next->splats = std::move(done_->splats), next->picked = std::move(done_->picked);
      done_.swap(next);
    }
    if (ready_) ready_();
  }
}

}  // namespace dapple
