#include "app/render/offscreen.h"

// glad first: GL/osmesa.h pulls in GL/gl.h, which glad refuses to follow.
#include <glad/gl.h>

#include <GL/osmesa.h>

#include <array>
#include <optional>
#include <stdexcept>

#include "app/render/gl_objects.h"
#include "app/render/shared_library.h"

namespace dapple {
namespace {

constexpr int kSide = 16;  // of the context's own buffer, which nobody looks at

// Loaded by whoever draws with it, not with the program: OSMesa brings LLVM along, together 44 MB
// of memory in every run.
struct MesaLibrary {
  decltype(&OSMesaCreateContextAttribs) createContext;
  decltype(&OSMesaMakeCurrent) makeCurrent;
  decltype(&OSMesaDestroyContext) destroyContext;
  decltype(&OSMesaGetProcAddress) functionNamed;
};

std::optional<MesaLibrary> openMesa() {
  void* const so = ::dlopen("libOSMesa.so.8", RTLD_LAZY | RTLD_LOCAL);
  if (so == nullptr) return {};
  MesaLibrary mesa{};
  const bool all = findFunction(so, "OSMesaCreateContextAttribs", mesa.createContext) &&
                   findFunction(so, "OSMesaMakeCurrent", mesa.makeCurrent) &&
                   findFunction(so, "OSMesaDestroyContext", mesa.destroyContext) &&
                   findFunction(so, "OSMesaGetProcAddress", mesa.functionNamed);
  if (!all) return {};
  return mesa;
}

const MesaLibrary& loadMesa() {
  static const std::optional<MesaLibrary> library = openMesa();
  if (!library)
    throw std::runtime_error(
        "there is no OSMesa (libOSMesa.so.8), so OpenGL cannot draw without a display; install "
        "libosmesa6.");
  return *library;
}

}  // namespace

struct OffscreenContext::Handle {
  const MesaLibrary& mesa = loadMesa();
  OSMesaContext context = nullptr;
  std::array<unsigned char, kSide * kSide * 4> pixels{};

  ~Handle() {
    mesa.makeCurrent(nullptr, nullptr, 0, 0, 0);
    if (context != nullptr) mesa.destroyContext(context);
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
  const MesaLibrary& mesa = handle_->mesa;
  handle_->context = mesa.createContext(attributes, nullptr);
  if (handle_->context == nullptr || mesa.makeCurrent(handle_->context, handle_->pixels.data(),
                                                      GL_UNSIGNED_BYTE, kSide, kSide) == GL_FALSE)
    throw std::runtime_error(
        "OSMesa gives no OpenGL 3.3 core context, so no picture can be drawn; install libosmesa6 "
        "22 or newer.");
  if (gladLoadGL(reinterpret_cast<GLADloadfunc>(mesa.functionNamed)) == 0)
    throw std::runtime_error("OSMesa's OpenGL functions cannot be loaded; reinstall libosmesa6.");
  collectGlMessages();
}

OffscreenContext::~OffscreenContext() = default;

}  // namespace dapple
