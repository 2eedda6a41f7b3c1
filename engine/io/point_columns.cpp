#include "io/point_columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr std::size_t kChunk = 1 << 14;
constexpr double kHarmonic = 0.28209479177387814;  // 1 / (2 sqrt(pi)): the constant harmonic
constexpr const char* kExportAgain = "Export the scan again.";

using Names = std::array<const char*, 3>;
using Columns = std::array<const Property*, 3>;

constexpr std::array kPositionNames = {
    Names{"x", "y", "z"}, Names{"X", "Y", "Z"}, Names{"px", "py", "pz"},
    Names{"position_x", "position_y", "position_z"}, Names{"pos_x", "pos_y", "pos_z"}};
constexpr std::array kNormalNames = {Names{"nx", "ny", "nz"}, Names{"NX", "NY", "NZ"},
                                     Names{"normal_x", "normal_y", "normal_z"},
                                     Names{"scalar_Nx", "scalar_Ny", "scalar_Nz"}};
constexpr std::array kColourNames = {Names{"red", "green", "blue"},
                                     Names{"diffuse_red", "diffuse_green", "diffuse_blue"},
                                     Names{"r", "g", "b"}, Names{"R", "G", "B"}};
constexpr std::array<Names, 1> kSplatNames = {Names{"f_dc_0", "f_dc_1", "f_dc_2"}};

template <std::size_t Count>
std::optional<Columns> findColumns(const RecordTable& table,
                                   const std::array<Names, Count>& aliases) {
  const Element* vertex = table.find("vertex");
  if (!vertex) return {};
  for (const Names& names : aliases) {
    Columns columns;
    for (std::size_t c = 0; c < 3; ++c) columns[c] = vertex->find(names[c]);
    if (std::all_of(columns.begin(), columns.end(), [](auto* p) { return p && !p->isList; }))
      return columns;
  }
  return {};
}

std::vector<dvec3> readVectors(const Columns& columns, std::size_t count, Monitor& monitor) {
  std::vector<dvec3> out(count);
  parallelFor(monitor, count, kChunk, [&](std::size_t begin, std::size_t end) {
    std::vector<double> values(end - begin);
    for (int c = 0; c < 3; ++c) {
      readValues(*columns[static_cast<std::size_t>(c)], begin, values);
      for (std::size_t i = begin; i < end; ++i) out[i][c] = values[i - begin];
    }
  });
  return out;
}

std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text.empty() ? "none" : text;
}

// What a full channel is in the file's numbers.
double fullScale(const Columns& columns, const std::vector<dvec3>& values) {
  double largest = 0;
  for (const dvec3& v : values)
    for (int c = 0; c < 3; ++c) largest = v[c] > largest ? v[c] : largest;  // a NaN is no larger
  switch (columns[0]->type) {
    case ScalarType::Int8:
    case ScalarType::UInt8:
      return 255;
    case ScalarType::Float32:
    case ScalarType::Float64:
      // 0..1 by convention; some writers leave bytes as they were.
      return largest <= 2 ? 1 : largest <= 255 ? 255 : 65535;
    default:
      // A wider integer often carries bytes all the same; a scan whose brightest 16-bit channel is
      // 255 of 65535 would be black.
      return largest <= 255 ? 255 : 65535;
  }
}

double clampUnit(double x) {
  return x > 0 ? (x < 1 ? x : 1.0) : 0.0;  // NaN is 0
}

// The corners of a polygon or a strip as they come, checked.
class CornerReader {
 public:
  CornerReader(const Element& element, const Property& list, const std::string& path,
               std::size_t vertices)
      : element_(element), list_(list), path_(path), vertices_(vertices) {}

  // The ids of record `face`; kNone for a negative one if `restarts`.
  const std::vector<Index>& read(std::size_t face, bool restarts) {
    const std::size_t begin = list_.listOffsets[face];
    values_.resize(list_.listOffsets[face + 1] - begin);
    ids_.resize(values_.size());
    readValues(list_, begin, values_);
    for (std::size_t k = 0; k < ids_.size(); ++k) {
      const double value = values_[k];
      const bool inside = value >= 0 && value < static_cast<double>(vertices_);
      if (!inside && !(restarts && value < 0))
        throw IoError(
            path_, fmt::format("{} {}", element_.name, face + 1),
            fmt::format("names vertex {}, but there are {} (counted from 0)", value, vertices_),
            kExportAgain);
      ids_[k] = inside ? static_cast<Index>(value) : kNone;
    }
    return ids_;
  }

