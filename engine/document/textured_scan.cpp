// The columns: swatch (int, a number each; -1: none), texel_x texel_y (float, swatch pixels, y
// down), frame_sx ... frame_tz (float: the swatch's axes to the right and up, model directions),
// scale (float, of the swatch; where it is not 1 everywhere), level (float: the colour is the
// texel's at this level of the swatch's stack, unless it is blended; where it is not 0 everywhere),
// patch (int, -1: none), state (uchar: 0 free, 1 patch, 2 gap, 3 matched), error (float), order
// (int, -1: never decided); read only: region (any integer, -1: none). The comment: "dapple unit
// U", U model units per swatch pixel.
#include "document/textured_scan.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr std::string_view kUnitComment = "dapple unit ";
constexpr std::array<const char*, 3> kColourNames{"red", "green", "blue"};
constexpr std::array<const char*, 6> kFrameNames{"frame_sx", "frame_sy", "frame_sz",
                                                 "frame_tx", "frame_ty", "frame_tz"};

// One number a point, laid out by record.
template <class T, class Value>
void addColumn(Element& vertices, const Scan& scan, const char* name, T missing, Value value) {
  std::vector<T> column(scan.pointOf.size(), missing);
  for (std::size_t r = 0; r < column.size(); ++r)
    if (scan.pointOf[r] != kNone) column[r] = value(scan.pointOf[r]);
  setColumn(vertices, name, column);
}

std::int32_t signedId(Index id) {
  return id == kNone ? -1 : static_cast<std::int32_t>(id);
}

void renameColours(Element& vertices) {
  for (Property& property : vertices.properties)
    for (const char* name : kColourNames)
      if (property.name == name) property.name = std::string("original_") + name;
}

void addFrames(Element& vertices, const Scan& scan, const std::vector<TangentFrame>& frames) {
  for (int c = 0; c < 6; ++c)
    addColumn<float>(vertices, scan, kFrameNames[static_cast<std::size_t>(c)], 0,
                     [&](Index i) { return c < 3 ? frames[i].s[c] : frames[i].t[c - 3]; });
}

void addScale(Element& vertices, const Scan& scan, const std::vector<float>& scale) {
  addColumn<float>(vertices, scan, "scale", 1, [&](Index i) { return scale[i]; });
}

void addSourceMap(Element& vertices, const Scan& scan, const SourceMap& map,
                  std::span<const std::uint16_t> source) {
  addColumn<std::int32_t>(vertices, scan, "swatch", -1, [&](Index i) {
    if (source.empty()) return 0;
    return source[i] == 0xffff ? -1 : static_cast<int>(source[i]);
  });
  addColumn<float>(vertices, scan, "texel_x", 0, [&](Index i) { return map.texel[i].x; });
  addColumn<float>(vertices, scan, "texel_y", 0, [&](Index i) { return map.texel[i].y; });
  addFrames(vertices, scan, map.frame);
  if (!map.scale.empty()) addScale(vertices, scan, map.scale);
  if (!map.level.empty())
    addColumn<float>(vertices, scan, "level", 0, [&](Index i) { return map.level[i]; });
  addColumn<std::int32_t>(vertices, scan, "patch", -1,
                          [&](Index i) { return signedId(map.patch[i]); });
  addColumn<std::uint8_t>(vertices, scan, "state", 0,
                          [&](Index i) { return static_cast<std::uint8_t>(map.state[i]); });
  addColumn<float>(vertices, scan, "error", 0, [&](Index i) { return map.error[i]; });
  addColumn<std::int32_t>(vertices, scan, "order", -1,
                          [&](Index i) { return signedId(map.order[i]); });
}

// Numbers of a column by point; nothing when the file has no such column.
std::optional<std::vector<double>> pointColumn(const Scan& scan, const char* name) {
  const Element* vertices = scan.table.find("vertex");
  const Property* property = vertices ? vertices->find(name) : nullptr;
  if (!property || property->isList) return std::nullopt;
  std::vector<double> column(scan.record.size());
  for (std::size_t i = 0; i < column.size(); ++i) column[i] = property->at(scan.record[i]);
  return column;
}

Index idOf(double value) {
  return value >= 0 && value < static_cast<double>(kNone) ? static_cast<Index>(value) : kNone;
}

}  // namespace

