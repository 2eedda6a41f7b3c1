#include "document/corner_texture.h"

#include <algorithm>
#include <cstring>

#include "base/errors.h"
#include "base/parallel.h"
#include "io/bitmap.h"
#include "io/obj.h"
#include "points/tangent_frames.h"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 4096;
constexpr float kNear = 0.5f;  // of the distance from the explaining corner: places that agree

// Where a point lies in a swatch.
struct PointPlace {
  std::uint16_t source = kNoSource;
  vec2 texel{0};
  vec3 s{0}, t{0};  // the swatch's axes
  float unit = 1;   // local units per pixel
};

const Property* cornersIn(const Scan& scan) {
  const Element* faces = scan.table.find("face");
  if (!faces || faces->count == 0) return nullptr;
  const Property* corners = faces->find("vertex_indices");
  if (!corners) corners = faces->find("vertex_index");
  return corners && corners->isList ? corners : nullptr;
}

PointPlace placeOf(const Results& results, const PointSet& points, Index i,
                   std::vector<SourceTerm>& terms) {
  PointPlace place;
  gatherTerms(results, i, terms);
  const auto heaviest = std::max_element(
      terms.begin(), terms.end(),
      [](const SourceTerm& a, const SourceTerm& b) { return a.weight < b.weight; });
  if (heaviest == terms.end() || !results.sources[heaviest->source]->swatch) return place;
  const ResultSource& source = *results.sources[heaviest->source];
  place.source = heaviest->source;
  place.texel = wrapTexel(*source.swatch, heaviest->texel);
  place.unit = source.unit;
  const bool own = heaviest->source == (*results.source)[i];
  const TangentFrame frame =
      own ? (*results.frame)[i] : orthonormalFrame(points.normals[i], heaviest->up);
  place.s = frame.s, place.t = frame.t;
  if (own && results.scale) place.unit *= (*results.scale)[i];
  return place;
}

class CornerLayer {
 public:
  CornerLayer(const Results& results, const Scan& scan, const Property& corners, Monitor& monitor)
      : results_(results), scan_(scan), corners_(corners), monitor_(monitor) {}

  CornerTexture run() {
    findPlaces();
    const std::size_t faces = corners_.listOffsets.size() - 1;
    CornerTexture out;
    out.coordinates.assign(corners_.listOffsets.back(), vec2(0));
    out.texture.assign(faces, -1);
    parallelFor(monitor_, faces, kGrain, [&](std::size_t begin, std::size_t end) {
      Face face;
      for (std::size_t f = begin; f < end; ++f) layFace(f, face, out);
    });
    number(out);
    return out;
  }

 private:
  struct Face {
    std::vector<Index> points;  // by corner; kNone: its record has none
    std::vector<vec2> tried, best;
  };