 private:
  const Element& element_;
  const Property& list_;
  const std::string& path_;
  std::size_t vertices_;
  std::vector<double> values_;
  std::vector<Index> ids_;
};

const Property* findCornerList(const Element& element) {
  for (const char* name : {"vertex_indices", "vertex_index"})
    if (const Property* list = element.find(name); list && list->isList) return list;
  return nullptr;
}

void addFan(const std::vector<Index>& ids, SurfaceMesh& mesh) {
  for (std::size_t k = 2; k < ids.size(); ++k)
    mesh.triangles.push_back({ids[0], ids[k - 1], ids[k]});
}

// Every vertex after the second makes a triangle with the two before it; every other triangle
// runs the other way round. kNone begins a new strip.
void addStrip(const std::vector<Index>& ids, SurfaceMesh& mesh) {
  std::size_t length = 0;
  for (std::size_t k = 0; k < ids.size(); ++k) {
    length = ids[k] == kNone ? 0 : length + 1;
    if (length < 3) continue;
    const bool even = length % 2 == 1;
    const std::array<Index, 3> t = {ids[k - (even ? 2 : 1)], ids[k - (even ? 1 : 2)], ids[k]};
    if (t[0] != t[1] && t[1] != t[2] && t[0] != t[2]) mesh.triangles.push_back(t);
  }
}

}  // namespace

std::vector<dvec3> readPositions(const RecordTable& table, const std::string& path,
                                 Monitor& monitor) {
  const Element* vertex = table.find("vertex");
  std::vector<std::string> names;
  if (!vertex) {
    for (const Element& e : table.elements) names.push_back(e.name);
    throw IoError(path, "",
                  fmt::format("there is no element \"vertex\" (elements: {})", join(names)),
                  "Export the points as element vertex with x, y and z.");
  }
  const auto columns = findColumns(table, kPositionNames);
  if (!columns) {
    for (const Property& p : vertex->properties) names.push_back(p.name);
    throw IoError(path, "",
                  fmt::format("the points have no x, y and z (properties: {})", join(names)),
                  kExportAgain);
  }
  return readVectors(*columns, vertex->count, monitor);
}

std::vector<vec3> readNormals(const RecordTable& table, Monitor& monitor) {
  const auto columns = findColumns(table, kNormalNames);
  if (!columns) return {};
  const std::vector<dvec3> values = readVectors(*columns, table.find("vertex")->count, monitor);
  std::vector<vec3> normals(values.size(), vec3(0));
  parallelFor(monitor, values.size(), kChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const double length = glm::length(values[i]);
      if (length > 0 && std::isfinite(length)) normals[i] = vec3(values[i] / length);
    }
  });
  return normals;
}

std::vector<vec3> readColours(const RecordTable& table, Monitor& monitor) {
  auto columns = findColumns(table, kColourNames);
  const bool splats = !columns;
  if (splats) columns = findColumns(table, kSplatNames);
  if (!columns) return {};
  const std::vector<dvec3> values = readVectors(*columns, table.find("vertex")->count, monitor);
  const bool isSigned = (*columns)[0]->type == ScalarType::Int8;
  const double full = splats ? 1 : fullScale(*columns, values);
  std::vector<vec3> colours(values.size());
  parallelFor(monitor, values.size(), kChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (int c = 0; c < 3; ++c) {
        double v = values[i][c];
        if (splats) v = 0.5 + kHarmonic * v;
        if (isSigned && v < 0) v += 256;  // "char" where "uchar" was meant
        colours[i][c] = static_cast<float>(clampUnit(v / full));
      }
  });
  return colours;
}

SurfaceMesh readTriangles(const RecordTable& table, const std::string& path, Monitor& monitor) {
  SurfaceMesh mesh;
  const Element* vertex = table.find("vertex");
  const std::size_t vertices = vertex ? vertex->count : 0;
  for (const Element& element : table.elements) {
    const bool strips = element.name == "tristrips";
    const Property* list = findCornerList(element);
    if (!list || !(strips || element.name == "face")) continue;
    CornerReader reader(element, *list, path, vertices);
    for (std::size_t f = 0; f < element.count; ++f) {
      if (f % kChunk == 0) monitor.checkpoint();
      const std::vector<Index>& ids = reader.read(f, strips);
      strips ? addStrip(ids, mesh) : addFan(ids, mesh);
    }
  }
  return mesh;
}

}  // namespace dapple
