// Zwicker, Pfister, van Baar, Gross: Surface Splatting, 2001; Botsch, Hornung, Zwicker, Kobbelt:
// High-Quality Surface Splatting on Today's GPUs, 2005. Departures:
// - The low-pass is the smaller of the two distances (2005, section 4), not a convolution.
// - Colours are mixed after shading (one accumulator instead of two): the light moves with the eye
//   and varies slowly, and the second accumulator costs 15 % on software GL.
// - Small discs are point sprites whose image is an ellipse; large ones are squares in object
//   space, exact in any perspective, whose depth needs no fragment's help.
// - What earlier splats hide is not drawn at all where a processor does OpenGL's work.
#include "app/render/splat_renderer.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <optional>
#include <span>

#include "app/render/gl_objects.h"
#include "app/render/splat_buffers.h"
#include "app/render/splat_chunks.h"
#include "base/errors.h"
#include "base/simd.h"

namespace dapple {
namespace {

constexpr int kTile = 2048;  // samples: 150 MB of textures, whatever the picture's size
// Samples, the radius of a chunk's largest splat.
constexpr float kFlatUpTo = 3, kSpriteUpTo = 32;

// Sprites all of whose fragments are as deep as their centre, sprites that know their plane, and
// squares in object space: the larger the slower, on software GL.
enum Shape { kFlatSprites, kSprites, kDiscs, kShapes };

struct Variant {
  Shape shape;
  bool visibility, textured;
};

GlProgram splatProgram(const Variant& variant) {
  std::vector<std::string_view> defines;
  if (variant.visibility) defines.push_back("VISIBILITY");
  if (variant.textured) defines.push_back("TEXTURED");
  if (variant.shape == kSprites) defines.push_back("PLANE");
  if (variant.shape != kDiscs) {
    const GlStage stages[] = {{GL_VERTEX_SHADER, "sprite.vert", "light.glsl"},
                              {GL_FRAGMENT_SHADER, "sprite.frag", "kernel.glsl"}};
    return GlProgram(stages, defines);
  }
  const GlStage stages[] = {{GL_VERTEX_SHADER, "disc.vert", "light.glsl"},
                            {GL_GEOMETRY_SHADER, "disc.geom", "light.glsl"},
                            {GL_FRAGMENT_SHADER, "disc.frag", "kernel.glsl"}};
  return GlProgram(stages, defines);
}

GlProgram resolveProgram(int samples) {
  constexpr std::string_view kSamples[] = {"SAMPLES 1", "SAMPLES 2", "SAMPLES 3", "SAMPLES 4"};
  const GlStage stages[] = {{GL_VERTEX_SHADER, "resolve.vert", ""},
                            {GL_FRAGMENT_SHADER, "resolve.frag", ""}};
  return GlProgram(stages, {kSamples + samples - 1, 1});
}

// The picture in samples, as the shaders see it.
struct Frame {
  SplatLens lens;
  glm::vec2 centre;
  const SplatOptions& options;
  std::size_t count = 0;  // points
  std::vector<ChunkImage> images;
  int tileWidth = 0, tileHeight = 0;  // pixels
};

struct Tile {
  int x, y, width, height;  // pixels, y upwards
};

// Where the samples of a tile are added up.
struct Samples {
  int width, height;
  GlTexture accumulated, depth;
  GlFramebuffer framebuffer;

  Samples(int w, int h)
      : width(w),
        height(h),
        accumulated(makeTexture(GL_RGBA32F, w, h)),
        depth(makeTexture(GL_DEPTH_COMPONENT32F, w, h)),
        framebuffer(makeFramebuffer(accumulated, &depth)) {}
};

// A picture to read back.
struct Pixels {
  int width, height;
  GlTexture colour;
  GlFramebuffer framebuffer;

  Pixels(int w, int h)
      : width(w),
        height(h),
        colour(makeTexture(GL_RGBA8, w, h)),
        framebuffer(makeFramebuffer(colour, nullptr)) {}
};

// Ranges of points, each shape's.
struct Ranges {
  std::vector<GLint> first[kShapes];
  std::vector<GLsizei> count[kShapes];

