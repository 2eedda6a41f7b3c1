// Points to a picture without a display.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "app/render/splats.h"
#include "app/render/views.h"
#include "base/parallel.h"
#include "points/neighborhoods.h"
#include "swatch/image.h"
#include "synthesis/source_map.h"

namespace dapple {

// Drawn over the picture; see overlay.h.
enum class Overlay { None, Directions, Regions };

struct PictureOptions {
  std::string view = "front";
  std::optional<vec3> eye, target;  // model coordinates; in place of a view when both are there
  int width = 1280, height = 720;
  bool zUp = false;  // the scan's z axis points up, not y
  Shading shading = Shading::Off;
  vec3 background{1};  // 0..1
  Overlay overlay = Overlay::None;
  View show = View::Colour;
  std::string renderer = "auto";  // auto|gl|cpu
  std::string texels = "auto";    // auto|on|off: the swatch inside the splats
  bool orthographic = false;
  int turntable = 0;  // pictures round the vertical axis; 0: one, not turned
};

// What the picture shows: columns of n elements.
struct PictureInput {
  const PointSet& points;  // with normals
  const Neighborhoods& neighborhoods;
  const ViewColumns& columns;
  const SourceMap* map = nullptr;  // with a swatch: for the swatch inside the splats
  const Swatch* swatch = nullptr;
};

// Gives take(k, picture) every picture, k from 0. Throws InvalidInput (a view whose column is not
// there, a size out of range).
void drawPictures(const PictureInput& input, const PictureOptions& options, Workers& workers,
                  const std::function<void(int, const Image&)>& take);

// The first of them.
Image drawPicture(const PictureInput& input, const PictureOptions& options, Workers& workers);

// Throws InvalidInput for a view or a renderer that drawPicture() would refuse: before the long
// work, not after.
void checkPicture(const PictureOptions& options);

// What the options say. All throw InvalidInput.
void parseSize(const std::string& text, PictureOptions& options);  // "1280x720"
Shading shadingNamed(const std::string& name);                     // "off", "headlight", "studio"
Overlay overlayNamed(const std::string& name);  // "none", "directions", "regions"
vec3 parseColour(const std::string& text);      // "white", "grey", "black", "#a0b0ff", "1,20,255"

}  // namespace dapple