  void findPlaces() {
    places_.resize(scan_.points.size());
    parallelFor(monitor_, places_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      std::vector<SourceTerm> terms;
      for (std::size_t i = begin; i < end; ++i)
        places_[i] = placeOf(results_, scan_.points, static_cast<Index>(i), terms);
    });
  }

  // Texels of all corners as corner `from` has them; how badly that explains the others.
  float lay(std::size_t from, const Face& face, std::vector<vec2>& texels) const {
    const PointPlace& base = places_[face.points[from]];
    const Swatch& swatch = *results_.sources[base.source]->swatch;
    const vec2 size(swatch.width, swatch.height);
    const vec3 origin = scan_.points.positions[face.points[from]];
    float cost = 0;
    texels.assign(face.points.size(), base.texel);
    for (std::size_t c = 0; c < face.points.size(); ++c) {
      if (c == from || face.points[c] == kNone) continue;
      const vec3 way = scan_.points.positions[face.points[c]] - origin;
      const float far = glm::length(way) / base.unit;
      // Projected and not rolled out: then the face gets no larger.
      texels[c] += vec2(glm::dot(way, base.s), -glm::dot(way, base.t)) / base.unit;
      const PointPlace& own = places_[face.points[c]];
      float apart = far;
      if (own.source == base.source) {
        vec2 texel = own.texel;
        if (swatch.tileable) texel += size * glm::round((texels[c] - texel) / size);
        apart = glm::length(texel - texels[c]);
        if (apart <= kNear * far) texels[c] = texel;
      }
      if (!swatch.tileable) {
        const vec2 inside = glm::clamp(texels[c], vec2(0.5f), size - 0.5f);
        apart += glm::length(inside - texels[c]);
        texels[c] = inside;
      }
      cost += std::min(apart, far);
    }
    return cost;
  }

  void layFace(std::size_t f, Face& face, CornerTexture& out) const {
    const std::size_t begin = corners_.listOffsets[f], end = corners_.listOffsets[f + 1];
    face.points.clear();
    for (std::size_t k = begin; k < end; ++k) {
      const double record = corners_.at(k);
      const bool there = record >= 0 && record < static_cast<double>(scan_.pointOf.size());
      face.points.push_back(there ? scan_.pointOf[static_cast<std::size_t>(record)] : kNone);
    }
    float least = 0;
    for (std::size_t c = 0; c < face.points.size(); ++c) {
      if (face.points[c] == kNone || places_[face.points[c]].source == kNoSource) continue;
      const float cost = lay(c, face, face.tried);
      if (out.texture[f] >= 0 && cost >= least) continue;
      least = cost;
      out.texture[f] = places_[face.points[c]].source;
      std::swap(face.tried, face.best);
    }
    if (out.texture[f] < 0) return;
    const Swatch& swatch = *results_.sources[static_cast<std::size_t>(out.texture[f])]->swatch;
    for (std::size_t k = begin; k < end; ++k) {
      const vec2 at = face.best[k - begin] / vec2(swatch.width, swatch.height);
      out.coordinates[k] = {at.x, 1 - at.y};
    }
  }

  // From sources to textures: those in use, one for each image.
  void number(CornerTexture& out) const {
    std::vector<std::int32_t> textureOf(results_.sources.size(), -1);
    std::vector<bool> used(results_.sources.size(), false);
    for (const std::int32_t source : out.texture)
      if (source >= 0) used[static_cast<std::size_t>(source)] = true;
    for (std::size_t s = 0; s < used.size(); ++s) {
      if (!used[s]) continue;
      for (std::size_t t = 0; t < out.sources.size() && textureOf[s] < 0; ++t)
        if (sameImage(results_.sources[out.sources[t]]->reference, results_.sources[s]->reference))
          textureOf[s] = static_cast<std::int32_t>(t);
      if (textureOf[s] >= 0) continue;
      textureOf[s] = static_cast<std::int32_t>(out.sources.size());
      out.sources.push_back(static_cast<std::uint16_t>(s));
    }
    for (std::int32_t& texture : out.texture)
      if (texture >= 0) texture = textureOf[static_cast<std::size_t>(texture)];
  }

  const Results& results_;
  const Scan& scan_;
  const Property& corners_;
  Monitor& monitor_;
  std::vector<PointPlace> places_;
};

template <class T>
void setBytes(Property& property, const std::vector<T>& values) {
  property.values.resize(values.size() * sizeof(T));
  std::memcpy(property.values.data(), values.data(), property.values.size());
}

}  // namespace

CornerTexture cornersOf(const Results& results, const Scan& scan, Monitor& monitor) {
  const Property* corners = cornersIn(scan);
  if (!corners || !results.source) return {};
  return CornerLayer(results, scan, *corners, monitor).run();
}

std::vector<std::string> textureFiles(const CornerTexture& corners, const Results& results,
                                      const std::filesystem::path& output) {
  namespace fs = std::filesystem;
  std::vector<std::string> files;
  const fs::path folder = fs::absolute(output).lexically_normal().parent_path();
  for (const std::uint16_t s : corners.sources) {
    const ResultSource& source = *results.sources[s];
    fs::path file = fs::absolute(source.reference.path).lexically_normal();
    if (source.reference.crop) {
      file = folder / fmt::format("{}_swatch{}.bmp", output.stem().string(), files.size());
      saveBitmap(file, source.swatch->width, source.swatch->height, source.swatch->colours());
    }
    files.push_back(file.lexically_proximate(folder).generic_string());
  }
  return files;
}

void addCorners(RecordTable& table, const CornerTexture& corners,
                const std::vector<std::string>& files) {
  if (corners.empty()) return;
  Element& faces = *table.find("face");
  std::erase_if(faces.properties, [](const Property& property) {
    return property.name == "texcoord" || property.name == "texnumber";
  });
  const Property* indices = faces.find("vertex_indices");
  if (!indices) indices = faces.find("vertex_index");
  Property texcoord{.name = "texcoord", .type = ScalarType::Float32, .isList = true};
  std::size_t longest = 0;
  for (std::size_t f = 0; f <= faces.count; ++f) {
    texcoord.listOffsets.push_back(2 * indices->listOffsets[f]);
    if (f > 0) longest = std::max(longest, texcoord.listOffsets[f] - texcoord.listOffsets[f - 1]);
  }
  if (longest > 255) texcoord.countType = ScalarType::UInt32;
  setBytes(texcoord, corners.coordinates);
  faces.properties.push_back(std::move(texcoord));
  const bool bare =
      std::find(corners.texture.begin(), corners.texture.end(), -1) != corners.texture.end();
  if (bare || files.size() > 1)
    setColumn(faces, "texnumber", std::span<const std::int32_t>(corners.texture));
  std::erase_if(table.comments,
                [](const std::string& line) { return line.starts_with(kTextureComment); });
  for (const std::string& file : files)
    table.comments.push_back(std::string(kTextureComment) + file);
}

}  // namespace dapple
