// Material channels of a textured scan: what further images of the swatches say of each point,
// read at the very texels, and with the very weights, that its colour is made of.
//
// A panel attaches channels by SetSwatch with the same path and crop as before: reference.channels
// names the files, findChannels asks for those that lie beside the swatch under the usual names.
// Results of the same image use the region's channels from then on. None is out of date for that,
// unless its options give the height map a weight and the heights are others.
#pragma once

#include "document/document.h"
#include "io/point_io.h"

namespace dapple {

using ReadImage = std::function<Image(const std::filesystem::path&)>;

// The maps that reference.channels names, cut as the swatch is; null: it names none. `whole` is the
// image of the swatch before it was cut. `failed`, where it is given, is told the error of each
// channel that cannot be had, which is then left out; else the error is thrown: IoError,
// InvalidInput (another size than the swatch has).
std::shared_ptr<const MaterialMaps> readMaps(
    const SwatchReference& reference, const Image& whole, const ReadImage& read,
    const std::function<void(Channel, const std::string&)>& failed = {});

// Whether a synthesis with these options is the same whichever of these maps, which may be null,
// its swatch has.
bool sameHeights(const MaterialMaps* a, const MaterialMaps* b, const TextureOptions& options);

// What is known of the points' material.
struct PointChannels {
  // By channel: n values, NaN where there is none; empty: no point has one.
  std::array<std::vector<float>, kScalarChannels> scalar;
  // n unit vectors, model directions: the normal map's, turned into the point's frame; the point's
  // own normal where there is none. Empty: no point has one.
  std::vector<vec3> normal;

  bool empty() const;
};

// Of all results. Nothing where nothing is synthesized. Throws Cancelled.
PointChannels channelsOf(const Document& document, Monitor& monitor);

// Of one source map over all points, of source.swatch and source.maps.
PointChannels channelsOf(const SourceMap& map, const ResultSource& source,
                         const std::vector<vec3>& normals, Monitor& monitor);

// As columns of a scan's vertices: roughness, height, metallic, ao (float, NaN: none), mapped_nx,
// mapped_ny, mapped_nz (float).
void addChannels(RecordTable& table, const Scan& scan, const PointChannels& channels);

// What addChannels() wrote.
PointChannels readChannels(const Scan& scan);

}  // namespace dapple
