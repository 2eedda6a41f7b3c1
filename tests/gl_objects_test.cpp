#include "app/render/gl_objects.h"

#include <doctest/doctest.h>

#include <array>

#include "app/render/offscreen.h"
#include "base/errors.h"

using namespace dapple;

TEST_CASE("an invalid call to OpenGL is collected as a message, once") {
  OffscreenContext context;
  CHECK(takeGlMessages().empty());
  glBindFramebuffer(0x1234, 1);
  CHECK(!takeGlMessages().empty());
  CHECK(takeGlMessages().empty());
}

TEST_CASE("the context is OpenGL 3.3 or newer") {
  OffscreenContext context;
  GLint major = 0, minor = 0;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  glGetIntegerv(GL_MINOR_VERSION, &minor);
  CHECK(10 * major + minor >= 33);
}

TEST_CASE("a context can follow another") {
  { OffscreenContext first; }
  OffscreenContext second;
  CHECK(glGetString(GL_VERSION) != nullptr);
}

TEST_CASE("an object's name dies with its last owner") {
  OffscreenContext context;
  GLuint name = 0;
  {
    GlBuffer first;
    name = first.id();
    glBindBuffer(GL_ARRAY_BUFFER, name);
    GlBuffer second = std::move(first);
    CHECK(first.id() == 0);
    CHECK(second.id() == name);
    CHECK(glIsBuffer(name) == GL_TRUE);
  }
  CHECK(glIsBuffer(name) == GL_FALSE);
  CHECK(takeGlMessages().empty());
}

TEST_CASE("a shader that does not compile is named with its line and log") {
  OffscreenContext context;
  const std::array stages{GlStage{GL_VERTEX_SHADER, "resolve.vert"},
                          GlStage{GL_FRAGMENT_SHADER, "resolve.frag"}};
  const std::array<std::string_view, 1> defines{"main 7"};
  try {
    GlProgram program(stages, defines);
    FAIL("no exception");
  } catch (const Bug& bug) {
    const std::string text = bug.what();
    CHECK(text.find("shaders/resolve.vert") != std::string::npos);
    CHECK(text.find("error") != std::string::npos);
  }
  takeGlMessages();
}

TEST_CASE("a shader that is not there is a bug") {
  OffscreenContext context;
  const std::array stages{GlStage{GL_VERTEX_SHADER, "nothing.vert"}};
  CHECK_THROWS_AS(GlProgram(stages, {}), Bug);
}
