// Zwicker, Pfister, van Baar, Gross: Surface Splatting, 2001; Botsch, Hornung, Zwicker, Kobbelt:
// High-Quality Surface Splatting on Today's GPUs, 2005. Departures:
// - The low-pass is the smaller of the two distances (2005, section 4), not a convolution.
// - Colours are mixed after shading (one accumulator instead of two): the light is at the eye and
//   varies slowly, and the second accumulator costs 15 % on software GL.
#include "app/render/splat_renderer.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <optional>

#include "app/render/gl_objects.h"
#include "base/errors.h"

namespace dapple {
namespace {

constexpr int kTile = 2048;            // samples: 150 MB of textures, whatever the picture's size
constexpr float kLargestSprite = 250;  // pixels; Mesa allows 255

GlProgram splatProgram(bool sprites, bool visibility) {
  std::vector<GlStage> stages{{GL_VERTEX_SHADER, "splat.vert"}, {GL_FRAGMENT_SHADER, "splat.frag"}};
  if (!sprites) stages.push_back({GL_GEOMETRY_SHADER, "splat.geom"});
  std::vector<std::string_view> defines;
  if (sprites) defines.push_back("SPRITES");
  if (visibility) defines.push_back("VISIBILITY");
  return GlProgram(stages, defines);
}

GlProgram resolveProgram() {
  const GlStage stages[] = {{GL_VERTEX_SHADER, "resolve.vert"},
                            {GL_FRAGMENT_SHADER, "resolve.frag"}};
  return GlProgram(stages, {});
}

template <typename T>
void uploadColumn(GLuint attribute, const GlBuffer& buffer, const std::vector<T>& column) {
  glBindBuffer(GL_ARRAY_BUFFER, buffer.id());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(column.size() * sizeof(T)), column.data(),
               GL_DYNAMIC_DRAW);
  glVertexAttribPointer(attribute, sizeof(T) / sizeof(float), GL_FLOAT, GL_FALSE, 0, nullptr);
  glEnableVertexAttribArray(attribute);
}

GlTexture makeSwatchTexture(const Swatch& swatch) {
  std::vector<std::uint8_t> bytes;
  for (const vec3& c : swatch.colours())
    for (int k = 0; k < 3; ++k)
      bytes.push_back(static_cast<std::uint8_t>(std::clamp(c[k], 0.f, 1.f) * 255 + 0.5f));
  GlTexture texture;
  glBindTexture(GL_TEXTURE_2D, texture.id());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, swatch.width, swatch.height, 0, GL_RGB, GL_UNSIGNED_BYTE,
               bytes.data());
  const GLint wrap = swatch.tileable ? GL_REPEAT : GL_CLAMP_TO_EDGE;
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D, axis, wrap);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
  return texture;
}

// The picture in samples, as the shaders see it.
struct Frame {
  glm::mat4 view;
  glm::vec2 focal, centre, depthRange;
  float lowPass;
  bool sprites, orthographic;
  const SplatOptions& options;
};

struct Tile {
  int x, y, width, height;  // pixels, y upwards
};

// A texture pair to accumulate in and one to read from, for tiles of one size.
struct Targets {
  int width, height, samples;
  GlTexture accumulated, depth, resolved;
  GlFramebuffer splats, picture;

  Targets(int w, int h, int s)
      : width(w),
        height(h),
        samples(s),
        accumulated(makeTexture(GL_RGBA32F, w * s, h * s)),
        depth(makeTexture(GL_DEPTH_COMPONENT32F, w * s, h * s)),
        resolved(makeTexture(GL_RGBA32F, w, h)),
        splats(makeFramebuffer(accumulated, &depth)),
        picture(makeFramebuffer(resolved, nullptr)) {}
};

}  // namespace

struct SplatRenderer::Pipeline {
  // [sprites][visibility]
  GlProgram splats[2][2] = {{splatProgram(false, false), splatProgram(false, true)},
                            {splatProgram(true, false), splatProgram(true, true)}};
  GlProgram resolve = resolveProgram();
  GlVertexArray points, nothing;
  GlBuffer positions, normals, colours, radii, texels, swatchS, swatchT;
  std::optional<GlTexture> swatch;
  glm::vec2 swatchSize{1};  // pixels
  float longestStep = 0;
  std::unique_ptr<Targets> targets;
  GLsizei count = 0;
  Bounds bounds;
  float largestRadius = 0;
  float largestSprite = 0;

