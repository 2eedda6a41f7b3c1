#include "app/editor/scene_view.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <limits>
#include <mutex>

#include "app/render/splats.h"
#include "base/errors.h"

namespace dapple {

// The texels that can be shown: of the one swatch that colours most points.
struct SceneView::Texels {
  Column<vec3> colour;  // of the results that they belong to
  std::shared_ptr<const OpenedScan> scan;
  std::shared_ptr<const ResultSource> source;  // null: there is nothing to show
  std::vector<vec2> texel;
  Column<TangentFrame> frame;
  Column<float> scale;
  std::shared_ptr<const SplatTexels> drawn;

  SplatTexture texture() const {
    return {.swatch = *source->swatch,
            .texel = texel,
            .frame = *frame,
            .unit = source->unit,
            .scale = scale.get()};
  }
};

// Where the other thread leaves them.
struct SceneView::FoundTexels {
  std::mutex mutex;
  std::shared_ptr<Texels> texels;
};

SceneView::SceneView(Workers& workers, std::function<void()> ready)
    : workers_(workers), ready_(ready), painter_(ready), live_(workers), picker_(workers) {}
SceneView::~SceneView() = default;

bool SceneView::opening() const {
  return scene_ && (!scene_->scan || scene_->scan != snapshot_->document.scan);
}

void SceneView::ask() {
  if (shownPoints(*snapshot_)) asked_ = painter_.ask({snapshot_, settings_.show});
}

void SceneView::follow(std::shared_ptr<const Snapshot> snapshot, const ViewSettings& settings) {
  constexpr Part kSeen[] = {Part::Scan,  Part::Labels,    Part::Regions, Part::Colour,
                            Part::State, Part::Selection, Part::Preview, Part::Texel};
  const bool changed =
      !snapshot_ || snapshot_->opening != snapshot->opening || settings.show != settings_.show ||
      std::any_of(std::begin(kSeen), std::end(kSeen),
                  [&](Part part) { return snapshot_->of(part) != snapshot->of(part); });
  snapshot_ = std::move(snapshot);
  settings_ = settings;
  chooseRenderer();
  if (changed) ask();
  takePainted();
  if (!shownPoints(*snapshot_)) {
    scene_ = nullptr;
    painted_ = asked_;
  }
  if (scene_ && !opening()) followTexels();
}

// Exchanges what is shown for what the painter has made.
void SceneView::takePainted() {
  std::unique_ptr<PaintedScene> painted = painter_.take();
  if (!painted) return;
  painted_ = painted->number;
  paintedVersion_ = painted->wish.snapshot->version;
  takeGeometry(*painted);
  if (painted->splats) {
    live_.show(std::move(painted->splats), scene_->levels);
    picker_.show(std::move(painted->picked));
    radii_ = painted->radii;
    texelsShown_ = false;
    updateOpenGl();
  }
  live_.swapColours(painted->colours);
  regions_ = painted->regions;
  legend_ = painted->legend, missing_ = painted->missing;
  if (pendingUntil_ && paintedVersion(Part::Selection) >= *pendingUntil_)
    pending_.clear(), pendingUntil_.reset();
  live_.tint(pending_, kSelectedTint);
  if (openGl_) openGl_->recolour(live_.colours());
  painter_.giveBack(std::move(painted));
}

void SceneView::takeGeometry(const PaintedScene& painted) {
  if (painted.geometry == scene_) return;
  const bool first = !scene_;
  // The same points, now that their scan is open: whoever looked around meanwhile goes on.
  const bool goesOn = !first && !scene_->scan && painted.geometry->scan &&
                      scene_->points().positions == painted.geometry->points().positions;
  scene_ = painted.geometry;
  pending_.clear(), pendingUntil_.reset();
  if (first) camera_.setView("front");
  if (!goesOn) frameAll();
}

std::shared_ptr<SceneView::Texels> SceneView::findTexels(const Document& document,
                                                         const std::vector<Index>& order) {
  auto out = std::make_shared<Texels>();
  const Results& results = document.results;
  out->colour = results.colour, out->scan = document.scan, out->frame = results.frame;
  out->scale = results.scale;
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
  const std::span<const float> scale =
      results.scale ? std::span<const float>(*results.scale) : std::span<const float>();
  out->texel = plainTexels({*results.texel, *results.colour, spacing, scale}, *out->source->swatch,
                           out->source->unit);
  for (std::size_t i = 0; i < out->texel.size(); ++i)
    if ((*results.source)[i] != main) out->texel[i].x = std::numeric_limits<float>::quiet_NaN();
  Workers alone(1);
  out->drawn = makeSplatTexels(out->texture(), &order, alone);
  return out;
}

void SceneView::takeTexels() {
  if (!findingTexels_.valid()) return;
  std::shared_ptr<Texels> found;
  {
    const std::lock_guard lock(foundTexels_->mutex);
    found = std::move(foundTexels_->texels);
  }
  if (!found) return;
  findingTexels_.get();
  texels_ = std::move(found);
}

// Finds the texels on another thread when the results are others, and shows them while they are
// those of the picture.
void SceneView::followTexels() {
  takeTexels();
  const Document& document = snapshot_->document;
  const Column<vec3>& colour = document.results.colour;
  const bool wanted =
      settings_.texels && settings_.show == View::Colour && colour && !snapshot_->previewColour;
  const bool found = texels_ && texels_->colour == colour;
  if (wanted && !found && !findingTexels_.valid()) {
    foundTexels_ = std::make_shared<FoundTexels>();
    // The old ones, if they are not shown, are let go there, too.
    findingTexels_ = std::async(
        std::launch::async, [document, scene = scene_, to = foundTexels_, ready = ready_,
                             old = texelsShown_ ? nullptr : std::move(texels_)]() mutable {
          old.reset();
          std::shared_ptr<Texels> made = findTexels(document, scene->levels.order);
          {
            const std::lock_guard lock(to->mutex);
            to->texels = std::move(made);
          }
          if (ready) ready();
        });
  }
  const bool show = wanted && found && texels_->source && texels_->scan == scene_->scan;
  if (show != texelsShown_) showTexels(show);
}

void SceneView::showTexels(bool show) {
  texelsShown_ = show;
  live_.show(show ? texels_->drawn : nullptr);
  if (!openGl_) return;
  if (show) {
    const SplatTexture texture = texels_->texture();
    openGl_->retexture(&texture);
  } else {
    openGl_->retexture(nullptr);
  }
}

// What is pending is only added to while a tool is at work: that much is coloured at once.
void SceneView::setPending(const std::vector<Index>& points) {
  if (points == pending_ || (!points.empty() && points.back() >= radii_->size())) return;
  const bool grows = std::includes(points.begin(), points.end(), pending_.begin(), pending_.end());
  if (grows && scene_) {
    std::vector<Index> added;
    std::set_difference(points.begin(), points.end(), pending_.begin(), pending_.end(),
                        std::back_inserter(added));
    live_.tint(added, kSelectedTint);
    if (openGl_) openGl_->recolour(live_.colours());
  } else {
    ask();
  }
  pending_ = points;
  pendingUntil_.reset();
}

void SceneView::submitPending() {
  pendingUntil_ = snapshot_->of(Part::Selection) + 1;
}

void SceneView::updateOpenGl() {
  if (!openGl_ || !scene_) return;
  const std::vector<vec3> bare(radii_->size(), kBare);  // until recolour()
  openGl_->update(scene_->columns(bare, *radii_));
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
  updateOpenGl();
  openGl_->recolour(live_.colours());
  if (texelsShown_) showTexels(true);
}

GLuint SceneView::texture() const {
  if (openGl_) return openGl_->texture();
  return texture_ ? texture_->id() : 0;
}

void SceneView::frameAll() {
  if (scene_) camera_.frame(scene_->around, size_);
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

bool SceneView::draw(Viewport size, DetailPacer::Milliseconds budget, bool passing) {
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
    if (passing && view.shows(pictureCamera(), size.width, size.height, options)) return;
    complete_ = view.frame(pictureCamera(), size.width, size.height, options, budget) ==
                LiveView::Progress::Complete;
  };
  if (openGl_) drawBy(*openGl_);
  // With OpenGL the processor's picture is only picked from: it can wait until the camera rests.
  if (!openGl_ || complete_) drawBy(live_);
  if (!openGl_ && live_.version() != uploaded_) upload();
  uploaded_ = live_.version();
  // Whoever is told when something is ready need not ask again and again.
  return (!complete_ && !passing) || (!ready_ && (painted_ != asked_ || findingTexels_.valid()));
}

bool SceneView::complete() const {
  if (!snapshot_ || painted_ != asked_ || findingTexels_.valid()) return false;
  return scene_ ? complete_ && !opening() : !snapshot_->document.scan;
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
