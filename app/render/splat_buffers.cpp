#include "app/render/splat_buffers.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/errors.h"

namespace dapple {
namespace {

enum Attribute : GLuint { kPosition, kNormal, kColour, kRadius, kTexel, kSwatchS, kSwatchT };

// x in the lowest of three times 10 bits, two's complement; the same for either side but the sign.
std::uint32_t packedNormal(const vec3& n) {
  const float length = glm::length(n);
  if (!(length > 0.5f)) return 0;
  const auto bits = [&](float v) {
    return static_cast<std::uint32_t>(std::lround(511 * v / length)) & 0x3ffu;
  };
  return bits(n.x) | bits(n.y) << 10 | bits(n.z) << 20;
}

GlTexture makeSwatchTexture(const Swatch& swatch) {
  std::vector<std::uint32_t> pixels;
  for (const vec3& c : swatch.colours()) pixels.push_back(packedColour(c));
  GlTexture texture;
  glBindTexture(GL_TEXTURE_2D, texture.id());
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, swatch.width, swatch.height, 0, GL_RGBA,
               GL_UNSIGNED_BYTE, pixels.data());
  const GLint wrap = swatch.tileable ? GL_REPEAT : GL_CLAMP_TO_EDGE;
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D, axis, wrap);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
  return texture;
}

}  // namespace

// Leaves the buffer and the vertex array bound.
template <typename T>
void SplatBuffers::upload(const GlBuffer& buffer, std::span<const T> column) {
  const std::size_t bytes = column.size_bytes();
  glBindVertexArray(array_.id());
  glBindBuffer(GL_ARRAY_BUFFER, buffer.id());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(bytes), column.data(), GL_DYNAMIC_DRAW);
  uploaded_ += bytes;
}

void SplatBuffers::setPositions(const std::vector<vec3>& positions) {
  upload<vec3>(positions_, positions);
  glVertexAttribPointer(kPosition, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  glEnableVertexAttribArray(kPosition);
}

void SplatBuffers::setNormals(const std::vector<vec3>& normals) {
  std::vector<std::uint32_t> packed(normals.size());
  std::transform(normals.begin(), normals.end(), packed.begin(), packedNormal);
  upload<std::uint32_t>(normals_, packed);
  // Not normalised: OpenGL before 4.2 would turn 0 into 1/1023.
  glVertexAttribPointer(kNormal, 4, GL_INT_2_10_10_10_REV, GL_FALSE, 0, nullptr);
  glEnableVertexAttribArray(kNormal);
}

void SplatBuffers::setColours(std::span<const std::uint32_t> packed) {
  upload(colours_, packed);
  glVertexAttribPointer(kColour, 4, GL_UNSIGNED_BYTE, GL_TRUE, 0, nullptr);
  glEnableVertexAttribArray(kColour);
}

void SplatBuffers::setRadii(const std::vector<float>& radii) {
  upload<float>(radii_, radii);
  glVertexAttribPointer(kRadius, 1, GL_FLOAT, GL_FALSE, 0, nullptr);
  glEnableVertexAttribArray(kRadius);
}

void SplatBuffers::setTexture(const SplatTexture* texture) {
  swatch_.reset();
  glBindVertexArray(array_.id());
  for (const GLuint attribute : {kTexel, kSwatchS, kSwatchT}) glDisableVertexAttribArray(attribute);
  if (!texture) return;
  std::vector<vec3> s, t;
  for (std::size_t i = 0; i < texture->frame.size(); ++i) {
    const float pixels = texture->pixelsPerUnit(i);
    s.push_back(pixels * texture->frame[i].s);
    t.push_back(pixels * texture->frame[i].t);
  }
  upload<vec2>(texels_, texture->texel);
  glVertexAttribPointer(kTexel, 2, GL_FLOAT, GL_FALSE, 0, nullptr);
  upload<vec3>(swatchS_, s);
  glVertexAttribPointer(kSwatchS, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  upload<vec3>(swatchT_, t);
  glVertexAttribPointer(kSwatchT, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  for (const GLuint attribute : {kTexel, kSwatchS, kSwatchT}) glEnableVertexAttribArray(attribute);
  swatch_ = makeSwatchTexture(texture->swatch);
  uploaded_ += std::size_t{4} * texture->swatch.width * texture->swatch.height;
  swatchSize_ = {texture->swatch.width, texture->swatch.height};
  longestStep_ = texture->longestStep;
}

}  // namespace dapple
