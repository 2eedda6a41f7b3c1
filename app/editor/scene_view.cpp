#include "app/editor/scene_view.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <iterator>
#include <limits>
#include <mutex>

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

// Whole words that hold nothing are passed over.
template <class F>
void forSelected(const PointMask& mask, const F& visit) {
  const auto words = mask.words();
  for (std::size_t w = 0; w < words.size(); ++w)
    for (std::uint64_t left = words[w]; left != 0; left &= left - 1)
      visit(64 * w + static_cast<std::size_t>(std::countr_zero(left)));
}

template <class T>
std::span<const T> spanOf(const Column<T>& column) {
  return column ? std::span<const T>(*column) : std::span<const T>();
}

}  // namespace

// What is drawn of one scan, whatever its colours.
struct SceneView::Scene {
  // Either: a scan, or the points of one that is being opened.
  std::shared_ptr<const OpenedScan> scan;
  std::shared_ptr<const PointSet> opening;
  std::vector<vec3> normals;  // of `opening` without any: 0
  std::vector<float> radii;
  Bounds bounds;
  float typicalRadius = 0;

  const void* of() const {
    return scan ? static_cast<const void*>(scan.get()) : static_cast<const void*>(opening.get());
  }
  const PointSet& points() const { return scan ? scan->prepared.scan.points : *opening; }
  SplatColumns columns(const std::vector<vec3>& colours, const std::vector<float>& shown) const {
    return {points().positions, normals.empty() ? points().normals : normals, colours, shown};
  }
};

// Where the other thread leaves what it has made.
struct SceneView::Made {
  std::mutex mutex;
  std::shared_ptr<Scene> scene;
};

// The texels that can be shown: of the one swatch that colours most points.
struct SceneView::Texels {
  Column<vec3> colour;  // of the results that they belong to
  std::shared_ptr<const OpenedScan> scan;
  std::shared_ptr<const ResultSource> source;  // null: there is nothing to show
  std::vector<vec2> texel;
  Column<TangentFrame> frame;
};

SceneView::SceneView(Workers& workers, std::function<void()> ready)
    : workers_(workers), ready_(std::move(ready)), live_(workers), picker_(workers) {}
SceneView::~SceneView() = default;

bool SceneView::opening() const {
  return scene_ && scene_->opening;
}

// Starts making ready what is to be shown next, unless something is being made ready.
void SceneView::prepare() {
  if (preparing_.valid()) return;
  const auto scene = std::make_shared<Scene>();
  scene->opening = snapshot_->opening;
  if (!scene->opening) scene->scan = snapshot_->document.scan;
  wanted_ = scene->scan ? std::shared_ptr<const void>(scene->scan) : scene->opening;
  made_ = std::make_shared<Made>();
  preparing_ = std::async(std::launch::async, [scene, made = made_, ready = ready_] {
    const std::vector<vec3>& positions = scene->points().positions;
    scene->bounds = boundsOf(positions);
    if (scene->scan) {
      scene->radii = splatRadii(scene->scan->prepared.neighborhoods, positions);
      scene->typicalRadius = dapple::splatRadius(scene->scan->prepared.spacing);
    } else {
      scene->typicalRadius = dapple::splatRadius(roughSpacing(positions));
      scene->radii.assign(positions.size(), scene->typicalRadius);
      if (scene->opening->normals.empty()) scene->normals.assign(positions.size(), vec3(0));
    }
    {
      const std::lock_guard lock(made->mutex);
      made->scene = scene;
    }
    if (ready) ready();
  });
}

void SceneView::takeScene() {
  if (!preparing_.valid()) return;
  std::shared_ptr<Scene> next;
  {
    const std::lock_guard lock(made_->mutex);
    next = std::move(made_->scene);
  }
  if (!next) return;
  preparing_.get();
  const bool first = !scene_;
  // The same points, now that their scan is open: whoever looked around meanwhile goes on.
  const bool goesOn =
      opening() && next->scan && scene_->points().positions == next->points().positions;
  scene_ = std::move(next);
  colours_.assign(scene_->points().size(), kBare);
  radii_.clear(), plain_.clear(), regions_.clear();
  stale_ = true;
  pending_.clear();
  if (first) camera_.setView("front");
  if (!goesOn) frameAll();
}

