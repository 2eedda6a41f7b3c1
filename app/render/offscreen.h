// An OpenGL context without a display (OSMesa). Throws std::runtime_error when there is none.
#pragma once

#include <memory>

namespace dapple {

class OffscreenContext {
 public:
  OffscreenContext();
  ~OffscreenContext();
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;

 private:
  struct Handle;
  std::unique_ptr<Handle> handle_;
};

}  // namespace dapple
