#include "document/export_format.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "base/errors.h"
#include "scan_files.h"

using namespace dapple;
using namespace dapple::testing;

namespace {

void exported(const std::filesystem::path& path, const RecordTable& table) {
  Workers workers(1);
  Monitor monitor(workers);
  exportTable(path, table, false, monitor);
}

constexpr const char* kMesh =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float quality\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 0 0 1 255 0 0 1\n0.1 0 0 0 0 1 0 255 0 2\n0 1 0 0 0 1 0 0 255 3\n"
    "0 0 1.5 0 1 0 10 20 30 4\n3 0 1 2\n3 0 1 3\n";

}  // namespace

TEST_CASE("the format of an export is in its name, and a name for none is refused") {
  CHECK(exportFormat("a.ply") == ScanFormat::Ply);
  CHECK(exportFormat("a.PLY") == ScanFormat::Ply);
  CHECK(exportFormat("a") == ScanFormat::Ply);
  CHECK(exportFormat("a.obj") == ScanFormat::Obj);
  CHECK(exportFormat("dir.ply/a.Xyz") == ScanFormat::Xyz);
  CHECK_THROWS_AS(exportFormat("a.stl"), IoError);
}

TEST_CASE("OBJ and XYZ give back the points, normals, colours and faces that they hold") {
  const Folder folder;
  const Scan scan = load(folder.write("in.ply", kMesh));
  for (const char* name : {"out.obj", "out.xyz"}) {
    CAPTURE(name);
    const std::filesystem::path path = folder / name;
    exported(path, scan.table);
    const Scan back = load(path);
    REQUIRE(back.points.size() == scan.points.size());
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      CHECK(back.points.positions[i] == scan.points.positions[i]);
      CHECK(back.points.normals[i] == scan.points.normals[i]);
      for (int c = 0; c < 3; ++c)
        CHECK(back.points.colours[i][c] ==
              doctest::Approx(scan.points.colours[i][c]).epsilon(1e-4));
    }
    const bool mesh = exportFormat(path) == ScanFormat::Obj;
    CHECK(back.mesh.triangles == (mesh ? scan.mesh.triangles : decltype(scan.mesh.triangles){}));
  }
}

TEST_CASE("what an export loses is told, line by line") {
  const Folder folder;
  const Scan scan = load(folder.write("in.ply", kMesh));
  const auto tells = [&](ScanFormat format, const ExportOptions& options, std::string_view what,
                         bool maps = false) {
    const auto lines = exportLosses(format, scan, options, maps);
    return std::any_of(lines.begin(), lines.end(), [&](const std::string& line) {
      return line.find(what) != std::string::npos;
    });
  };
  CHECK(
      exportLosses(ScanFormat::Ply, scan, {.sourceMap = true, .keepColours = true}, true).empty());
  CHECK(tells(ScanFormat::Ply, {.sourceMap = true}, "own colours"));
  CHECK(tells(ScanFormat::Ply, {}, "swatch"));
  CHECK(tells(ScanFormat::Obj, {.sourceMap = true, .keepColours = true}, "quality"));
  CHECK(tells(ScanFormat::Obj, {.keepColours = true}, "own colours"));
  CHECK_FALSE(tells(ScanFormat::Obj, {}, "faces"));
  CHECK(tells(ScanFormat::Xyz, {}, "2 faces"));
  CHECK(tells(ScanFormat::Obj, {}, "channels", true));
  CHECK_FALSE(tells(ScanFormat::Obj, {}, "channels"));
}