RecordTable texturedTable(const Scan& scan, const SourceMap& map, const ExportOptions& options,
                          std::span<const std::uint16_t> source) {
  RecordTable table = scan.table;
  Element* vertices = table.find("vertex");
  DAPPLE_CHECK(vertices != nullptr, ==, true);
  // Of an earlier texture.
  std::erase_if(table.elements,
                [](const Element& element) { return element.name == kBorderElement; });
  vertices = table.find("vertex");
  if (options.keepColours) renameColours(*vertices);
  for (int c = 0; c < 3; ++c)
    addColumn<std::uint8_t>(*vertices, scan, kColourNames[static_cast<std::size_t>(c)], 0,
                            [&](Index i) {
                              const float level = std::clamp(map.colour[i][c], 0.f, 1.f);
                              return static_cast<std::uint8_t>(std::lround(level * 255));
                            });
  if (options.sourceMap) addSourceMap(*vertices, scan, map, source);
  std::erase_if(table.comments,
                [](const std::string& line) { return line.starts_with(kUnitComment); });
  table.comments.push_back(
      fmt::format("{}{}", kUnitComment, static_cast<double>(map.unit) * scan.points.modelUnits));
  return table;
}

RecordTable orientedTable(const Scan& scan, const OrientationField& field) {
  RecordTable table = scan.table;
  Element* vertices = table.find("vertex");
  DAPPLE_CHECK(vertices != nullptr, ==, true);
  addFrames(*vertices, scan, field.frames);
  if (!field.scale.empty()) addScale(*vertices, scan, field.scale);
  return table;
}

std::optional<float> readUnit(const Scan& scan) {
  for (const std::string& line : scan.table.comments) {
    if (!line.starts_with(kUnitComment)) continue;
    double value = 0;
    const char* begin = line.data() + kUnitComment.size();
    const auto [end, error] = std::from_chars(begin, line.data() + line.size(), value);
    if (error == std::errc() && value > 0 && std::isfinite(value))
      return static_cast<float>(value / scan.points.modelUnits);
  }
  return std::nullopt;
}

std::optional<SourceMap> readSourceMap(const Scan& scan) {
  const auto x = pointColumn(scan, "texel_x"), y = pointColumn(scan, "texel_y"),
             patch = pointColumn(scan, "patch"), state = pointColumn(scan, "state"),
             error = pointColumn(scan, "error"), order = pointColumn(scan, "order");
  std::array<std::optional<std::vector<double>>, 6> frame;
  for (std::size_t c = 0; c < frame.size(); ++c) frame[c] = pointColumn(scan, kFrameNames[c]);
  bool complete = x && y && patch && state && error && order;
  for (const auto& column : frame) complete = complete && column.has_value();
  if (!complete) return std::nullopt;
  SourceMap map = emptySourceMap(scan.points.size(), readUnit(scan).value_or(0));
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    map.texel[i] = {(*x)[i], (*y)[i]};
    TangentFrame& axes = map.frame[i];
    for (int c = 0; c < 3; ++c) {
      axes.s[c] = static_cast<float>((*frame[static_cast<std::size_t>(c)])[i]);
      axes.t[c] = static_cast<float>((*frame[static_cast<std::size_t>(c) + 3])[i]);
    }
    axes.n = glm::cross(axes.s, axes.t);
    map.patch[i] = idOf((*patch)[i]);
    map.state[i] = static_cast<PointState>(std::clamp((*state)[i], 0.0, 3.0));
    map.error[i] = static_cast<float>((*error)[i]);
    map.order[i] = idOf((*order)[i]);
  }
  if (const auto scale = pointColumn(scan, "scale")) {
    const auto usable = [](double s) { return s > 0 && std::isfinite(s); };
    if (std::all_of(scale->begin(), scale->end(), usable))
      map.scale.assign(scale->begin(), scale->end());
  }
  if (const auto level = pointColumn(scan, "level")) {
    const auto usable = [](double l) { return l >= 0 && std::isfinite(l); };
    if (std::all_of(level->begin(), level->end(), usable))
      map.level.assign(level->begin(), level->end());
  }
  map.colour = scan.points.colours;
  return map;
}

std::optional<std::vector<Index>> readRegions(const Scan& scan) {
  const auto column = pointColumn(scan, "region");
  if (!column) return std::nullopt;
  std::vector<Index> regions;
  for (const double value : *column) regions.push_back(idOf(value));
  return regions;
}

}  // namespace dapple
