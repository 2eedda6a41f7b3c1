#include "app/editor/scene_view.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>

#include "app/render/splats.h"
#include "base/errors.h"

namespace dapple {
namespace {

constexpr vec3 kSelected{1.0f, 0.62f, 0.22f};
constexpr float kTint = 0.45f;  // of the selection's colour over the point's own

// One region's points as the list shows them.
std::vector<vec3> regionColours(const Document& document) {
  std::array<vec3, kMostRegions + 1> colours;
  colours.fill(kBare);
  for (const Region& region : *document.regions) colours[region.id] = region.colour;
  std::vector<vec3> out(document.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = colours[(*document.labels)[i]];
  return out;
}

template <class T>
std::span<const T> spanOf(const Column<T>& column) {
  return column ? std::span<const T>(*column) : std::span<const T>();
}

}  // namespace

// What is drawn of one scan, whatever its colours.
struct SceneView::Scene {
  std::shared_ptr<const OpenedScan> scan;
  std::vector<float> radii;
  Bounds bounds;
  float typicalRadius = 0;

  const PointSet& points() const { return scan->prepared.scan.points; }
};

// The texels that can be shown: of the one swatch that colours most points.
struct SceneView::Texels {
  Column<vec3> colour;  // of the results that they belong to
  std::shared_ptr<const OpenedScan> scan;
  std::shared_ptr<const ResultSource> source;  // null: there is nothing to show
  std::vector<vec2> texel;
  Column<TangentFrame> frame;
};

SceneView::SceneView(Workers& workers) : workers_(workers), live_(workers), picker_(workers) {}
SceneView::~SceneView() = default;

void SceneView::takeScene() {
  if (!preparing_.valid() ||
      preparing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return;
  const bool first = !scene_;
  scene_ = preparing_.get();
  colours_.assign(scene_->points().size(), kBare);
  radii_.clear(), plain_.clear();
  stale_ = true;
  pending_.clear();
  if (first) camera_.setView("front");
  frameAll();
}

// Points of hidden regions have no size.
void SceneView::showVisible() {
  const Document& document = snapshot_->document;
  std::array<bool, kMostRegions + 1> visible;
  visible.fill(true);
  for (const Region& region : *document.regions) visible[region.id] = region.visible;
  std::vector<float> radii = scene_->radii;
  for (std::size_t i = 0; i < radii.size(); ++i)
    if (!visible[(*document.labels)[i]]) radii[i] = 0;
  if (radii == radii_) return;
  radii_ = std::move(radii);
  const PointSet& points = scene_->points();
  const SplatColumns columns{points.positions, points.normals, colours_, radii_};
  live_.update(columns);
  if (openGl_) openGl_->update(columns);
  texelsShown_ = false;
  stale_ = true;
  picker_.update(points.positions, points.normals, radii_);
}

void SceneView::follow(std::shared_ptr<const Snapshot> snapshot, const ViewSettings& settings) {
  const auto changed = [&](Part part) {
    return !snapshot_ || snapshot_->of(part) != snapshot->of(part);
  };
  const bool regions = changed(Part::Labels) || changed(Part::Regions);
  if (changed(Part::Scan) || changed(Part::Regions) || changed(Part::Colour) ||
      changed(Part::Texel))
    channels_ = {}, channelsKnown_ = false;
  stale_ |= !(settings == settings_) || changed(Part::Colour) || changed(Part::Labels) ||
            changed(Part::Selection) || changed(Part::Regions) || changed(Part::State) ||
            changed(Part::Preview);
  snapshot_ = std::move(snapshot);
  settings_ = settings;
  chooseRenderer();
  const std::shared_ptr<const OpenedScan>& scan = snapshot_->document.scan;
  if (!scan) {
    scene_ = nullptr, wanted_ = nullptr;
    stale_ = false;
    return;
  }
  if (scan != wanted_ && !preparing_.valid()) {
    wanted_ = scan;
    preparing_ = std::async(std::launch::async, [scan] {
      auto scene = std::make_shared<Scene>();
      scene->scan = scan;
      scene->radii = splatRadii(scan->prepared.neighborhoods);
      scene->bounds = boundsOf(scene->points().positions);
      scene->typicalRadius = dapple::splatRadius(scan->prepared.spacing);
      return scene;
    });
  }
  takeScene();
  if (!scene_ || scene_->scan != scan) return;
  if (regions || radii_.empty()) showVisible();
  if (stale_) recolour();
  followTexels();
}

std::shared_ptr<SceneView::Texels> SceneView::findTexels(const Document& document) {
  auto out = std::make_shared<Texels>();
  const Results& results = document.results;
  out->colour = results.colour, out->scan = document.scan, out->frame = results.frame;
  std::vector<std::size_t> counts(results.sources.size());
  for (const std::uint16_t s : *results.source)
    if (s != kNoSource) ++counts[s];
  for (std::size_t s = 0; s < counts.size(); ++s)
    if (results.sources[s]->partial) counts[s] = 0;
  const auto most = std::max_element(counts.begin(), counts.end());
  if (most == counts.end() || *most == 0) return out;
  const auto main = static_cast<std::uint16_t>(most - counts.begin());
  out->source = results.sources[main];
  const std::vector<float> spacing = localSpacing(document.scan->prepared.neighborhoods);
  out->texel = plainTexels({*results.texel, *results.colour, spacing}, *out->source->swatch,
                           out->source->unit);
  for (std::size_t i = 0; i < out->texel.size(); ++i)
    if ((*results.source)[i] != main) out->texel[i].x = std::numeric_limits<float>::quiet_NaN();
  return out;
}

// Finds the texels on another thread when the results are others, and shows them while they are
// those of the picture.
void SceneView::followTexels() {
  if (findingTexels_.valid() &&
      findingTexels_.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
    texels_ = findingTexels_.get();
  const Document& document = snapshot_->document;
  const Column<vec3>& colour = document.results.colour;
  const bool wanted =
      settings_.texels && settings_.show == View::Colour && colour && !snapshot_->previewColour;
  const bool found = texels_ && texels_->colour == colour;
  if (wanted && !found && !findingTexels_.valid())
    findingTexels_ = std::async(std::launch::async, [document] { return findTexels(document); });
  const bool show = wanted && found && texels_->source && texels_->scan == scene_->scan;
  if (show != texelsShown_) showTexels(show);
}

void SceneView::showTexels(bool show) {
  texelsShown_ = show;
  std::optional<SplatTexture> texture;
  if (show)
    texture.emplace(SplatTexture{*texels_->source->swatch, texels_->texel, *texels_->frame,
                                 texels_->source->unit});
  live_.retexture(texture ? &*texture : nullptr);
  if (openGl_) openGl_->retexture(texture ? &*texture : nullptr);
}

void SceneView::setPending(const std::vector<Index>& points) {
  if (points == pending_) return;
  pending_ = points;
  stale_ = true;
}

void SceneView::recolour() {
  stale_ = false;
  const Document& document = snapshot_->document;
  const Results& results = document.results;
  const bool preview = snapshot_->previewColour != nullptr;
  const std::vector<vec3> shown = preview ? *snapshot_->previewColour : shownColours(document);
  if (isChannel(settings_.show) && !channelsKnown_) {
    Monitor monitor(workers_);
    channels_ = channelsOf(document, monitor);
    channelsKnown_ = true;
  }
  const auto scalar = [&](Channel channel) -> std::span<const float> {
    return channels_.scalar[static_cast<std::size_t>(channel)];
  };
  const ViewColumns columns{
      .colours = shown,
      .normals = document.points().normals,
      .state = preview ? spanOf(snapshot_->previewState) : spanOf(results.state),
      .patch = spanOf(results.patch),
      .error = spanOf(results.error),
      .order = spanOf(results.order),
      .texel = spanOf(results.texel),
      .roughness = scalar(Channel::Roughness),
      .height = scalar(Channel::Height),
      .metallic = scalar(Channel::Metallic),
      .occlusion = scalar(Channel::Occlusion),
      .mappedNormals = channels_.normal};
  missing_.clear();
  legend_.reset();
  if (settings_.show == View::Regions) {
    colours_ = regionColours(document);
  } else {
    try {
      ViewColours view = viewColours(settings_.show, columns);
      colours_ = std::move(view.colours), legend_ = view.legend;
    } catch (const InvalidInput&) {
      missing_ = "Nothing to show here yet: synthesize a region first.";
      colours_ = shown;
    }
  }
  plain_.assign(colours_.size(), 0);
  const auto tint = [&](std::size_t i) {
    colours_[i] += kTint * (kSelected - colours_[i]);
    plain_[i] = 1;
  };
  if (const PointMask* selection = document.selection.get()) {
    for (std::size_t i = 0; i < colours_.size(); ++i)
      if (selection->has(i)) tint(i);
  }
  for (const Index i : pending_) tint(i);
  live_.recolour(colours_, plain_);
  if (openGl_) openGl_->recolour(colours_, plain_);
  regions_.clear();
  if (document.regions->size() > 1)
    regions_.assign(document.labels->begin(), document.labels->end());
}

void SceneView::chooseRenderer() {
  const bool wanted = settings_.drawnBy == DrawnBy::OpenGl ||
                      (settings_.drawnBy == DrawnBy::Automatic && !isSoftwareGl());
  if (wanted == openGl_.has_value()) return;
  uploaded_ = 0;
  openGl_.reset();
  if (!wanted) return;
  openGl_.emplace();
  if (!scene_) return;
  const PointSet& points = scene_->points();
  openGl_->update({points.positions, points.normals, colours_, radii_});
  openGl_->recolour(colours_, plain_);
  if (texelsShown_) showTexels(true);
}

GLuint SceneView::texture() const {
  if (openGl_) return openGl_->texture();
  return texture_ ? texture_->id() : 0;
}

void SceneView::frameAll() {
  if (scene_) camera_.frame(scene_->points().positions, size_);
}

void SceneView::frameSelection() {
  if (!scene_) return;
  const PointMask* selection = snapshot_->document.selection.get();
  if (!selection || selection->count() == 0) {
    frameAll();
    return;
  }
  std::vector<vec3> positions;
  for (const Index i : selection->points()) positions.push_back(scene_->points().positions[i]);
  camera_.frame(positions, size_);
}

void SceneView::upload() {
  const Raster& raster = live_.picture();
  if (!texture_ || textureWidth_ != raster.width || textureHeight_ != raster.height) {
    textureWidth_ = raster.width, textureHeight_ = raster.height;
    texture_ = makeTexture(GL_RGBA8, textureWidth_, textureHeight_);
  }
  glBindTexture(GL_TEXTURE_2D, texture_->id());
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, textureWidth_, textureHeight_, GL_RGBA, GL_UNSIGNED_BYTE,
                  raster.pixels.data());
  glBindTexture(GL_TEXTURE_2D, 0);
}

bool SceneView::draw(Viewport size, DetailPacer::Milliseconds budget) {
  const bool resized = size.width != size_.width || size.height != size_.height;
  const bool unseen = size_.width <= 1;
  size_ = size;
  if (!scene_) return loading();
  if (resized && unseen) frameAll();
  const SplatOptions options{
      .shading = settings_.show == View::Colour || settings_.show == View::Regions
                     ? settings_.shading
                     : Shading::Headlight,
      .background = settings_.background};
  const auto drawBy = [&](auto& view) {
    complete_ = view.frame(pictureCamera(), size.width, size.height, options, budget) ==
                LiveView::Progress::Complete;
  };
  if (openGl_) drawBy(*openGl_);
  // With OpenGL the processor's picture is only picked from: it can wait until the camera rests.
  if (!openGl_ || complete_) drawBy(live_);
  if (!openGl_ && live_.version() != uploaded_) upload();
  uploaded_ = live_.version();
  return !complete();
}

bool SceneView::complete() const {
  if (!snapshot_ || loading() || stale_ || findingTexels_.valid()) return false;
  return scene_ ? complete_ && scene_->scan == snapshot_->document.scan : !snapshot_->document.scan;
}

PickView SceneView::pickView(const Camera& camera, bool through) const {
  return {camera, picture().width, picture().height, through ? nullptr : &picture()};
}

float SceneView::splatRadius() const {
  return scene_ ? scene_->typicalRadius : 0;
}

Bounds SceneView::bounds() const {
  return scene_ ? scene_->bounds : Bounds{};
}

}  // namespace dapple
