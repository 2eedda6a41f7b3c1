#include "document/channels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/errors.h"
#include "document/edits.h"
#include "points/tangent_frames.h"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 4096;
constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
constexpr std::array<const char*, 3> kNormalNames{"mapped_nx", "mapped_ny", "mapped_nz"};

constexpr std::array kScalars{Channel::Roughness, Channel::Height, Channel::Metallic,
                              Channel::Occlusion};
static_assert(kScalars.size() == kScalarChannels);

// One region's own, as it is now; else what the result was made with.
const MaterialMaps* mapsOf(const Document& document, const ResultSource& source) {
  const Region* region = findRegion(document, source.region);
  if (region && sameImage(region->reference, source.reference)) return region->maps.get();
  return source.maps.get();
}

void checkSize(const Image& image, const std::string& file, const Image& whole,
               const std::string& swatch) {
  if (image.width == whole.width && image.height == whole.height) return;
  throw InvalidInput(
      fmt::format("{}: {} x {} pixels, but its swatch {} has {} x {}; give images of the same size",
                  file, image.width, image.height, swatch, whole.width, whole.height));
}

// What the columns are made of. By source: its maps, null: none.
struct Ground {
  const Results& results;
  const std::vector<const MaterialMaps*>& maps;
  const std::vector<vec3>& normals;
};

// Terms without the channel have no say.
float scalarAt(const Ground& ground, Channel channel, std::span<const SourceTerm> terms) {
  float sum = 0, weight = 0;
  for (const SourceTerm& term : terms) {
    const MaterialMaps* maps = ground.maps[term.source];
    if (!maps || !maps->has(channel)) continue;
    const bool tileable = ground.results.sources[term.source]->swatch->tileable;
    sum += term.weight * sampleScalar(*maps, channel, term.texel, tileable);
    weight += term.weight;
  }
  return weight > 0 ? sum / weight : kNothing;
}

// Terms without a normal map say that the surface is as it is.
vec3 normalAt(const Ground& ground, Index point, std::span<const SourceTerm> terms) {
  const vec3 own = ground.normals[point];
  vec3 sum(0);
  for (const SourceTerm& term : terms) {
    const MaterialMaps* maps = ground.maps[term.source];
    vec3 n(0, 0, 1);
    if (maps && maps->has(Channel::Normal)) {
      n = sampleNormal(*maps, term.texel, ground.results.sources[term.source]->swatch->tileable);
      const float length = glm::length(n);
      n = length > 1e-6f ? n / length : vec3(0, 0, 1);
    }
    const TangentFrame frame = orthonormalFrame(own, term.up);
    sum += term.weight * (n.x * frame.s + n.y * frame.t + n.z * frame.n);
  }
  const float length = glm::length(sum);
  return length > 1e-6f ? sum / length : own;
}

PointChannels columnsOf(const Ground& ground, Monitor& monitor) {
  PointChannels out;
  const std::size_t n = ground.normals.size();
  const auto any = [&](Channel channel) {
    return std::any_of(ground.maps.begin(), ground.maps.end(),
                       [&](const MaterialMaps* maps) { return maps && maps->has(channel); });
  };
  std::vector<Channel> wanted;
  for (const Channel channel : kScalars)
    if (any(channel)) {
      wanted.push_back(channel);
      out.scalar[static_cast<std::size_t>(channel)].resize(n);
    }
  if (any(Channel::Normal)) out.normal.resize(n);
  if (out.empty()) return out;
  parallelFor(monitor, n, kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<SourceTerm> terms;
    for (std::size_t i = begin; i < end; ++i) {
      const auto point = static_cast<Index>(i);
      gatherTerms(ground.results, point, terms);
      for (const Channel channel : wanted)
        out.scalar[static_cast<std::size_t>(channel)][i] = scalarAt(ground, channel, terms);
      if (!out.normal.empty()) out.normal[i] = normalAt(ground, point, terms);
    }
  });
  return out;
}

}  // namespace

