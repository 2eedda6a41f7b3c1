// An OpenGL 3.3 core context without a display (OSMesa).
#pragma once

#include <memory>

namespace dapple {

// Current in the thread that makes it, until it dies in that thread; one at a time in a process,
// because the loaded OpenGL functions are shared. Draw into framebuffers of your own.
class OffscreenContext {
 public:
  // Throws std::runtime_error when there is none to be had.
  OffscreenContext();
  ~OffscreenContext();
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;

 private:
  struct Handle;
  std::unique_ptr<Handle> handle_;
};

}  // namespace dapple