// Points of hidden regions have no size.
void SceneView::showVisible() {
  std::vector<float> radii = scene_->radii;
  if (const Document& document = snapshot_->document; scene_->scan) {
    std::array<bool, kMostRegions + 1> visible;
    visible.fill(true);
    for (const Region& region : *document.regions) visible[region.id] = region.visible;
    for (std::size_t i = 0; i < radii.size(); ++i)
      if (!visible[(*document.labels)[i]]) radii[i] = 0;
  }
  if (radii == radii_) return;
  radii_ = std::move(radii);
  const SplatColumns columns = scene_->columns(colours_, radii_);
  live_.update(columns);
  if (openGl_) openGl_->update(columns);
  texelsShown_ = false;
  stale_ = true;
  picker_.update(columns.positions, columns.normals, radii_);
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
  const void* const scan = snapshot_->opening
                               ? static_cast<const void*>(snapshot_->opening.get())
                               : static_cast<const void*>(snapshot_->document.scan.get());
  if (!scan) {
    takeScene();
    scene_ = nullptr, wanted_ = nullptr;
    stale_ = false;
    return;
  }
  takeScene();
  if (scan != wanted_.get()) prepare();
  // The points of a scan that has just been opened stay until it is ready to be shown.
  if (!scene_ || (scene_->of() != scan && !opening())) return;
  if (regions || radii_.empty()) {
    showVisible();
    regions_.clear();
    if (scene_->scan && snapshot_->document.regions->size() > 1)
      regions_.assign(snapshot_->document.labels->begin(), snapshot_->document.labels->end());
  }
  if (stale_) recolour();
  if (scene_->scan && scene_->scan == snapshot_->document.scan) followTexels();
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
  const std::vector<float> spacing =
      localSpacing(document.scan->prepared.neighborhoods, document.points().positions);
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

void SceneView::tint(std::size_t i) {
  colours_[i] += kTint * (kSelected - colours_[i]);
  plain_[i] = 1;
}

// What is pending is only added to while a tool is at work: that much is coloured at once.
void SceneView::setPending(const std::vector<Index>& points) {
  if (points == pending_ || (!points.empty() && points.back() >= colours_.size())) return;
  std::vector<Index> added;
  const bool grows = std::includes(points.begin(), points.end(), pending_.begin(), pending_.end());
  if (grows && scene_ && !stale_) {
    std::set_difference(points.begin(), points.end(), pending_.begin(), pending_.end(),
                        std::back_inserter(added));
    for (const Index i : added) tint(i);
    live_.recolour(colours_, plain_, added);
    if (openGl_) openGl_->recolour(colours_, plain_);
  } else {
    stale_ = true;
  }
  pending_ = points;
}

// By the view's settings, nothing selected.
void SceneView::baseColours() {
  missing_.clear();
  legend_.reset();
  if (opening()) {
    const std::vector<vec3>& own = scene_->points().colours;
    colours_.assign(scene_->points().size(), kBare);
    if (!own.empty()) colours_ = own;
    return;
  }
  const Document& document = snapshot_->document;
  const Results& results = document.results;
  const bool preview = snapshot_->previewColour != nullptr;
  const std::vector<vec3>& own = document.points().colours;
  const std::vector<vec3>* shown = preview          ? snapshot_->previewColour.get()
                                   : results.colour ? results.colour.get()
                                   : own.empty()    ? nullptr
                                                    : &own;
  if (isChannel(settings_.show) && !channelsKnown_) {
    Monitor monitor(workers_);
    channels_ = channelsOf(document, monitor);
    channelsKnown_ = true;
  }
  const auto scalar = [&](Channel channel) -> std::span<const float> {
    return channels_.scalar[static_cast<std::size_t>(channel)];
  };
  const auto takeShown = [&] {
    if (shown)
      colours_.assign(shown->begin(), shown->end());
    else
      colours_.assign(document.size(), kBare);
  };
  if (settings_.show == View::Regions) {
    colours_ = regionColours(document);
  } else if (settings_.show == View::Colour) {
    takeShown();
  } else {
    try {
      ViewColours view =
          viewColours(settings_.show,
                      {.colours = shown ? std::span<const vec3>(*shown) : std::span<const vec3>(),
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
                       .mappedNormals = channels_.normal});
      colours_ = std::move(view.colours), legend_ = view.legend;
    } catch (const InvalidInput&) {
      missing_ = "Nothing to show here yet: synthesize a region first.";
      takeShown();
    }
  }
}

void SceneView::recolour() {
  stale_ = false;
  baseColours();
  plain_.assign(colours_.size(), 0);
  if (scene_->scan) {
    if (const PointMask* selection = snapshot_->document.selection.get())
      forSelected(*selection, [&](std::size_t i) { tint(i); });
    for (const Index i : pending_) tint(i);
  }
  live_.recolour(colours_, plain_);
  if (openGl_) openGl_->recolour(colours_, plain_);
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
  openGl_->update(scene_->columns(colours_, radii_));
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
  if (opening() || !selection || selection->count() == 0) {
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
    textureBuffer_ = makeFramebuffer(*texture_, nullptr);
    flipped_.resize(raster.pixels.size());
  }
  const auto width = static_cast<std::size_t>(raster.width);
  for (std::size_t y = 0, rows = flipped_.size() / width; y < rows; ++y)
    std::copy_n(raster.pixels.data() + (rows - 1 - y) * width, width, flipped_.data() + y * width);
  glBindTexture(GL_TEXTURE_2D, texture_->id());
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, textureWidth_, textureHeight_, GL_RGBA, GL_UNSIGNED_BYTE,
                  flipped_.data());
  glBindTexture(GL_TEXTURE_2D, 0);
}

void SceneView::copyPicture(int left, int bottom) const {
  if (!textureBuffer_) return;
  GLint before = 0;
  glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &before);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, textureBuffer_->id());
  glDisable(GL_SCISSOR_TEST);
  glBlitFramebuffer(0, 0, textureWidth_, textureHeight_, left, bottom, left + textureWidth_,
                    bottom + textureHeight_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(before));
}

bool SceneView::draw(Viewport size, DetailPacer::Milliseconds budget) {
  const bool resized = size.width != size_.width || size.height != size_.height;
  const bool unseen = size_.width <= 1;
  size_ = size;
  if (!scene_) return false;
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
  return !complete_ || stale_ || findingTexels_.valid();
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
