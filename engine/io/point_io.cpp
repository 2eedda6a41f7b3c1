#include "io/point_io.h"
#include "io/file_names.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numeric>
#include <tuple>

#include "base/errors.h"
#include "io/obj.h"
#include "io/ply.h"
#include "io/point_columns.h"
#include "io/xyz.h"

namespace dapple {
namespace {

constexpr std::size_t kChunk = 1 << 14;
constexpr std::size_t kSniffed = 4096;

bool isAnyOf(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

// By content first: a wrong extension is common, a wrong magic is not.
std::string findFormat(const std::filesystem::path& path, InputFile& file) {
  const std::string extension = lowerExtension(path);
  const std::string_view start = file.peek(kSniffed);
  if (extension == ".ply" || looksLikePly(start)) return "ply";
  if (extension == ".obj") return "obj";
  if (isAnyOf(extension, {".xyz", ".txt", ".pts", ".asc", ".csv", ".xyzn", ".xyzrgb"}))
    return "xyz";
  // These begin with lines of numbers, too, but mean something else by them.
  const bool other = isAnyOf(extension, {".off", ".pcd", ".stl", ".vtk", ".wrl", ".ptx"});
  if (!other && looksLikeXyz(start.substr(0, kSniffed))) return "xyz";
  throw IoError(
      path.string(), "", "this format is not known",
      "Dapple reads PLY, OBJ and XYZ (.xyz, .txt, .asc, .csv, .pts): export one of them.");
}

RecordTable readTable(const std::string& format, InputFile& file, Monitor& monitor) {
  if (format == "ply") return readPly(file, monitor);
  return format == "obj" ? readObj(file, monitor) : readXyz(file, monitor);
}

template <class Body>
void forChunks(std::size_t count, Monitor& monitor, const Body& body) {
  for (std::size_t begin = 0; begin < count; begin += kChunk) {
    monitor.checkpoint();
    for (std::size_t i = begin; i < std::min(count, begin + kChunk); ++i) body(i);
  }
}

bool isFinite(const dvec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

template <class T>
void setTriple(Element& element, const std::array<const char*, 3>& names, std::size_t count,
               const std::function<T(std::size_t, int)>& value) {
  std::vector<T> column(count);
  for (int c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < count; ++i) column[i] = value(i, c);
    setColumn(element, names[static_cast<std::size_t>(c)], std::span<const T>(column));
  }
}

// The scan that samples of the mesh make, in the precision of the file's own coordinates.
RecordTable resample(const RecordTable& table, const std::string& path, const LoadOptions& options,
                     Monitor& monitor) {
  if (options.samples >= kNone)
    throw InvalidInput(
        fmt::format("samples = {} is too many: 1 to {} are possible", options.samples, kNone - 1));
  const std::vector<dvec3> positions = readPositions(table, path, monitor);
  SurfaceMesh mesh = readTriangles(table, path, monitor);
  std::erase_if(mesh.triangles, [&](const std::array<Index, 3>& t) {
    return !isFinite(positions[t[0]]) || !isFinite(positions[t[1]]) || !isFinite(positions[t[2]]);
  });
  if (mesh.triangles.empty())
    throw InvalidInput(
        fmt::format("{}: samples = {} needs a mesh, but this file holds points "
                    "only. Set samples to 0 to work on the points.",
                    path, options.samples));
  const SurfaceSamples samples = sampleMesh(positions, mesh, options.samples, options.seed);
  monitor.checkpoint();
  RecordTable out{.comments = table.comments, .objInfo = table.objInfo};
  Element vertex{.name = "vertex", .count = options.samples};
  const Property* x = table.find("vertex")->find("x");
  if (x && x->type == ScalarType::Float32)
    setTriple<float>(vertex, {"x", "y", "z"}, vertex.count, [&](std::size_t i, int c) {
      return static_cast<float>(samples.positions[i][c]);
    });
  else
    setTriple<double>(vertex, {"x", "y", "z"}, vertex.count,
                      [&](std::size_t i, int c) { return samples.positions[i][c]; });
  setTriple<float>(vertex, {"nx", "ny", "nz"}, vertex.count,
                   [&](std::size_t i, int c) { return samples.normals[i][c]; });
  out.elements.push_back(std::move(vertex));
  return out;
}

// Sets origin and modelUnits; halves keep the extent of the widest doubles finite.
void setLocalFrame(const std::vector<dvec3>& positions, const std::vector<std::size_t>& finite,
                   PointSet& points, Monitor& monitor) {
  dvec3 low = positions[finite[0]] / 2.0, high = low;
  forChunks(finite.size(), monitor, [&](std::size_t i) {
    low = glm::min(low, positions[finite[i]] / 2.0);
    high = glm::max(high, positions[finite[i]] / 2.0);
  });
  points.origin = low + high;
  const dvec3 half = high - low;
  const double extent = std::max({half.x, half.y, half.z});
  if (extent > 0)
    points.modelUnits = std::ldexp(1.0, std::clamp(std::ilogb(extent) + 1, -1000, 1023));
}

// For each of the positions in Morton order the one before it in the list with the same place, or
// itself. Only positions of one cell can be equal; a cell is sorted, for a far outlier can crowd
// the whole scan into a few of them.
std::vector<Index> findTwins(const std::vector<vec3>& positions,
                             const std::vector<std::uint64_t>& codes,
                             const std::vector<Index>& order, Monitor& monitor) {
  std::vector<Index> twin(positions.size());
  std::iota(twin.begin(), twin.end(), Index{0});
  std::vector<Index> cell;
  for (std::size_t begin = 0, end = 0, checked = 0; begin < order.size(); begin = end) {
    if (begin - checked >= kChunk) {
      monitor.checkpoint();
      checked = begin;
    }
    const std::uint64_t code = codes[order[begin]];
    while (end < order.size() && codes[order[end]] == code) ++end;
    if (end - begin == 1) continue;
    monitor.checkpoint();
    cell.assign(order.begin() + static_cast<std::ptrdiff_t>(begin),
                order.begin() + static_cast<std::ptrdiff_t>(end));
    std::sort(cell.begin(), cell.end(), [&](Index a, Index b) {
      const vec3 &p = positions[a], &q = positions[b];
      return std::tie(p.x, p.y, p.z, a) < std::tie(q.x, q.y, q.z, b);
    });
    for (std::size_t k = 1; k < cell.size(); ++k)
      if (positions[cell[k]] == positions[cell[k - 1]]) twin[cell[k]] = twin[cell[k - 1]];
  }
  return twin;
}

// Fills points.positions, record and pointOf from the records' positions.
void placePoints(const std::vector<dvec3>& positions, Scan& scan, Monitor& monitor) {
  std::vector<std::size_t> finite;
  finite.reserve(positions.size());
  forChunks(positions.size(), monitor, [&](std::size_t r) {
    if (isFinite(positions[r])) finite.push_back(r);
  });
  scan.nonFinite = positions.size() - finite.size();
  if (finite.empty())
    throw InvalidInput(fmt::format(
        "{}: none of the {} points has finite coordinates (they are NaN or infinite). Export the "
        "scan again.",
        scan.path, positions.size()));
  monitor.checkpoint();
  PointSet& points = scan.points;
  setLocalFrame(positions, finite, points, monitor);
  std::vector<vec3> local(finite.size());
  parallelFor(monitor, local.size(), kChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      local[i] = vec3((positions[finite[i]] - points.origin) / points.modelUnits);
  });
  const std::vector<std::uint64_t> codes = mortonCodes(local, monitor);
  const std::vector<Index> order = orderByCode(codes, monitor);
  const std::vector<Index> twin = findTwins(local, codes, order, monitor);
  scan.pointOf.assign(positions.size(), kNone);
  points.positions.reserve(order.size());
  scan.record.reserve(order.size());
  forChunks(order.size(), monitor, [&](std::size_t k) {
    const Index i = order[k];
    if (twin[i] != i) return;
    scan.pointOf[finite[i]] = static_cast<Index>(points.positions.size());
    points.positions.push_back(local[i]);
    scan.record.push_back(finite[i]);
  });
  forChunks(twin.size(), monitor, [&](std::size_t i) {
    if (twin[i] != i) scan.pointOf[finite[i]] = scan.pointOf[finite[twin[i]]];
  });
  scan.duplicates = finite.size() - points.size();
}

SurfaceMesh meshOfPoints(const SurfaceMesh& ofRecords, const std::vector<Index>& pointOf,
                         Monitor& monitor) {
  SurfaceMesh mesh;
  mesh.triangles.reserve(ofRecords.triangles.size());
  forChunks(ofRecords.triangles.size(), monitor, [&](std::size_t i) {
    const auto& triangle = ofRecords.triangles[i];
    const std::array<Index, 3> t = {pointOf[triangle[0]], pointOf[triangle[1]],
                                    pointOf[triangle[2]]};
    const bool whole = t[0] != kNone && t[1] != kNone && t[2] != kNone;
    if (whole && t[0] != t[1] && t[1] != t[2] && t[0] != t[2]) mesh.triangles.push_back(t);
  });
  return mesh;
}

std::vector<vec3> gather(const std::vector<vec3>& ofRecords, const std::vector<std::size_t>& record,
                         Monitor& monitor) {
  if (ofRecords.empty()) return {};
  std::vector<vec3> column(record.size());
  forChunks(column.size(), monitor, [&](std::size_t i) { column[i] = ofRecords[record[i]]; });
  return column;
}

// Points without a normal among others that have one take that of the point before them in Morton
// order, which is near; when most have none, all count as missing.
void mendNormals(std::vector<vec3>& normals) {
  const auto missing = [](const vec3& n) { return n == vec3(0); };
  const auto bad = std::count_if(normals.begin(), normals.end(), missing);
  if (2 * static_cast<std::size_t>(bad) >= normals.size()) {
    normals.clear();
    return;
  }
  vec3 last = *std::find_if_not(normals.begin(), normals.end(), missing);
  for (vec3& n : normals) missing(n) ? n = last : last = n;
}

}  // namespace

Scan loadScan(const std::filesystem::path& path, const LoadOptions& options, Monitor& monitor) {
  monitor.begin(Stage::Load, 0);
  Scan scan{.path = path.string()};
  {
    InputFile file(path, monitor);
    scan.format = findFormat(path, file);
    scan.table = readTable(scan.format, file, monitor);
  }
  if (options.samples > 0) scan.table = resample(scan.table, scan.path, options, monitor);
  const std::vector<dvec3> positions = readPositions(scan.table, scan.path, monitor);
  if (positions.empty())
    throw InvalidInput(scan.path + ": there are no points in this file. Export the scan again.");
  placePoints(positions, scan, monitor);
  monitor.checkpoint();
  scan.mesh = meshOfPoints(readTriangles(scan.table, scan.path, monitor), scan.pointOf, monitor);
  scan.points.normals = gather(readNormals(scan.table, monitor), scan.record, monitor);
  mendNormals(scan.points.normals);
  scan.points.colours = gather(readColours(scan.table, monitor), scan.record, monitor);
  monitor.checkpoint();
  return scan;
}

void savePly(const std::filesystem::path& path, const RecordTable& table, bool ascii,
             Monitor& monitor) {
  std::size_t records = 0;
  for (const Element& element : table.elements) records += element.count;
  monitor.begin(Stage::Save, records);
  OutputFile file(path);
  writePly(file, table, ascii, monitor);
  monitor.checkpoint();
  file.commit();
}

}  // namespace dapple
