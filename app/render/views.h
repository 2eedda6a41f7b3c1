// What a picture of points can show: each view maps a column to colours.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/monitor.h"
#include "base/types.h"

namespace dapple {

enum class View {
  Colour,
  Normals,
  State,
  Patch,
  Distortion,
  Order,
  Regions,
  Coordinates,
  Roughness,
  Height,
  Metallic,
  Occlusion,
  MappedNormals
};

// The one list of views, for window, command line and help.
struct NamedView {
  std::string_view name;
  View view;
  std::string_view shows;  // a few words
};
std::span<const NamedView> allViews();
// Throws InvalidInput.
View viewNamed(std::string_view name);
// All names with `separator` between them.
std::string viewNames(std::string_view separator);

// n elements a column, or none when it is not known (the columns of a SourceMap, borrowed).
struct ViewColumns {
  std::span<const vec3> colours;  // 0..1
  std::span<const vec3> normals;  // unit length
  std::span<const PointState> state;
  std::span<const Index> patch;   // kNone: in no patch
  std::span<const float> error;   // not finite: not known
  std::span<const Index> order;   // kNone: never decided
  std::span<const Index> region;  // kNone: in no region
  std::span<const vec2> texel;    // swatch pixels; where state is Free, or NaN: none
  ivec2 swatchSize{0};            // pixels; 0: not known, then the largest texel is taken for it
  // Material channels (document/channels.h); not finite: none.
  std::span<const float> roughness, height, metallic, occlusion;
  std::span<const vec3> mappedNormals;  // unit length
};

// What the two ends of the heat map's colours stand for.
struct HeatRange {
  float low = 0, high = 0;
};

// Whether a view is of a material channel.
bool isChannel(View view);

struct ViewColours {
  std::vector<vec3> colours;  // n, 0..1
  // Of a heat map: the smallest and largest value of the column, but no further than twice as far
  // from the smallest as nine tenths of the values lie; what is above is drawn as that.
  std::optional<HeatRange> legend;
};

// The colours of a view. Throws InvalidInput when its column is empty.
ViewColours viewColours(View view, const ViewColumns& columns);

// free, patch, gap and matched: grey, blue, orange and green that the colour-blind can tell apart.
vec3 stateColour(PointState state);
// Neighbouring ids get very different hues; kNone is grey.
vec3 patchColour(Index patch);
// As patchColour, but calm: twelve muted colours of like lightness, in ever other shades; kNone is
// grey.
vec3 regionColour(Index region);
// Where a texel lies in the swatch, 0..1: red to the right, green downwards.
vec3 coordinateColour(vec2 place);
// t in 0..1 (clamped): dark violet over green to light yellow, equal steps looking equal, and
// always lighter, so that it also reads in grey.
vec3 heatColour(float t);

}  // namespace dapple
