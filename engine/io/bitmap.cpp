#include "io/bitmap.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/errors.h"
#include "io/output_file.h"

namespace dapple {
namespace {

constexpr std::uint32_t kHeader = 54, kInfo = 40;  // bytes

void put(std::string& out, std::uint32_t value, int bytes) {
  for (int b = 0; b < bytes; ++b) out += static_cast<char>((value >> (8 * b)) & 255);
}

}  // namespace

void saveBitmap(const std::filesystem::path& path, int width, int height,
                std::span<const vec3> colours) {
  const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
  DAPPLE_CHECK(colours.size(), ==, w * h);
  const std::size_t row = (3 * w + 3) / 4 * 4;
  std::string out = "BM";
  put(out, static_cast<std::uint32_t>(kHeader + row * h), 4);
  put(out, 0, 4);
  put(out, kHeader, 4);
  put(out, kInfo, 4);
  put(out, static_cast<std::uint32_t>(width), 4);
  put(out, static_cast<std::uint32_t>(height), 4);
  put(out, 1, 2);   // plane
  put(out, 24, 2);  // bits a pixel
  put(out, 0, 4);   // not compressed
  put(out, static_cast<std::uint32_t>(row * h), 4);
  for (int unused = 0; unused < 4; ++unused) put(out, 0, 4);
  for (std::size_t y = h; y-- > 0;) {  // the last row first; blue, green, red
    for (std::size_t x = 0; x < w; ++x)
      for (int c = 2; c >= 0; --c) {
        const float level = std::clamp(colours[y * w + x][c], 0.f, 1.f);
        out += static_cast<char>(std::lround(level * 255));
      }
    out.resize(out.size() + row - 3 * w, 0);
  }
  OutputFile file(path);
  file.write(out.data(), out.size());
  file.commit();
}

}  // namespace dapple