  void add(Shape shape, std::size_t begin, std::size_t end) {
    auto& firsts = first[shape];
    auto& counts = count[shape];
    if (!firsts.empty() && firsts.back() + counts.back() == static_cast<GLint>(begin)) {
      counts.back() += static_cast<GLsizei>(end - begin);
      return;
    }
    firsts.push_back(static_cast<GLint>(begin));
    counts.push_back(static_cast<GLsizei>(end - begin));
  }
};

Frame frameOf(const Camera& camera, int width, int height, const SplatOptions& options) {
  const auto high = static_cast<float>(height * options.samples);
  Frame frame{.lens = {.view = viewMatrix(camera),
                       .orthographic = camera.orthographicHeight > 0,
                       .nearest = camera.nearPlane,
                       .farthest = camera.farPlane,
                       .lowPass = options.lowPass * static_cast<float>(options.samples),
                       .enlarge = options.enlarge},
              .centre = 0.5f * static_cast<float>(options.samples) * glm::vec2(width, height),
              .options = options};
  frame.lens.focal = frame.lens.orthographic ? high / camera.orthographicHeight
                                             : 0.5f * high / std::tan(0.5f * camera.verticalFov);
  return frame;
}

Shape shapeOf(const ChunkImage& image, float lowPass) {
  if (std::max(image.radius, lowPass) > kSpriteUpTo) return kDiscs;
  return image.radius > kFlatUpTo ? kSprites : kFlatSprites;
}

void add(const Frame& frame, std::size_t chunk, Ranges& ranges) {
  const std::size_t begin = chunk * SplatChunk::kPoints;
  ranges.add(shapeOf(frame.images[chunk], frame.lens.lowPass), begin,
             std::min(frame.count, begin + SplatChunk::kPoints));
}

SampleBox boxOf(const Frame& frame, const Tile& tile) {
  const int perPixel = frame.options.samples;
  const glm::vec2 low = glm::vec2(tile.x * perPixel, tile.y * perPixel) - frame.centre;
  return {low, low + glm::vec2(tile.width * perPixel, tile.height * perPixel)};
}

bool overlap(const SampleBox& a, const SampleBox& b) {
  return glm::all(glm::lessThanEqual(a.low, b.high)) && glm::all(glm::lessThanEqual(b.low, a.high));
}

// draw(tile) for each tile of the picture.
template <class Draw>
void forTiles(const Frame& frame, int width, int height, const Draw& draw) {
  for (int y = 0; y < height; y += frame.tileHeight)
    for (int x = 0; x < width; x += frame.tileWidth)
      draw(
          Tile{x, y, std::min(frame.tileWidth, width - x), std::min(frame.tileHeight, height - y)});
}

void unbindAll() {
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glBindTexture(GL_TEXTURE_2D, 0);
  glBindVertexArray(0);
  glUseProgram(0);
}

DAPPLE_CLONES void toFloats(std::span<const std::uint8_t> bytes, float* out) {
  for (std::size_t k = 0; k < bytes.size(); ++k) out[k] = static_cast<float>(bytes[k]) / 255;
}

}  // namespace

struct SplatRenderer::Pipeline {
  // [shape][visibility][textured], compiled when first needed.
  std::optional<GlProgram> splats[kShapes][2][2];
  std::optional<GlProgram> resolves[4];  // by the samples along a pixel's side, less one
  GlVertexArray nothing;
  std::vector<Index> order;  // of the columns; empty: as they are
  SplatBuffers buffers;
  std::vector<SplatChunk> chunks;
  std::size_t count = 0;
  std::optional<Samples> samples;
  std::optional<Pixels> pixels;
  bool software = isSoftwareGl();
  std::vector<float> depths;  // kept for its memory
  DepthPyramid pyramid;