  void setTexture(const SplatTexture* texture, std::size_t pointCount);
  bool fitSprites(const Camera& camera, float focal) const;
  void drawSplats(const Frame& frame, const Tile& tile, bool visibility) const;
  void drawTile(const Frame& frame, const Tile& tile);
};

// Needs the points' vertex array.
void SplatRenderer::Pipeline::setTexture(const SplatTexture* texture, std::size_t pointCount) {
  swatch.reset();
  for (const GLuint attribute : {4u, 5u, 6u}) glDisableVertexAttribArray(attribute);
  if (!texture) return;
  DAPPLE_CHECK(texture->texel.size(), ==, pointCount);
  DAPPLE_CHECK(texture->frame.size(), ==, pointCount);
  std::vector<vec3> s(pointCount), t(pointCount);
  for (std::size_t i = 0; i < pointCount; ++i) {
    s[i] = texture->frame[i].s / texture->scale;
    t[i] = texture->frame[i].t / texture->scale;
  }
  uploadColumn(4, texels, texture->texel);
  uploadColumn(5, swatchS, s);
  uploadColumn(6, swatchT, t);
  swatch = makeSwatchTexture(texture->swatch);
  swatchSize = {texture->swatch.width, texture->swatch.height};
  longestStep = texture->longestStep;
}

// Sprites are quicker than quads, but only up to the driver's largest size.
bool SplatRenderer::Pipeline::fitSprites(const Camera& camera, float focal) const {
  if (camera.orthographicHeight > 0) return 2 * largestRadius * focal < largestSprite;
  const vec3 forward = glm::normalize(camera.target - camera.eye);
  const vec3 nearest = glm::mix(bounds.low, bounds.high, glm::lessThan(forward, vec3(0)));
  const float depth = glm::dot(nearest - camera.eye, forward) - largestRadius;
  // Off the axis a disc's image is longer by the square of the ray's length at most.
  const vec2 corner = 1.2f * vec2(std::tan(0.5f * camera.verticalFov));
  const float stretch = 1 + glm::dot(corner, corner) * 4;
  return depth > 0 && 2 * largestRadius * stretch * focal / depth < largestSprite;
}

void SplatRenderer::Pipeline::drawSplats(const Frame& frame, const Tile& tile,
                                         bool visibility) const {
  const GlProgram& program = splats[frame.sprites][visibility];
  const int samples = frame.options.samples;
  // From the view axis, so that no rounding depends on the picture's size.
  const glm::vec2 origin = glm::vec2(tile.x * samples, tile.y * samples) - frame.centre;
  const glm::vec2 size(tile.width * samples, tile.height * samples);
  // A sprite goes with its centre: the viewport reaches beyond the tile by half the largest one.
  const float guard = frame.sprites ? std::ceil(0.5f * largestSprite) : 0.f;
  const glm::vec4 viewport(origin - guard, size + 2 * guard);

  glViewport(static_cast<GLint>(-guard), static_cast<GLint>(-guard),
             static_cast<GLsizei>(viewport.z), static_cast<GLsizei>(viewport.w));
  glUseProgram(program.id());
  glUniformMatrix4fv(program.uniform("localToView"), 1, GL_FALSE, glm::value_ptr(frame.view));
  glUniform2fv(program.uniform("focal"), 1, glm::value_ptr(frame.focal));
  glUniform1i(program.uniform("orthographic"), frame.orthographic ? 1 : 0);
  glUniform4fv(program.uniform("viewport"), 1, glm::value_ptr(viewport));
  glUniform2fv(program.uniform("tileOrigin"), 1, glm::value_ptr(origin));
  glUniform2fv(program.uniform("depthRange"), 1, glm::value_ptr(frame.depthRange));
  glUniform1f(program.uniform("lowPass"), frame.lowPass);
  glUniform1i(program.uniform("headlight"), frame.options.shading == Shading::Off ? 0 : 1);
  glUniform1f(program.uniform("longestStep"), swatch ? longestStep : -1.f);
  glUniform1i(program.uniform("swatch"), 0);
  glUniform2fv(program.uniform("swatchSize"), 1, glm::value_ptr(swatchSize));
  if (swatch) glBindTexture(GL_TEXTURE_2D, swatch->id());
  glDrawArrays(GL_POINTS, 0, count);
}

