// From a file to a source map by every method: the same bytes whatever the number of threads. Each
// scan has a seed of its own: scans by seeds would take three times as long. The mesh is large
// enough for loops over chunks of 4096 points to have two.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "base/hash_rng.h"
#include "document/texture_job.h"
#include "fixtures.h"
#include "same_maps.h"
#include "scan_files.h"

using namespace dapple;
using dapple::testing::sameBytes;
using dapple::testing::sameMaps;

namespace {

constexpr unsigned kMostThreads = 3;
constexpr int kSwatchSize = 28;

struct Row {
  const char* name;
  TextureOptions options;
};

const Row kRows[] = {
    {"random", {.method = Method::Random}},
    {"triplanar", {.method = Method::Triplanar}},
    {"coordinates", {.method = Method::Coordinates}},
    {"coordinates, a tile, 2 passes",
     {.method = Method::Coordinates, .passes = 2, .tileable = Tileable::Yes}},
    {"tiling", {.method = Method::Tiling, .repair = 0, .tileable = Tileable::Yes}},
    {"tiling, extended, repair", {.method = Method::Tiling}},
    {"patches", {.method = Method::Patches, .repair = 0, .tileable = Tileable::Yes}},
    {"patches, repair", {.method = Method::Patches}},
    {"match", {.method = Method::Match, .repair = 0}},
    {"match, exhaustive, 2 levels, repair",
     {.method = Method::Match, .levels = 2, .coherent = false}},
    {"grid, without seams", {.method = Method::Grid, .grid = 11, .gridSeams = false, .repair = 0}},
    {"grid, repair", {.method = Method::Grid, .grid = 11}},
    {"mapping", {.method = Method::Mapping, .repair = 0}},
    {"mapping, 19 angles, repair", {.method = Method::Mapping, .follow = false}},
    {"hybrid", {.method = Method::Hybrid, .repair = 0}},
    {"hybrid, repair", {.method = Method::Hybrid}},
    {"hybrid, matched gaps, spread quarter turns, repair",
     {.method = Method::Hybrid,
      .gaps = GapFill::Match,
      .expand = true,
      .field = FieldMethod::Spread,
      .symmetry = FieldSymmetry::Quarter}},
};

std::string xyzText(const std::vector<vec3>& positions) {
  std::string text;
  for (const vec3& p : positions) text += fmt::format("{:.7g} {:.7g} {:.7g}\n", p.x, p.y, p.z);
  return text;
}

// A torus of quads, each two triangles; normals are to be made of them.
std::string torusMesh(int around, int across) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
      around * across, 2 * around * across);
  for (int a = 0; a < around; ++a)
    for (int b = 0; b < across; ++b) {
      const double u = 2 * std::numbers::pi * a / around, v = 2 * std::numbers::pi * b / across;
      const double r = 1 + 0.45 * std::cos(v);
      text += fmt::format("{:.7g} {:.7g} {:.7g}\n", r * std::cos(u), r * std::sin(u),
                          0.45 * std::sin(v));
    }
  const auto vertex = [&](int a, int b) { return a % around * across + b % across; };
  for (int a = 0; a < around; ++a)
    for (int b = 0; b < across; ++b) {
      const int corner = vertex(a + 1, b + 1);
      text += fmt::format("3 {} {} {}\n", vertex(a, b), vertex(a + 1, b), corner);
      text += fmt::format("3 {} {} {}\n", vertex(a, b), corner, vertex(a, b + 1));
    }
  return text;
}

// The project's own scan, ten times sparser at one end than at the other.
std::string unevenCloud() {
  const Scan scan = testing::load(DAPPLE_OWN_SCAN);
  const std::vector<vec3>& positions = scan.points.positions;
  float low = positions[0].y, high = low;
  for (const vec3& p : positions) low = std::min(low, p.y), high = std::max(high, p.y);
  std::vector<vec3> kept;
  for (Index i = 0; i < positions.size(); ++i)
    if (hashUniform(1, i) < std::lerp(0.012f, 0.12f, (positions[i].y - low) / (high - low)))
      kept.push_back(positions[i]);
  return xyzText(kept);
}

std::string threeBalls() {
  std::vector<vec3> all;
  for (const auto& [count, radius, x] :
       {std::tuple(1200, 1.0f, 0.0f), std::tuple(400, 0.5f, 2.0f), std::tuple(60, 0.2f, 4.0f)})
    for (const vec3& p : fixtures::makeSphere(static_cast<std::size_t>(count), radius).positions)
      all.push_back(p + vec3(x, 0, 0));
  return xyzText(all);
}

// Loaded and prepared with 1, 2 and 3 threads, so that nothing before the synthesis is shared.
struct Subject {
  std::array<PreparedScan, kMostThreads> prepared;

  explicit Subject(const std::filesystem::path& path) {
    for (unsigned t = 0; t < kMostThreads; ++t) {
      Workers workers(t + 1);
      Monitor monitor(workers);
      prepared[t] = prepareScan(path, {}, 20, {}, monitor);
    }
    for (const PreparedScan& p : prepared) {
      REQUIRE(p.normalsMade);
      REQUIRE(sameBytes(p.scan.points.positions, prepared[0].scan.points.positions));
      REQUIRE(sameBytes(p.scan.points.normals, prepared[0].scan.points.normals));
      REQUIRE(sameBytes(p.neighborhoods.ids, prepared[0].neighborhoods.ids));
      REQUIRE(p.spacing == prepared[0].spacing);
    }
    CHECK(prepared[0].scan.points.size() > 1500);
  }
};

struct Swatches {
  Swatch tile = fixtures::swatchOf(fixtures::noise(kSwatchSize));
  Swatch photograph = fixtures::swatchOf(fixtures::blobs(kSwatchSize), Tileable::No);
};

void checkRow(const Subject& subject, const Row& row, std::uint64_t seed,
              const Swatches& swatches) {
  TextureOptions options = row.options;
  options.seed = seed;
  const bool tiles = options.tileable == Tileable::Yes;
  TexturedPoints one;
  for (unsigned threads = 1; threads <= kMostThreads; ++threads) {
    CAPTURE(threads);
    Workers workers(threads);
    Monitor monitor(workers);
    TexturedPoints some =
        texturePoints(subject.prepared[threads - 1], tiles ? swatches.tile : swatches.photograph,
                      {}, options, monitor);
    if (threads == 1) {
      one = std::move(some);
      continue;
    }
    CHECK(sameBytes(some.frames, one.frames));
    CHECK(sameMaps(some.map, one.map));
  }
}

}  // namespace

TEST_CASE("every method makes the same bytes on 1, 2 and 3 threads, with and without repair") {
  const testing::Folder folder;
  const Swatches swatches;
  const std::pair<const char*, std::function<std::filesystem::path()>> scans[] = {
      {"a mesh", [&] { return folder.write("mesh.ply", torusMesh(90, 46)); }},
      {"a cloud of uneven density", [&] { return folder.write("uneven.xyz", unevenCloud()); }},
      {"separate parts", [&] { return folder.write("parts.xyz", threeBalls()); }}};
  std::uint64_t seed = 0;
  for (const auto& [scan, written] : scans) {
    CAPTURE(scan);
    const Subject subject(written());
    ++seed;
    for (const Row& row : kRows) {
      CAPTURE(row.name);
      checkRow(subject, row, seed, swatches);
    }
  }
}
