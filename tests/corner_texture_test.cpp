#include "document/corner_texture.h"

#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "document_fixtures.h"
#include "fixtures.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

constexpr int kSide = 40;                // vertices along a side of the sheet
constexpr float kFarApart = 1.f / 100;   // of two colours that are one
constexpr float kSamePlace = 1.f / 500;  // of a swatch

// A wavy sheet of triangles, with one square among them.
std::string writeSheet(const TestFolder& folder) {
  std::ofstream file(folder / "sheet.ply");
  const int faces = 2 * (kSide - 1) * (kSide - 1) - 1;
  file << "ply\nformat ascii 1.0\nelement vertex " << kSide * kSide
       << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << faces
       << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      file << x << ' ' << y << ' ' << 2 * std::sin(0.3 * x) * std::cos(0.25 * y) << '\n';
  for (int y = 0; y + 1 < kSide; ++y)
    for (int x = 0; x + 1 < kSide; ++x) {
      const int a = y * kSide + x, b = a + 1, c = b + kSide, d = a + kSide;
      if (a == 0)
        file << "4 " << a << ' ' << b << ' ' << c << ' ' << d << '\n';
      else
        file << "3 " << a << ' ' << b << ' ' << c << "\n3 " << a << ' ' << c << ' ' << d << '\n';
    }
  return folder / "sheet.ply";
}

Document texturedSheet(const TestFolder& folder, const SwatchReference& swatch, Method method,
                       Tileable tileable) {
  Document d = applied(emptyDocument(), OpenScan{.path = writeSheet(folder), .neighbours = 16});
  TextureOptions options;
  options.method = method;
  options.tileable = tileable;
  d = applied(d, SetRegion{.region = 0, .options = options});
  d = applied(d, SetSwatch{.region = 0, .reference = swatch});
  return applied(d, Synthesize{});
}

CornerTexture corners(const Document& d) {
  Workers workers;
  Monitor monitor(workers);
  return cornersOf(d.results, d.scan->prepared.scan, monitor);
}

Scan readBack(const std::string& path) {
  Workers workers;
  Monitor monitor(workers);
  return loadScan(path, {}, monitor);
}

// The faces of a file, as corners (records) and their coordinates.
struct Faces {
  const Property *corners, *coordinates;

  explicit Faces(const Scan& scan)
      : corners(scan.table.find("face")->find("vertex_indices")),
        coordinates(scan.table.find("face")->find("texcoord")) {}
  std::size_t count() const { return corners->listOffsets.size() - 1; }
  std::size_t begin(std::size_t f) const { return corners->listOffsets[f]; }
  std::size_t end(std::size_t f) const { return corners->listOffsets[f + 1]; }
  std::size_t record(std::size_t k) const { return static_cast<std::size_t>(corners->at(k)); }
  vec2 uv(std::size_t k) const { return {coordinates->at(2 * k), coordinates->at(2 * k + 1)}; }
};

// Of one patch and not blended, all of it.
bool isCoherent(const Document& d, const Faces& faces, std::size_t f) {
  const Scan& scan = d.scan->prepared.scan;
  const Index first = scan.pointOf[faces.record(faces.begin(f))];
  for (std::size_t k = faces.begin(f); k < faces.end(f); ++k) {
    const Index i = scan.pointOf[faces.record(k)];
    if (!d.results.sources[0]->termsAt(i).empty()) return false;
    if ((*d.results.patch)[i] != (*d.results.patch)[first]) return false;
  }
  return true;
}

// Largest distance between two corners.
template <class At>
float extentOf(std::size_t begin, std::size_t end, const At& at) {
  float most = 0;
  for (std::size_t a = begin; a < end; ++a)
    for (std::size_t b = begin; b < a; ++b) most = std::max(most, glm::length(at(a) - at(b)));
  return most;
}

