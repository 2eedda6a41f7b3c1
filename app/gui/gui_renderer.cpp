#include "app/gui/gui_renderer.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace dapple {
namespace {

constexpr std::array<GLuint, 3> kAttributes{0, 1, 2};

GlProgram makeProgram() {
  const std::array<GlStage, 2> stages{
      {{GL_VERTEX_SHADER, "gui.vert"}, {GL_FRAGMENT_SHADER, "gui.frag"}}};
  return {stages, {}};
}

const void* offset(std::size_t bytes) {
  return reinterpret_cast<const void*>(bytes);
}

GLuint textureName(ImTextureID texture) {
  return static_cast<GLuint>(reinterpret_cast<std::uintptr_t>(texture));
}

}  // namespace

GuiRenderer::GuiRenderer() : program_(makeProgram()), toClip_(program_.uniform("toClip")) {
  glBindVertexArray(array_.id());
  glBindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  for (GLuint attribute : kAttributes) glEnableVertexAttribArray(attribute);
  constexpr GLsizei stride = sizeof(ImDrawVert);
  glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, stride, offset(offsetof(ImDrawVert, pos)));
  glVertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, stride, offset(offsetof(ImDrawVert, uv)));
  glVertexAttribPointer(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride, offset(offsetof(ImDrawVert, col)));
  glBindVertexArray(0);
  glBindBuffer(GL_ARRAY_BUFFER, 0);
}

void GuiRenderer::takeFonts(ImFontAtlas& atlas) {
  if (textureName(atlas.TexID) == fonts_.id()) return;
  unsigned char* coverage = nullptr;
  int width = 0, height = 0;
  atlas.GetTexDataAsAlpha8(&coverage, &width, &height);
  glBindTexture(GL_TEXTURE_2D, fonts_.id());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, width, height, 0, GL_RED, GL_UNSIGNED_BYTE, coverage);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  const std::array<GLint, 4> whiteWithAlpha{GL_ONE, GL_ONE, GL_ONE, GL_RED};
  glTexParameteriv(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_RGBA, whiteWithAlpha.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glBindTexture(GL_TEXTURE_2D, 0);
  atlas.SetTexID(guiTexture(fonts_.id()));
}

void GuiRenderer::bind(int width, int height) const {
  glViewport(0, 0, width, height);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glEnable(GL_SCISSOR_TEST);
  glEnable(GL_BLEND);
  glBlendEquation(GL_FUNC_ADD);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glActiveTexture(GL_TEXTURE0);
  glUseProgram(program_.id());
  glUniform2f(toClip_, 2.0f / static_cast<float>(width), -2.0f / static_cast<float>(height));
  glBindVertexArray(array_.id());
  glBindBuffer(GL_ARRAY_BUFFER, vertices_.id());
}

void GuiRenderer::drawList(const ImDrawList& list, const ImDrawData& data) const {
  const int width = static_cast<int>(data.DisplaySize.x);
  const int height = static_cast<int>(data.DisplaySize.y);
  glBufferData(GL_ARRAY_BUFFER, list.VtxBuffer.size_in_bytes(), list.VtxBuffer.Data,
               GL_STREAM_DRAW);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, list.IdxBuffer.size_in_bytes(), list.IdxBuffer.Data,
               GL_STREAM_DRAW);
  for (const ImDrawCmd& command : list.CmdBuffer) {
    if (command.UserCallback != nullptr) {
      if (command.UserCallback != ImDrawCallback_ResetRenderState)
        command.UserCallback(&list, &command);
      bind(width, height);  // the callback may have changed anything
      continue;
    }
    const int left = std::max(0, static_cast<int>(command.ClipRect.x - data.DisplayPos.x));
    const int top = std::max(0, static_cast<int>(command.ClipRect.y - data.DisplayPos.y));
    const int right = std::min(width, static_cast<int>(command.ClipRect.z - data.DisplayPos.x));
    const int bottom = std::min(height, static_cast<int>(command.ClipRect.w - data.DisplayPos.y));
    if (right <= left || bottom <= top || command.ElemCount == 0) continue;
    glScissor(left, height - bottom, right - left, bottom - top);
    // Commands of the frame in which the atlas changed do not know its texture yet.
    const GLuint texture = textureName(command.GetTexID());
    glBindTexture(GL_TEXTURE_2D, texture == 0 ? fonts_.id() : texture);
    static_assert(sizeof(ImDrawIdx) == 2);
    glDrawElementsBaseVertex(GL_TRIANGLES, static_cast<GLsizei>(command.ElemCount),
                             GL_UNSIGNED_SHORT, offset(command.IdxOffset * sizeof(ImDrawIdx)),
                             static_cast<GLint>(command.VtxOffset));
  }
}

void GuiRenderer::draw(const ImDrawData& data) {
  const int width = static_cast<int>(data.DisplaySize.x);
  const int height = static_cast<int>(data.DisplaySize.y);
  if (width <= 0 || height <= 0) return;
  takeFonts(*ImGui::GetIO().Fonts);

  bind(width, height);
  for (int i = 0; i < data.CmdListsCount; ++i) drawList(*data.CmdLists[i], data);

  glDisable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ZERO);
  glDisable(GL_SCISSOR_TEST);
  glBindTexture(GL_TEXTURE_2D, 0);
  glBindVertexArray(0);
  glBindBuffer(GL_ARRAY_BUFFER, 0);
  glUseProgram(0);
}

}  // namespace dapple