void SplatRenderer::Pipeline::drawTile(const Frame& frame, const Tile& tile) {
  // 1. Visibility: the nearest surface, moved back so that all splats of one surface pass.
  glBindFramebuffer(GL_FRAMEBUFFER, targets->splats.id());
  glBindVertexArray(points.id());
  glEnable(GL_PROGRAM_POINT_SIZE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_TRUE);
  glClearColor(0, 0, 0, 0);
  glClearDepth(1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  drawSplats(frame, tile, true);

  // 2. Accumulation of what lies in front of that.
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_FALSE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  drawSplats(frame, tile, false);
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);

  // 3. Normalisation.
  glBindFramebuffer(GL_FRAMEBUFFER, targets->picture.id());
  glBindVertexArray(nothing.id());
  glViewport(0, 0, tile.width, tile.height);
  glUseProgram(resolve.id());
  glBindTexture(GL_TEXTURE_2D, targets->accumulated.id());
  glUniform1i(resolve.uniform("accumulated"), 0);
  glUniform1i(resolve.uniform("samples"), frame.options.samples);
  glUniform3fv(resolve.uniform("background"), 1, glm::value_ptr(frame.options.background));
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

SplatRenderer::SplatRenderer() : pipeline_(std::make_unique<Pipeline>()) {
  GLfloat sizes[2] = {1, 1};
  glGetFloatv(GL_POINT_SIZE_RANGE, sizes);
  pipeline_->largestSprite = std::min(sizes[1], kLargestSprite);
}

SplatRenderer::~SplatRenderer() = default;

void SplatRenderer::update(const SplatColumns& columns) {
  const std::size_t n = columns.positions.size();
  DAPPLE_CHECK(columns.normals.size(), ==, n);
  DAPPLE_CHECK(columns.colours.size(), ==, n);
  DAPPLE_CHECK(columns.radii.size(), ==, n);

  Pipeline& p = *pipeline_;
  glBindVertexArray(p.points.id());
  uploadColumn(0, p.positions, columns.positions);
  uploadColumn(1, p.normals, columns.normals);
  uploadColumn(2, p.colours, columns.colours);
  uploadColumn(3, p.radii, columns.radii);
  p.setTexture(columns.texture, n);
  glBindVertexArray(0);
  p.count = static_cast<GLsizei>(n);
  p.bounds = boundsOf(columns.positions);
  p.largestRadius = n == 0 ? 0 : *std::max_element(columns.radii.begin(), columns.radii.end());
}

Image SplatRenderer::draw(const Camera& camera, int width, int height,
                          const SplatOptions& options) {
  validate(width, height, options);
  Pipeline& p = *pipeline_;
  const int samples = options.samples;
  const bool orthographic = camera.orthographicHeight > 0;
  const float focal = orthographic ? height * samples / camera.orthographicHeight
                                   : 0.5f * height * samples / std::tan(0.5f * camera.verticalFov);
  const Frame frame{.view = viewMatrix(camera),
                    .focal = {focal, focal},
                    .centre = 0.5f * samples * glm::vec2(width, height),
                    .depthRange = {camera.nearPlane, camera.farPlane},
                    .lowPass = options.lowPass * samples,
                    .sprites = p.fitSprites(camera, focal),
                    .orthographic = orthographic,
                    .options = options};

  const int side = kTile / samples;
  const int tileWidth = std::min(width, side), tileHeight = std::min(height, side);
  if (p.targets == nullptr || p.targets->width != tileWidth || p.targets->height != tileHeight ||
      p.targets->samples != samples)
    p.targets = std::make_unique<Targets>(tileWidth, tileHeight, samples);

  Image picture{width, height, 4, std::vector<float>(std::size_t{4} * width * height)};
  std::vector<float> read(std::size_t{4} * tileWidth * tileHeight);
  for (int y = 0; y < height; y += tileHeight)
    for (int x = 0; x < width; x += tileWidth) {
      const Tile tile{x, y, std::min(tileWidth, width - x), std::min(tileHeight, height - y)};
      p.drawTile(frame, tile);
      glReadPixels(0, 0, tile.width, tile.height, GL_RGBA, GL_FLOAT, read.data());
      for (int row = 0; row < tile.height; ++row)  // OpenGL's lowest row comes first
        std::copy_n(read.data() + std::size_t{4} * row * tile.width, std::size_t{4} * tile.width,
                    &picture.at(x, height - 1 - (y + row), 0));
    }
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glBindVertexArray(0);
  glUseProgram(0);
  return picture;
}

}  // namespace dapple