void checkCorners(const TestFolder& folder, Method method, Tileable tileable) {
  const Document d = texturedSheet(folder, {.path = "/s/noise.png"}, method, tileable);
  const std::string path = folder / "out.ply";
  applied(d, ExportScan{.path = path});
  const Scan back = readBack(path);
  const Faces faces(back), given(d.scan->prepared.scan);
  REQUIRE(faces.coordinates);
  REQUIRE(faces.count() == given.count());
  const Swatch& swatch = *d.results.sources[0]->swatch;
  const vec2 size(swatch.width, swatch.height);
  const float unit = d.results.sources[0]->unit;
  const PointSet& points = d.points();
  std::size_t own = 0, coherent = 0;
  for (std::size_t f = 0; f < faces.count(); ++f) {
    const std::size_t begin = faces.begin(f), end = faces.end(f);
    REQUIRE(end == given.end(f));
    const auto pointOf = [&](std::size_t k) {
      return d.scan->prepared.scan.pointOf[faces.record(k)];
    };
    const float wide = extentOf(begin, end, [&](std::size_t k) { return size * faces.uv(k); });
    const float large =
        extentOf(begin, end, [&](std::size_t k) { return points.positions[pointOf(k)]; });
    CHECK(wide <= 2 * large / unit + 1e-3f);
    for (std::size_t k = begin; k < end; ++k) {
      REQUIRE(faces.record(k) == given.record(k));
      const vec2 texel = size * vec2(faces.uv(k).x, 1 - faces.uv(k).y);
      if (!swatch.tileable) CHECK(usableTexel(swatch, glm::round(texel * 100.f) / 100.f));
      if (!isCoherent(d, faces, f)) continue;
      ++coherent;
      const vec3 shown = back.points.colours[back.pointOf[faces.record(k)]];
      own += glm::length(sampleSwatch(swatch, texel) - shown) < kFarApart;
    }
  }
  CHECK(coherent > back.points.size());
  CHECK(static_cast<double>(own) > 0.97 * static_cast<double>(coherent));
}