  const GlProgram& program(const Variant& variant);
  void setUniforms(const GlProgram& program, const Frame& frame, const Tile& tile, Shape shape);
  void drawRanges(const Ranges& ranges, const Frame& frame, const Tile& tile, bool visibility);
  void dropHidden(const Frame& frame, const SampleBox& box, std::vector<std::size_t>& seen);
  void drawVisibility(const Frame& frame, const Tile& tile, std::vector<std::size_t>& seen);
  void drawTile(const Frame& frame, const Tile& tile);
  void resolveTile(const Frame& frame, const Tile& tile, const SplatTarget& target);
  Frame prepare(const Camera& camera, int width, int height, const SplatOptions& options);
};

const GlProgram& SplatRenderer::Pipeline::program(const Variant& variant) {
  auto& slot = splats[variant.shape][variant.visibility][variant.textured];
  if (!slot) slot = splatProgram(variant);
  return *slot;
}

void SplatRenderer::Pipeline::setUniforms(const GlProgram& program, const Frame& frame,
                                          const Tile& tile, Shape shape) {
  const SplatLens& lens = frame.lens;
  // From the view axis, so that no rounding depends on the picture's size.
  const SampleBox box = boxOf(frame, tile);
  const glm::vec2 origin = box.low, size = box.high - box.low;
  // A sprite goes with its centre: the viewport reaches beyond the tile by half the largest one.
  const float guard = shape == kDiscs ? 0.f : std::ceil(kSpriteUpTo) + 2;
  const glm::vec4 viewport(origin - guard, size + 2 * guard);
  glViewport(static_cast<GLint>(-guard), static_cast<GLint>(-guard),
             static_cast<GLsizei>(viewport.z), static_cast<GLsizei>(viewport.w));
  glUniformMatrix4fv(program.uniform("localToView"), 1, GL_FALSE, glm::value_ptr(lens.view));
  glUniform2f(program.uniform("focal"), lens.focal, lens.focal);
  glUniform1i(program.uniform("orthographic"), lens.orthographic ? 1 : 0);
  glUniform4fv(program.uniform("viewport"), 1, glm::value_ptr(viewport));
  glUniform2fv(program.uniform("tileOrigin"), 1, glm::value_ptr(origin));
  glUniform2f(program.uniform("depthRange"), lens.nearest, lens.farthest);
  glUniform1f(program.uniform("lowPass"), lens.lowPass);
  glUniform1f(program.uniform("perLowPass2"), 1 / (lens.lowPass * lens.lowPass));
  glUniform1i(program.uniform("shading"), static_cast<int>(frame.options.shading));
  glUniform1f(program.uniform("enlarge"), lens.enlarge);
  const vec3 towardsKey = glm::normalize(kStudioLight.towardsKey);
  glUniform3fv(program.uniform("towardsKey"), 1, glm::value_ptr(towardsKey));
  glUniform3fv(program.uniform("keyLight"), 1, glm::value_ptr(kStudioLight.key));
  glUniform3fv(program.uniform("skyLight"), 1, glm::value_ptr(kStudioLight.sky));
  glUniform3fv(program.uniform("rimLight"), 1, glm::value_ptr(kStudioLight.rim));
  glUniform1f(program.uniform("skyBelow"), kStudioLight.below);
  glUniform1f(program.uniform("longestStep"), buffers.longestStep());
  glUniform1i(program.uniform("swatch"), 0);
  const glm::vec2 perSize = 1.f / buffers.swatchSize();
  glUniform2fv(program.uniform("perSwatchSize"), 1, glm::value_ptr(perSize));
}

void SplatRenderer::Pipeline::drawRanges(const Ranges& ranges, const Frame& frame, const Tile& tile,
                                         bool visibility) {
  for (const Shape shape : {kFlatSprites, kSprites, kDiscs}) {
    if (ranges.first[shape].empty()) continue;
    const bool textured = buffers.swatch().has_value() && !visibility;
    const GlProgram& used = program({shape, visibility, textured});
    glUseProgram(used.id());
    setUniforms(used, frame, tile, shape);
    if (textured) glBindTexture(GL_TEXTURE_2D, buffers.swatch()->id());
    glMultiDrawArrays(GL_POINTS, ranges.first[shape].data(), ranges.count[shape].data(),
                      static_cast<GLsizei>(ranges.first[shape].size()));
  }
}

// Of the chunks `seen` those that what is drawn so far does not hide.
void SplatRenderer::Pipeline::dropHidden(const Frame& frame, const SampleBox& box,
                                         std::vector<std::size_t>& seen) {
  const auto width = static_cast<int>(box.high.x - box.low.x);
  const auto height = static_cast<int>(box.high.y - box.low.y);
  depths.resize(static_cast<std::size_t>(width) * height);
  glReadPixels(0, 0, width, height, GL_DEPTH_COMPONENT, GL_FLOAT, depths.data());
  pyramid.build(depths, width, height);
  const float perDepth = 1 / (frame.lens.farthest - frame.lens.nearest);
  std::erase_if(seen, [&](std::size_t k) {
    const ChunkImage& image = frame.images[k];
    return pyramid.hides({image.box.low - box.low, image.box.high - box.low},
                         (image.nearest - frame.lens.nearest) * perDepth);
  });
}

// The nearest surface, moved back so that all splats of one surface pass. Drops what it hides: on
// software OpenGL a splat costs more than asking, and those that look away are most likely hidden.
void SplatRenderer::Pipeline::drawVisibility(const Frame& frame, const Tile& tile,
                                             std::vector<std::size_t>& seen) {
  Ranges first, rest;
  for (const std::size_t k : seen)
    if (!software || !frame.images[k].away) add(frame, k, first);
  drawRanges(first, frame, tile, true);
  if (!software) return;
  dropHidden(frame, boxOf(frame, tile), seen);
  for (const std::size_t k : seen)
    if (frame.images[k].away) add(frame, k, rest);
  drawRanges(rest, frame, tile, true);
}

void SplatRenderer::Pipeline::drawTile(const Frame& frame, const Tile& tile) {
  const SampleBox box = boxOf(frame, tile);
  std::vector<std::size_t> seen;
  for (std::size_t k = 0; k < frame.images.size(); ++k)
    if (frame.images[k].drawn && overlap(frame.images[k].box, box)) seen.push_back(k);

  // 1. Visibility.
  glBindFramebuffer(GL_FRAMEBUFFER, samples->framebuffer.id());
  glBindVertexArray(buffers.array());
  glEnable(GL_PROGRAM_POINT_SIZE);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_DEPTH_CLAMP);  // discs reach before the near plane
  for (const GLenum of : {GL_BLEND, GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_CULL_FACE}) glDisable(of);
  glActiveTexture(GL_TEXTURE0);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_TRUE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glClearColor(0, 0, 0, 0);
  glClearDepth(1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  drawVisibility(frame, tile, seen);

  // 2. Accumulation of what lies in front of that.
  Ranges all;
  for (const std::size_t k : seen) add(frame, k, all);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_FALSE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  drawRanges(all, frame, tile, false);
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_DEPTH_CLAMP);
  glDisable(GL_PROGRAM_POINT_SIZE);
  glDepthMask(GL_TRUE);
}

