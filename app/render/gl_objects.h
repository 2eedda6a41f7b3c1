// OpenGL objects that die with their owners, and what OpenGL has to say. Everything here needs a
// current context, the same for the whole life of an object.
#pragma once

#include <glad/gl.h>

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dapple {

// A name that Traits::make() gives and Traits::destroy() takes back.
template <typename Traits>
class GlObject {
 public:
  GlObject() : id_(Traits::make()) {}
  explicit GlObject(GLuint id) : id_(id) {}
  ~GlObject() {
    if (id_ != 0) Traits::destroy(id_);
  }
  GlObject(GlObject&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
  GlObject& operator=(GlObject&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }

  GLuint id() const { return id_; }

 private:
  GLuint id_;
};

struct GlBufferTraits {
  static GLuint make();
  static void destroy(GLuint id);
};
struct GlVertexArrayTraits {
  static GLuint make();
  static void destroy(GLuint id);
};
struct GlTextureTraits {
  static GLuint make();
  static void destroy(GLuint id);
};
struct GlFramebufferTraits {
  static GLuint make();
  static void destroy(GLuint id);
};
struct GlProgramTraits {
  static GLuint make();
  static void destroy(GLuint id);
};
using GlBuffer = GlObject<GlBufferTraits>;
using GlVertexArray = GlObject<GlVertexArrayTraits>;
using GlTexture = GlObject<GlTextureTraits>;
using GlFramebuffer = GlObject<GlFramebufferTraits>;

struct GlStage {
  GLenum type;         // GL_VERTEX_SHADER, ...
  std::string name;    // a file of shaders/
  std::string shared;  // files of shaders/ that come before it, separated by spaces
};

class GlProgram {
 public:
  // Compiles and links, each stage behind "#version 330 core" and a #define for each name. Throws
  // Bug with the file's name and the compiler's log.
  GlProgram(std::span<const GlStage> stages, std::span<const std::string_view> defines);

  GLuint id() const { return program_.id(); }
  // -1, which glUniform ignores, when the program does not use it.
  GLint uniform(const char* name) const { return glGetUniformLocation(id(), name); }

 private:
  GlObject<GlProgramTraits> program_;
};

// Whether a processor does the drawing (llvmpipe and the like) instead of graphics hardware.
bool isSoftwareGl();

// A texture of w x h texels without mip levels, read with texelFetch.
GlTexture makeTexture(GLenum internalFormat, int width, int height);

// A framebuffer with a colour texture, and a depth texture unless it is null. Throws
// std::runtime_error when this OpenGL cannot draw into them.
GlFramebuffer makeFramebuffer(const GlTexture& colour, const GlTexture* depth);

// Starts the context's own log of messages (KHR_debug), notifications left out.
void collectGlMessages();
// What came since the last call, and glGetError. Empty in a program that is right. The log holds
// as many messages as the driver likes (at least one; Mesa 10) and drops what comes after them.
std::vector<std::string> takeGlMessages();

}  // namespace dapple