std::vector<std::string> linesOf(const std::string& path) {
  std::ifstream file(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

std::size_t beginning(const std::vector<std::string>& lines, const std::string& with) {
  return static_cast<std::size_t>(std::count_if(
      lines.begin(), lines.end(), [&](const std::string& line) { return line.starts_with(with); }));
}

}  // namespace

TEST_CASE("a swatch that is read at the corners shows what the vertices do") {
  const TestFolder folder;
  SUBCASE("patches, tiling") {
    checkCorners(folder, Method::Patches, Tileable::Yes);
  }
  SUBCASE("patches, not tiling") {
    checkCorners(folder, Method::Patches, Tileable::No);
  }
  SUBCASE("hybrid") {
    checkCorners(folder, Method::Hybrid, Tileable::Yes);
  }
}

TEST_CASE("coordinates go on across the edges inside of a patch") {
  const TestFolder folder;
  const Document d =
      texturedSheet(folder, {.path = "/s/noise.png"}, Method::Patches, Tileable::Yes);
  const CornerTexture texture = corners(d);
  const Faces faces(d.scan->prepared.scan);
  std::map<std::size_t, std::vector<vec2>> at;
  for (std::size_t f = 0; f < faces.count(); ++f)
    if (isCoherent(d, faces, f))
      for (std::size_t k = faces.begin(f); k < faces.end(f); ++k)
        at[faces.record(k)].push_back(texture.coordinates[k]);
  std::size_t same = 0, all = 0;
  for (const auto& [record, places] : at)
    for (const vec2 place : places) {
      const vec2 apart = place - places.front();
      ++all;
      same += glm::length(apart - glm::round(apart)) < kSamePlace;
    }
  CHECK(all > d.size());
  CHECK(static_cast<double>(same) > 0.97 * static_cast<double>(all));
}

TEST_CASE("an OBJ names its corners' coordinates and, beside it, the swatch of each face") {
  const TestFolder folder;
  Document d = texturedSheet(folder, {.path = folder / "a swatch/noise.png"}, Method::Patches,
                             Tileable::Yes);
  CHECK(corners(d).sources.size() == 1);
  std::vector<Index> lower;
  for (Index i = 0; i < d.size(); ++i)
    if (d.points().positions[i].y < 0) lower.push_back(i);
  d = applied(d, Select{.points = lower});
  d = applied(d, AddRegion{});
  const RegionId added = d.regions->back().id;
  d = applied(d, SetSwatch{.region = added, .reference = {.path = "/s/bricks.png"}});
  d = applied(d, Synthesize{.region = added});
  applied(d, ExportScan{.path = folder / "out.obj"});
  const std::vector<std::string> lines = linesOf(folder / "out.obj"),
                                 materials = linesOf(folder / "out.mtl");
  const std::size_t count = 2 * (kSide - 1) * (kSide - 1) - 1;
  CHECK(beginning(lines, "mtllib out.mtl") == 1);
  CHECK(beginning(lines, "f ") == count);
  CHECK(beginning(lines, "vt ") == 3 * count + 1);
  CHECK(beginning(lines, "usemtl swatch0") > 0);
  CHECK(beginning(lines, "usemtl swatch1") > 0);
  CHECK(beginning(materials, "newmtl ") == 3);
  CHECK(beginning(materials, "map_Kd a swatch/noise.png") == 1);
  CHECK(std::count_if(materials.begin(), materials.end(), [](const std::string& line) {
          return line.starts_with("map_Kd") && line.ends_with("s/bricks.png");
        }) == 1);
  CHECK(lines[static_cast<std::size_t>(
            std::find_if(lines.begin(), lines.end(),
                         [](const std::string& line) { return line.starts_with("f "); }) -
            lines.begin())] == "f 1/1 2/2 42/3 41/4");
  const Scan back = readBack(folder / "out.obj");
  CHECK(back.mesh.triangles.size() == count + 1);
  applied(d, ExportScan{.path = folder / "out.ply", .ascii = true});
  const Scan ply = readBack(folder / "out.ply");
  const Property* number = ply.table.find("face")->find("texnumber");
  REQUIRE(number);
  std::set<int> numbers;
  for (std::size_t f = 0; f < count; ++f) numbers.insert(static_cast<int>(number->at(f)));
  CHECK(numbers == std::set<int>{0, 1});
  CHECK(std::find(ply.table.comments.begin(), ply.table.comments.end(),
                  "TextureFile a swatch/noise.png") != ply.table.comments.end());
  applied(d, ExportScan{.path = folder / "bare.ply", .options = {.corners = false}});
  const Scan bare = readBack(folder / "bare.ply");
  CHECK_FALSE(bare.table.find("face")->find("texcoord"));
  CHECK_FALSE(bare.table.find("face")->find("texnumber"));
  CHECK(bare.mesh.triangles.size() == back.mesh.triangles.size());
}

TEST_CASE("a part of an image is written beside the mesh that shows it") {
  const TestFolder folder;
  const Document d =
      texturedSheet(folder, {.path = "/s/noise.png", .crop = PixelRect{4, 6, 30, 25}},
                    Method::Patches, Tileable::No);
  applied(d, ExportScan{.path = folder / "out.obj"});
  CHECK(beginning(linesOf(folder / "out.mtl"), "map_Kd out_swatch0.bmp") == 1);
  CHECK(std::filesystem::file_size(folder / "out_swatch0.bmp") == 54 + 25 * 92);
  std::ifstream file(folder / "out_swatch0.bmp", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  const vec3 corner = d.results.sources[0]->swatch->colours()[24 * 30];  // of the last row
  for (int c = 0; c < 3; ++c)
    CHECK(static_cast<int>(static_cast<unsigned char>(bytes[54 + 2 - c])) ==
          std::lround(std::clamp(corner[c], 0.f, 1.f) * 255));
}

TEST_CASE("what is no mesh has no texture coordinates") {
  const TestFolder folder;
  Document d = sphereDocument(folder, 1500);
  d = applied(d, SetSwatch{.region = 0, .reference = {.path = "/s/noise.png"}});
  d = applied(d, Synthesize{});
  CHECK(corners(d).empty());
  applied(d, ExportScan{.path = folder / "out.obj"});
  CHECK(!std::filesystem::exists(folder / "out.mtl"));
}