// 3. Normalisation.
void SplatRenderer::Pipeline::resolveTile(const Frame& frame, const Tile& tile,
                                          const SplatTarget& target) {
  std::optional<GlProgram>& resolve = resolves[frame.options.samples - 1];
  if (!resolve) resolve = resolveProgram(frame.options.samples);
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  glBindVertexArray(nothing.id());
  glViewport(target.x, target.y, tile.width, tile.height);
  glUseProgram(resolve->id());
  glBindTexture(GL_TEXTURE_2D, samples->accumulated.id());
  glUniform1i(resolve->uniform("accumulated"), 0);
  glUniform2f(resolve->uniform("size"), static_cast<float>(tile.width),
              static_cast<float>(tile.height));
  glUniform3fv(resolve->uniform("background"), 1, glm::value_ptr(frame.options.background));
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

SplatRenderer::SplatRenderer() : pipeline_(std::make_unique<Pipeline>()) {}
SplatRenderer::~SplatRenderer() = default;

namespace {

template <typename T>
std::vector<T> inOrder(const std::vector<T>& column, const std::vector<Index>& order) {
  std::vector<T> out;
  out.reserve(order.size());
  for (const Index point : order) out.push_back(column[point]);
  return out;
}

std::vector<std::uint32_t> packedInOrder(const std::vector<vec3>& colours, const PlainPoints& plain,
                                         const std::vector<Index>& order) {
  std::vector<std::uint32_t> packed(colours.size());
  for (std::size_t i = 0; i < packed.size(); ++i) {
    const std::size_t point = order.empty() ? i : order[i];
    packed[i] = packedColour(colours[point], !plain.empty() && plain[point] != 0);
  }
  return packed;
}

// Copies of columns in the order in which they are drawn.
struct OrderedTexture {
  std::vector<vec2> texel;
  std::vector<TangentFrame> frame;
  std::vector<float> scale;
  SplatTexture texture;

  OrderedTexture(const SplatTexture& t, const std::vector<Index>& order)
      : texel(inOrder(t.texel, order)),
        frame(inOrder(t.frame, order)),
        scale(t.scale ? inOrder(*t.scale, order) : std::vector<float>()),
        texture{t.swatch, texel, frame, t.unit, t.longestStep, t.scale ? &scale : nullptr} {}
  OrderedTexture(const OrderedTexture&) = delete;
  OrderedTexture& operator=(const OrderedTexture&) = delete;
};

struct OrderedColumns {
  std::vector<vec3> positions, normals, colours;
  std::vector<float> radii;
  std::optional<OrderedTexture> texture;

  explicit OrderedColumns(const SplatColumns& c)
      : positions(inOrder(c.positions, *c.order)),
        normals(inOrder(c.normals, *c.order)),
        colours(inOrder(c.colours, *c.order)),
        radii(inOrder(c.radii, *c.order)) {
    if (c.texture) texture.emplace(*c.texture, *c.order);
  }
  SplatColumns columns() const {
    return {positions, normals, colours, radii, texture ? &texture->texture : nullptr};
  }
};

}  // namespace

void SplatRenderer::update(const SplatColumns& columns, const SplatChanges& changes) {
  const std::size_t n = columns.positions.size();
  DAPPLE_CHECK(columns.normals.size(), ==, n);
  DAPPLE_CHECK(columns.colours.size(), ==, n);
  DAPPLE_CHECK(columns.radii.size(), ==, n);
  Pipeline& p = *pipeline_;
  if (columns.order) {
    DAPPLE_CHECK(columns.order->size(), ==, n);
    update(OrderedColumns(columns).columns(), changes);
    p.order = *columns.order;
    return;
  }
  p.order.clear();
  if (changes.positions) p.buffers.setPositions(columns.positions);
  if (changes.normals) p.buffers.setNormals(columns.normals);
  if (changes.colours) p.buffers.setColours(packedInOrder(columns.colours, {}, {}));
  if (changes.radii) p.buffers.setRadii(columns.radii);
  if (changes.texture) p.buffers.setTexture(columns.texture);
  if (changes.positions || changes.normals || changes.radii) p.chunks = splatChunks(columns);
  p.count = n;
  glBindVertexArray(0);
}

void SplatRenderer::recolour(const std::vector<vec3>& colours, const PlainPoints& plain) {
  DAPPLE_CHECK(colours.size(), ==, pipeline_->count);
  if (!plain.empty()) DAPPLE_CHECK(plain.size(), ==, pipeline_->count);
  recolour(packedInOrder(colours, plain, pipeline_->order));
}

void SplatRenderer::recolour(std::span<const std::uint32_t> packed) {
  DAPPLE_CHECK(packed.size(), ==, pipeline_->count);
  pipeline_->buffers.setColours(packed);
  glBindVertexArray(0);
}

void SplatRenderer::retexture(const SplatTexture* texture) {
  const std::vector<Index>& order = pipeline_->order;
  if (texture) DAPPLE_CHECK(texture->texel.size(), ==, pipeline_->count);
  std::optional<OrderedTexture> ordered;
  if (texture && !order.empty()) ordered.emplace(*texture, order);
  pipeline_->buffers.setTexture(ordered ? &ordered->texture : texture);
  glBindVertexArray(0);
}

std::size_t SplatRenderer::uploadedBytes() const {
  return pipeline_->buffers.uploadedBytes();
}

Frame SplatRenderer::Pipeline::prepare(const Camera& camera, int width, int height,
                                       const SplatOptions& options) {
  validate(width, height, options);
  Frame frame = frameOf(camera, width, height, options);
  frame.count = std::min(options.count, count);
  for (std::size_t k = 0; k * SplatChunk::kPoints < frame.count; ++k)
    frame.images.push_back(chunkImage(chunks[k], frame.lens));
  const int side = kTile / options.samples;
  frame.tileWidth = std::min(width, side), frame.tileHeight = std::min(height, side);
  const int across = frame.tileWidth * options.samples, up = frame.tileHeight * options.samples;
  if (!samples || samples->width != across || samples->height != up) {
    samples.reset();  // first its memory
    samples.emplace(across, up);
  }
  return frame;
}

void SplatRenderer::drawInto(const SplatTarget& target, const Camera& camera, int width, int height,
                             const SplatOptions& options) {
  const Frame frame = pipeline_->prepare(camera, width, height, options);
  forTiles(frame, width, height, [&](const Tile& tile) {
    pipeline_->drawTile(frame, tile);
    pipeline_->resolveTile(frame, tile, {target.framebuffer, target.x + tile.x, target.y + tile.y});
  });
  unbindAll();
}

Image SplatRenderer::draw(const Camera& camera, int width, int height,
                          const SplatOptions& options) {
  Pipeline& p = *pipeline_;
  const Frame frame = p.prepare(camera, width, height, options);
  if (!p.pixels || p.pixels->width != frame.tileWidth || p.pixels->height != frame.tileHeight)
    p.pixels.emplace(frame.tileWidth, frame.tileHeight);
  Image picture{width, height, 4, std::vector<float>(std::size_t{4} * width * height)};
  std::vector<std::uint8_t> read(std::size_t{4} * frame.tileWidth * frame.tileHeight);
  forTiles(frame, width, height, [&](const Tile& tile) {
    p.drawTile(frame, tile);
    p.resolveTile(frame, tile, {p.pixels->framebuffer.id(), 0, 0});
    glReadPixels(0, 0, tile.width, tile.height, GL_RGBA, GL_UNSIGNED_BYTE, read.data());
    const std::size_t row = std::size_t{4} * tile.width;
    for (int y = 0; y < tile.height; ++y)  // OpenGL's lowest row comes first
      toFloats({read.data() + y * row, row}, &picture.at(tile.x, height - 1 - (tile.y + y), 0));
  });
  unbindAll();
  return picture;
}

}  // namespace dapple
