#include "document/document.h"

#include <algorithm>
#include <cstring>
#include <set>

#include "base/errors.h"
#include "document/options_table.h"

namespace dapple {
namespace {

template <class T>
std::size_t bytesOf(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

template <class T>
void note(std::vector<MemoryBlock>& blocks, const Column<T>& column) {
  if (column) blocks.push_back({column.get(), bytesOf(*column)});
}

std::size_t bytesOf(const RecordTable& table) {
  std::size_t sum = 0;
  for (const Element& element : table.elements)
    for (const Property& property : element.properties)
      sum += bytesOf(property.values) + bytesOf(property.listOffsets);
  return sum;
}

std::size_t bytesOf(const PreparedScan& prepared) {
  const Scan& scan = prepared.scan;
  return bytesOf(scan.points.positions) + bytesOf(scan.points.normals) +
         bytesOf(scan.points.colours) + bytesOf(scan.mesh.triangles) + bytesOf(scan.table) +
         bytesOf(scan.record) + bytesOf(scan.pointOf) + bytesOf(prepared.neighborhoods.ids);
}

std::size_t bytesOf(const Swatch& swatch) {
  std::size_t sum = bytesOf(swatch.opaque) + swatch.tables.bytes();
  for (const auto& level : swatch.stack) sum += bytesOf(level);
  for (const auto& level : swatch.relief) sum += bytesOf(level);
  return sum;
}

void note(std::vector<MemoryBlock>& blocks, const std::shared_ptr<const MaterialMaps>& maps) {
  if (maps) blocks.push_back({maps.get(), maps->bytes()});
}

void note(std::vector<MemoryBlock>& blocks, const std::shared_ptr<const Swatch>& swatch) {
  if (swatch) blocks.push_back({swatch.get(), bytesOf(*swatch)});
}

// Bytes, not values: what a file or an undo brings back must be the same also where it is NaN.
template <class T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

template <class T>
bool sameColumn(const Column<T>& a, const Column<T>& b) {
  if (a == b) return true;
  return a && b && sameBytes(*a, *b);
}

bool sameOptions(const TextureOptions& a, const TextureOptions& b) {
  return std::all_of(optionsTable().begin(), optionsTable().end(), [&](const OptionRow& row) {
    return optionText(a, row) == optionText(b, row);
  });
}

bool sameStrokes(const Column<Stroke>& a, const Column<Stroke>& b) {
  const std::vector<Stroke> none;
  return (a ? *a : none) == (b ? *b : none);
}

bool sameRegion(const Region& a, const Region& b) {
  return a.id == b.id && a.name == b.name && a.colour == b.colour && a.visible == b.visible &&
         a.locked == b.locked && a.reference == b.reference && !a.swatch == !b.swatch &&
         !a.maps == !b.maps && sameOptions(a.options, b.options) && a.rotation == b.rotation &&
         a.borderKind == b.borderKind && a.borderWidth == b.borderWidth &&
         sameStrokes(a.strokes, b.strokes);
}

bool sameTerm(const BlendTerm& a, const BlendTerm& b) {
  return a.texel == b.texel && a.patch == b.patch && a.weight == b.weight;
}

bool sameSource(const ResultSource& a, const ResultSource& b) {
  return a.region == b.region && a.reference == b.reference && a.unit == b.unit &&
         a.partial == b.partial && sameOptions(a.options, b.options) && a.blended == b.blended &&
         a.blendEnd == b.blendEnd &&
         std::equal(a.blend.begin(), a.blend.end(), b.blend.begin(), b.blend.end(), sameTerm);
}

bool sameBorder(const std::shared_ptr<const BorderMix>& a,
                const std::shared_ptr<const BorderMix>& b) {
  if (a == b) return true;
  return a && b && a->points == b->points && sameBytes(a->own, b->own) && a->end == b->end &&
         std::equal(a->terms.begin(), a->terms.end(), b->terms.begin(), b->terms.end());
}

bool sameResults(const Results& a, const Results& b) {
  return sameColumn(a.source, b.source) && sameColumn(a.texel, b.texel) &&
         sameColumn(a.frame, b.frame) && sameColumn(a.scale, b.scale) &&
         sameColumn(a.level, b.level) && sameColumn(a.colour, b.colour) &&
         sameColumn(a.state, b.state) && sameColumn(a.patch, b.patch) &&
         sameColumn(a.error, b.error) && sameColumn(a.order, b.order) &&
         sameBorder(a.border, b.border) &&
         std::equal(a.sources.begin(), a.sources.end(), b.sources.begin(), b.sources.end(),
                    [](const auto& x, const auto& y) { return x == y || sameSource(*x, *y); });
}

bool sameScan(const Document& a, const Document& b) {
  if (a.scan == b.scan) return true;
  return a.scan && b.scan && a.scan->path == b.scan->path && a.scan->hash == b.scan->hash &&
         a.scan->neighbours == b.scan->neighbours &&
         sameBytes(a.points().positions, b.points().positions) &&
         sameBytes(a.points().normals, b.points().normals);
}

// Terms of blended points, laid out for all n as a SourceMap has them.
void addBlends(const Results& results, SourceMap& map) {
  const std::size_t n = map.texel.size();
  std::vector<std::pair<const ResultSource*, std::size_t>> of(n, {nullptr, 0});
  bool any = false;
  for (std::size_t s = 0; s < results.sources.size(); ++s) {
    const ResultSource& source = *results.sources[s];
    for (std::size_t b = 0; b < source.blended.size(); ++b)
      if ((*results.source)[source.blended[b]] == s)
        of[source.blended[b]] = {&source, b}, any = true;
  }
  if (!any) return;
  map.blendOffset.assign(1, 0);
  for (const auto& [source, b] : of) {
    if (source) {
      const auto begin =
          source->blend.begin() + static_cast<std::ptrdiff_t>(b == 0 ? 0 : source->blendEnd[b - 1]);
      const auto end = source->blend.begin() + static_cast<std::ptrdiff_t>(source->blendEnd[b]);
      map.blend.insert(map.blend.end(), begin, end);
    }
    map.blendOffset.push_back(static_cast<Index>(map.blend.size()));
  }
}

}  // namespace

std::optional<BorderKind> borderKindNamed(std::string_view name) {
  const auto found = std::find(kBorderKinds.begin(), kBorderKinds.end(), name);
  if (found == kBorderKinds.end()) return std::nullopt;
  return static_cast<BorderKind>(found - kBorderKinds.begin());
}

Document emptyDocument() {
  Document document;
  Region rest;
  rest.name = "Whole scan";
  document.regions = std::make_shared<const std::vector<Region>>(1, std::move(rest));
  return document;
}

const Region* findRegion(const Document& document, RegionId id) {
  for (const Region& region : *document.regions)
    if (region.id == id) return &region;
  return nullptr;
}

std::vector<Index> pointsOf(const Document& document, RegionId id) {
  if (!document.labels) return {};
  const std::vector<RegionId>& labels = *document.labels;
  std::vector<Index> out;
  out.reserve(static_cast<std::size_t>(std::count(labels.begin(), labels.end(), id)));
  for (std::size_t i = 0; i < document.size(); ++i)
    if (labels[i] == id) out.push_back(static_cast<Index>(i));
  return out;
}

std::vector<vec3> shownColours(const Document& document) {
  if (document.results.colour) return *document.results.colour;
  if (!document.scan) return {};
  if (!document.points().colours.empty()) return document.points().colours;
  return std::vector<vec3>(document.size(), kBare);
}

// The size of swatch pixels, times `unit`: all regions have one of their own. Empty: 1 everywhere.
std::vector<float> scaleBeside(const Results& results, float unit) {
  const std::vector<std::uint16_t>& source = *results.source;
  const auto differs = [&](const auto& s) { return s->unit != unit; };
  if (!results.scale && std::none_of(results.sources.begin(), results.sources.end(), differs))
    return {};
  std::vector<float> scale(source.size(), 1);
  for (std::size_t i = 0; i < scale.size(); ++i) {
    if (source[i] == kNoSource) continue;
    scale[i] = results.sources[source[i]]->unit / unit;
    if (results.scale) scale[i] *= (*results.scale)[i];
  }
  if (std::all_of(scale.begin(), scale.end(), [](float s) { return s == 1; })) return {};
  return scale;
}

SourceMap wholeMap(const Document& document) {
  const Results& results = document.results;
  if (!results.source) throw InvalidInput("nothing is synthesized yet; synthesize a region first");
  std::vector<std::size_t> size(results.sources.size(), 0);
  for (const std::uint16_t s : *results.source)
    if (s != kNoSource) ++size[s];
  SourceMap map;
  const auto largest = std::max_element(size.begin(), size.end());
  if (largest != size.end())
    map.unit = results.sources[static_cast<std::size_t>(largest - size.begin())]->unit;
  map.texel = *results.texel;
  map.frame = *results.frame;
  map.scale = scaleBeside(results, map.unit);
  if (results.level) map.level = *results.level;
  map.colour = *results.colour;
  map.state = *results.state;
  map.patch = *results.patch;
  map.error = *results.error;
  map.order = *results.order;
  addBlends(results, map);
  return map;
}

std::vector<MemoryBlock> memoryBlocks(const Document& document) {
  std::vector<MemoryBlock> blocks;
  if (document.scan) blocks.push_back({document.scan.get(), bytesOf(document.scan->prepared)});
  note(blocks, document.labels);
  note(blocks, document.regions);
  for (const Region& region : *document.regions) {
    if (region.image) blocks.push_back({region.image.get(), bytesOf(region.image->pixels)});
    note(blocks, region.swatch);
    note(blocks, region.maps);
    note(blocks, region.strokes);
    if (!region.strokes) continue;
    for (const Stroke& stroke : *region.strokes)
      blocks.back().bytes += bytesOf(stroke.positions) + bytesOf(stroke.points);
  }
  if (document.selection)
    blocks.push_back({document.selection.get(), document.selection->words().size_bytes()});
  const Results& results = document.results;
  note(blocks, results.source);
  note(blocks, results.texel);
  note(blocks, results.frame);
  note(blocks, results.scale);
  note(blocks, results.level);
  note(blocks, results.colour);
  note(blocks, results.state);
  note(blocks, results.patch);
  note(blocks, results.error);
  note(blocks, results.order);
  if (const BorderMix* border = results.border.get())
    blocks.push_back({border, bytesOf(border->points) + bytesOf(border->own) +
                                  bytesOf(border->end) + bytesOf(border->terms)});
  for (const auto& source : results.sources) {
    blocks.push_back({source.get(), bytesOf(source->blended) + bytesOf(source->blendEnd) +
                                        bytesOf(source->blend)});
    note(blocks, source->swatch);
    note(blocks, source->maps);
  }
  return blocks;
}

std::size_t ownBytes(const Document& document, const Document& other) {
  std::set<const void*> seen;
  for (const MemoryBlock& block : memoryBlocks(other)) seen.insert(block.address);
  std::size_t sum = 0;
  for (const MemoryBlock& block : memoryBlocks(document))
    if (seen.insert(block.address).second) sum += block.bytes;
  return sum;
}

bool sameContent(const Document& a, const Document& b) {
  const PointMask none;
  return sameScan(a, b) && sameColumn(a.labels, b.labels) &&
         std::equal(a.regions->begin(), a.regions->end(), b.regions->begin(), b.regions->end(),
                    sameRegion) &&
         (a.selection ? *a.selection : none) == (b.selection ? *b.selection : none) &&
         sameResults(a.results, b.results);
}

}  // namespace dapple
