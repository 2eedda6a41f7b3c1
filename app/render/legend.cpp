#include "app/render/legend.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>

namespace dapple {
namespace {

// A font of 3 x 5 dots, rows from the top.
struct Glyph {
  char character;
  std::string_view dots;
};
constexpr int kGlyphWidth = 3, kGlyphHeight = 5;
constexpr Glyph kGlyphs[] = {
    {'0', "####.##.##.####"}, {'1', ".#.##..#..#.###"}, {'2', "###..#####..###"},
    {'3', "###..####..####"}, {'4', "#.##.####..#..#"}, {'5', "####..###..####"},
    {'6', "####..####.####"}, {'7', "###..#.#..#..#."}, {'8', "####.#####.####"},
    {'9', "####.####..####"}, {'.', "............#.."}, {'-', "......###......"},
    {'e', "...####.##..###"}, {'+', "....#.###.#...."},
};

// In dots of the font.
constexpr int kBarWidth = 96, kBarHeight = 6, kGap = 2, kMargin = 4;
constexpr int kPanelWidth = kBarWidth + 2 * kGap;
constexpr int kPanelHeight = kBarHeight + kGlyphHeight + 3 * kGap;
constexpr int kPictureHeightPerDot = 240;  // pixels

constexpr vec3 kPaper{1, 1, 1}, kInk{0, 0, 0};

// A picture in which one dot is a square of pixels.
struct Canvas {
  Image& picture;
  int x, y;  // of dot (0, 0), pixels
  int dot;   // pixels

  void fill(int left, int top, int width, int height, const vec3& colour) {
    for (int py = y + top * dot; py < y + (top + height) * dot; ++py)
      for (int px = x + left * dot; px < x + (left + width) * dot; ++px) set(px, py, colour);
  }
  void set(int px, int py, const vec3& colour) {
    for (int c = 0; c < picture.channels; ++c) picture.at(px, py, c) = c < 3 ? colour[c] : 1.0f;
  }
};

int textWidth(std::string_view text) {
  return static_cast<int>(text.size()) * (kGlyphWidth + 1) - 1;
}

void drawText(Canvas& canvas, int left, int top, std::string_view text) {
  for (char character : text) {
    for (const Glyph& glyph : kGlyphs)
      for (int i = 0; glyph.character == character && i < kGlyphWidth * kGlyphHeight; ++i)
        if (glyph.dots[i] == '#')
          canvas.fill(left + i % kGlyphWidth, top + i / kGlyphWidth, 1, 1, kInk);
    left += kGlyphWidth + 1;
  }
}

}  // namespace

void drawLegend(Image& picture, const HeatRange& range) {
  const int dot = std::max(1, picture.height / kPictureHeightPerDot);
  const int width = (kPanelWidth + 2 * kMargin) * dot, height = (kPanelHeight + 2 * kMargin) * dot;
  if (picture.width < width || picture.height < height) return;
  Canvas canvas{picture, kMargin * dot, picture.height - height + kMargin * dot, dot};
  canvas.fill(0, 0, kPanelWidth, kPanelHeight, kPaper);

  const int barPixels = kBarWidth * dot;
  for (int px = 0; px < barPixels; ++px) {
    const vec3 colour = heatColour(static_cast<float>(px) / static_cast<float>(barPixels - 1));
    for (int py = 0; py < kBarHeight * dot; ++py)
      canvas.set(canvas.x + kGap * dot + px, canvas.y + kGap * dot + py, colour);
  }

  const std::string low = fmt::format("{:.4g}", range.low),
                    high = fmt::format("{:.4g}", range.high);
  const int top = kBarHeight + 2 * kGap;
  drawText(canvas, kGap, top, low);
  drawText(canvas, kGap + kBarWidth - textWidth(high), top, high);
}

}  // namespace dapple
