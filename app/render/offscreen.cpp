#include "app/render/offscreen.h"

// glad first: GL/osmesa.h pulls in GL/gl.h, which glad refuses to follow.
#include <glad/gl.h>

#include <GL/osmesa.h>

#include <array>
#include <stdexcept>

#include "app/render/gl_objects.h"

namespace dapple {
namespace {

constexpr int kSide = 16;  // of the context's own buffer, which nobody looks at

}  // namespace

struct OffscreenContext::Handle {
  OSMesaContext context = nullptr;
  std::array<unsigned char, kSide * kSide * 4> pixels{};

  ~Handle() {
    OSMesaMakeCurrent(nullptr, nullptr, 0, 0, 0);
    if (context != nullptr) OSMesaDestroyContext(context);
  }
};

OffscreenContext::OffscreenContext() : handle_(std::make_unique<Handle>()) {
  const int attributes[] = {OSMESA_FORMAT,
                            OSMESA_RGBA,
                            OSMESA_PROFILE,
                            OSMESA_CORE_PROFILE,
                            OSMESA_CONTEXT_MAJOR_VERSION,
                            3,
                            OSMESA_CONTEXT_MINOR_VERSION,
                            3,
                            0};
  handle_->context = OSMesaCreateContextAttribs(attributes, nullptr);
  if (handle_->context == nullptr || OSMesaMakeCurrent(handle_->context, handle_->pixels.data(),
                                                       GL_UNSIGNED_BYTE, kSide, kSide) == GL_FALSE)
    throw std::runtime_error(
        "OSMesa gives no OpenGL 3.3 core context, so no picture can be drawn; install libosmesa6 "
        "22 or newer.");
  if (gladLoadGL(reinterpret_cast<GLADloadfunc>(OSMesaGetProcAddress)) == 0)
    throw std::runtime_error("OSMesa's OpenGL functions cannot be loaded; reinstall libosmesa6.");
  collectGlMessages();
}

OffscreenContext::~OffscreenContext() = default;

}  // namespace dapple
