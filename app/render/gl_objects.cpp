#include "app/render/gl_objects.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <stdexcept>

#include "app/render/shader_sources.h"
#include "base/errors.h"

namespace dapple {
namespace {

struct GlShaderTraits {
  static GLuint make() { return 0; }
  static void destroy(GLuint id) { glDeleteShader(id); }
};
using GlShader = GlObject<GlShaderTraits>;

std::string shaderLog(GLuint shader) {
  GLint size = 0;
  glGetShaderiv(shader, GL_INFO_LOG_LENGTH, &size);
  std::string log(static_cast<std::size_t>(size), '\0');
  if (size > 0) glGetShaderInfoLog(shader, size, nullptr, log.data());
  return log;
}

std::string programLog(GLuint program) {
  GLint size = 0;
  glGetProgramiv(program, GL_INFO_LOG_LENGTH, &size);
  std::string log(static_cast<std::size_t>(size), '\0');
  if (size > 0) glGetProgramInfoLog(program, size, nullptr, log.data());
  return log;
}

GlShader compile(const GlStage& stage, std::span<const std::string_view> defines) {
  std::string source = "#version 330 core\n";
  for (std::string_view name : defines) source += fmt::format("#define {}\n", name);
  std::istringstream shared(stage.shared);
  for (std::string name; shared >> name;) source += shaderSource(name);
  source += "#line 1\n";  // so that the log names the file's own lines
  source += shaderSource(stage.name);

  GlShader shader(glCreateShader(stage.type));
  const char* text = source.c_str();
  glShaderSource(shader.id(), 1, &text, nullptr);
  glCompileShader(shader.id());
  GLint done = GL_FALSE;
  glGetShaderiv(shader.id(), GL_COMPILE_STATUS, &done);
  if (done != GL_TRUE)
    throw Bug(fmt::format("shaders/{} does not compile:\n{}", stage.name, shaderLog(shader.id())));
  return shader;
}

}  // namespace

GLuint GlBufferTraits::make() {
  GLuint id = 0;
  glGenBuffers(1, &id);
  return id;
}
void GlBufferTraits::destroy(GLuint id) {
  glDeleteBuffers(1, &id);
}

GLuint GlVertexArrayTraits::make() {
  GLuint id = 0;
  glGenVertexArrays(1, &id);
  return id;
}
void GlVertexArrayTraits::destroy(GLuint id) {
  glDeleteVertexArrays(1, &id);
}

GLuint GlTextureTraits::make() {
  GLuint id = 0;
  glGenTextures(1, &id);
  return id;
}
void GlTextureTraits::destroy(GLuint id) {
  glDeleteTextures(1, &id);
}

GLuint GlFramebufferTraits::make() {
  GLuint id = 0;
  glGenFramebuffers(1, &id);
  return id;
}
void GlFramebufferTraits::destroy(GLuint id) {
  glDeleteFramebuffers(1, &id);
}

GLuint GlProgramTraits::make() {
  return glCreateProgram();
}
void GlProgramTraits::destroy(GLuint id) {
  glDeleteProgram(id);
}

GlProgram::GlProgram(std::span<const GlStage> stages, std::span<const std::string_view> defines) {
  std::vector<GlShader> shaders;
  for (const GlStage& stage : stages) {
    shaders.push_back(compile(stage, defines));
    glAttachShader(id(), shaders.back().id());
  }
  glLinkProgram(id());
  for (const GlShader& shader : shaders) glDetachShader(id(), shader.id());
  GLint done = GL_FALSE;
  glGetProgramiv(id(), GL_LINK_STATUS, &done);
  if (done != GL_TRUE)
    throw Bug(fmt::format("shaders/{} and its companions do not link:\n{}", stages.front().name,
                          programLog(id())));
}

bool isSoftwareGl() {
  const auto* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  const std::string_view renderer = name != nullptr ? name : "";
  constexpr std::array kNames{"llvmpipe", "softpipe", "swrast", "SwiftShader"};
  return std::any_of(kNames.begin(), kNames.end(), [&](std::string_view software) {
    return renderer.find(software) != std::string_view::npos;
  });
}

GlTexture makeTexture(GLenum internalFormat, int width, int height) {
  GlTexture texture;
  const bool depth = internalFormat == GL_DEPTH_COMPONENT32F;
  glBindTexture(GL_TEXTURE_2D, texture.id());
  glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internalFormat), width, height, 0,
               depth ? GL_DEPTH_COMPONENT : GL_RGBA, GL_FLOAT, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glBindTexture(GL_TEXTURE_2D, 0);
  return texture;
}

GlFramebuffer makeFramebuffer(const GlTexture& colour, const GlTexture* depth) {
  GlFramebuffer framebuffer;
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, colour.id(), 0);
  if (depth != nullptr)
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth->id(), 0);
  const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  if (status != GL_FRAMEBUFFER_COMPLETE)
    throw std::runtime_error(fmt::format(
        "This OpenGL cannot draw into floating-point pictures (status {:#x}); draw offscreen "
        "with OSMesa instead.",
        status));
  return framebuffer;
}

void collectGlMessages() {
  if (GLAD_GL_KHR_debug == 0) return;
  // No callback is set: then OpenGL keeps the messages itself, and no state of ours is shared.
  glEnable(GL_DEBUG_OUTPUT);
  glDebugMessageControl(GL_DONT_CARE, GL_DONT_CARE, GL_DONT_CARE, 0, nullptr, GL_TRUE);
  glDebugMessageControl(GL_DONT_CARE, GL_DONT_CARE, GL_DEBUG_SEVERITY_NOTIFICATION, 0, nullptr,
                        GL_FALSE);
}

std::vector<std::string> takeGlMessages() {
  std::vector<std::string> messages;
  for (GLenum error = glGetError(); error != GL_NO_ERROR; error = glGetError())
    messages.push_back(fmt::format("glGetError {:#x}", error));
  GLint size = 0;
  while (GLAD_GL_KHR_debug != 0 &&
         (glGetIntegerv(GL_DEBUG_NEXT_LOGGED_MESSAGE_LENGTH, &size), size > 0)) {
    std::string text(static_cast<std::size_t>(size), '\0');
    glGetDebugMessageLog(1, size, nullptr, nullptr, nullptr, nullptr, nullptr, text.data());
    while (!text.empty() && (text.back() == '\0' || text.back() == '\n')) text.pop_back();
    messages.push_back(std::move(text));
  }
  return messages;
}

}  // namespace dapple
