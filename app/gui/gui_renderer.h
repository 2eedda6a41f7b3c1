// Draws what ImGui made. Debian's own backend cannot load OpenGL under OSMesa; this one uses the
// program's functions, and so looks the same in a window and without one.
#pragma once

#include <imgui.h>

#include <cstdint>

#include "app/render/gl_objects.h"

namespace dapple {

// A texture of OpenGL for ImGui::Image and ImDrawList::AddImage. Alpha is not premultiplied; the
// texture's own filters hold.
inline ImTextureID guiTexture(GLuint id) {
  return reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(id));
}

// Lives with its OpenGL context.
class GuiRenderer {
 public:
  GuiRenderer();

  // Draws over what is in the bound framebuffer, of data.DisplaySize pixels or larger, bottom left
  // on bottom left. Takes the font atlas of the current ImGui context when it changed. Needs no
  // state, and leaves OpenGL's defaults: no program, array or texture bound, no blending, scissor
  // or depth test, viewport over the whole display.
  void draw(const ImDrawData& data);

 private:
  void takeFonts(ImFontAtlas& atlas);
  void bind(int width, int height) const;
  void drawList(const ImDrawList& list, const ImDrawData& data) const;

  GlProgram program_;
  GLint toClip_;
  GlVertexArray array_;
  GlBuffer vertices_, indices_;
  GlTexture fonts_;
};

}  // namespace dapple
