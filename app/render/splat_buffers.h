// The columns of splats.h as OpenGL's buffers. Needs a current context for its whole life.
#pragma once

#include <optional>

#include "app/render/gl_objects.h"
#include "app/render/splats.h"

namespace dapple {

class SplatBuffers {
 public:
  void setPositions(const std::vector<vec3>& positions);
  void setNormals(const std::vector<vec3>& normals);       // 10 bits a coordinate
  void setColours(std::span<const std::uint32_t> packed);  // packedColour()
  void setRadii(const std::vector<float>& radii);
  void setTexture(const SplatTexture* texture);

  GLuint array() const { return array_.id(); }
  const std::optional<GlTexture>& swatch() const { return swatch_; }
  glm::vec2 swatchSize() const { return swatchSize_; }  // pixels
  float longestStep() const { return longestStep_; }
  std::size_t uploadedBytes() const { return uploaded_; }  // since it was made

 private:
  template <typename T>
  void upload(const GlBuffer& buffer, std::span<const T> column);

  GlVertexArray array_;
  GlBuffer positions_, normals_, colours_, radii_, texels_, swatchS_, swatchT_;
  std::optional<GlTexture> swatch_;
  glm::vec2 swatchSize_{1};
  float longestStep_ = 0;
  std::size_t uploaded_ = 0;
};

}  // namespace dapple