std::shared_ptr<const MaterialMaps> readMaps(
    const SwatchReference& reference, const Image& whole, const ReadImage& read,
    const std::function<void(Channel, const std::string&)>& failed) {
  if (reference.channels.empty()) return nullptr;
  MaterialMaps maps;
  for (std::size_t c = 0; c < kChannels; ++c) {
    const std::string& file = reference.channels.paths[c];
    if (file.empty()) continue;
    try {
      const Image image = read(file);
      checkSize(image, file, whole, reference.path);
      const Image cut = cropped(image, reference);
      maps.width = cut.width, maps.height = cut.height;
      addMap(maps, static_cast<Channel>(c), cut, file, reference.channels.greenDown);
    } catch (const std::runtime_error& error) {
      if (!failed) throw;
      failed(static_cast<Channel>(c), error.what());
    }
  }
  if (maps.bytes() == 0) return nullptr;
  return std::make_shared<const MaterialMaps>(std::move(maps));
}

bool sameHeights(const MaterialMaps* a, const MaterialMaps* b, const TextureOptions& options) {
  const std::vector<float>*of = heightsCompared(a, options), *other = heightsCompared(b, options);
  return of == other || (of && other && *of == *other);
}

bool PointChannels::empty() const {
  return normal.empty() && std::all_of(scalar.begin(), scalar.end(),
                                       [](const auto& column) { return column.empty(); });
}

PointChannels channelsOf(const Document& document, Monitor& monitor) {
  std::vector<const MaterialMaps*> maps;
  for (const auto& source : document.results.sources)
    maps.push_back(source->swatch ? mapsOf(document, *source) : nullptr);
  if (!document.scan) return {};
  return columnsOf({document.results, maps, document.points().normals}, monitor);
}

PointChannels channelsOf(const SourceMap& map, const ResultSource& source,
                         const std::vector<vec3>& normals, Monitor& monitor) {
  const Results results = resultsOf(map, source);
  const std::vector<const MaterialMaps*> maps{source.maps.get()};
  return columnsOf({results, maps, normals}, monitor);
}

void addChannels(RecordTable& table, const Scan& scan, const PointChannels& channels) {
  Element* vertices = table.find("vertex");
  DAPPLE_CHECK(vertices != nullptr, ==, true);
  for (const Channel channel : kScalars) {
    const std::vector<float>& column = channels.scalar[static_cast<std::size_t>(channel)];
    if (!column.empty())
      setColumn(*vertices, std::string(channelName(channel)), byRecord(scan, column, kNothing));
  }
  if (channels.normal.empty()) return;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> column;
    for (const vec3& n : channels.normal) column.push_back(n[axis]);
    setColumn(*vertices, kNormalNames[static_cast<std::size_t>(axis)], byRecord(scan, column, 0.f));
  }
}

PointChannels readChannels(const Scan& scan) {
  PointChannels out;
  const auto column = [&](const char* name) -> std::vector<float> {
    const Element* vertices = scan.table.find("vertex");
    const Property* property = vertices ? vertices->find(name) : nullptr;
    if (!property || property->isList) return {};
    std::vector<float> values;
    for (const std::size_t record : scan.record)
      values.push_back(static_cast<float>(property->at(record)));
    return values;
  };
  for (const Channel channel : kScalars)
    out.scalar[static_cast<std::size_t>(channel)] =
        column(std::string(channelName(channel)).c_str());
  std::array<std::vector<float>, 3> normal;
  for (std::size_t axis = 0; axis < 3; ++axis) normal[axis] = column(kNormalNames[axis]);
  if (normal[0].empty() || normal[1].empty() || normal[2].empty()) return out;
  for (std::size_t i = 0; i < normal[0].size(); ++i)
    out.normal.emplace_back(normal[0][i], normal[1][i], normal[2][i]);
  return out;
}

}  // namespace dapple
