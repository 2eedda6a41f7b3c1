#include "document_fixtures.h"

#include <unistd.h>

#include <atomic>
#include <fstream>

#include "base/errors.h"
#include "fixtures.h"

namespace dapple::fixtures {

TestFolder::TestFolder() {
  static std::atomic<int> number{0};
  path_ = std::filesystem::temp_directory_path() /
          fmt::format("dapple-test-{}-{}", ::getpid(), number++);
  std::filesystem::create_directories(path_);
}

TestFolder::~TestFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string writeSphere(const TestFolder& folder, std::size_t count, const std::string& name) {
  const PointSet sphere = makeSphere(count, 1);
  std::ofstream file(folder / name);
  for (std::size_t i = 0; i < count; ++i) {
    const vec3 p = sphere.positions[i], n = sphere.normals[i];
    file << fmt::format("{} {} {} {} {} {} {}\n", p.x, p.y, p.z, n.x, n.y, n.z,
                        p.x < 0 ? "255 0 0" : "0 0 255");
  }
  return folder / name;
}

Image imageNamed(const std::filesystem::path& path) {
  const std::string stem = path.stem().string();
  if (stem == "bricks") return bricks(48);
  if (stem == "noise") return noise(48);
  if (stem == "stripes") return stripes(48, 8);
  throw IoError(path.string(), "", "there is no such file", "Check the name.");
}

CommandContext testContext() {
  return {.readImage = imageNamed};
}

Document applied(const Document& document, const Command& command, const CommandContext& context) {
  Workers workers;
  Monitor monitor(workers);
  return apply(document, command, context, monitor);
}

Document sphereDocument(const TestFolder& folder, std::size_t count) {
  return applied(emptyDocument(), OpenScan{.path = writeSphere(folder, count), .neighbours = 16});
}

std::vector<Index> half(const Document& document, bool left) {
  std::vector<Index> out;
  for (Index i = 0; i < document.size(); ++i)
    if ((document.points().positions[i].x < 0) == left) out.push_back(i);
  return out;
}

Stroke meridian(const Document& document, int count) {
  Stroke stroke;
  for (int s = 0; s < count; ++s) {
    const float angle = -0.8f + 1.6f * static_cast<float>(s) / static_cast<float>(count - 1);
    const dvec3 model(std::cos(angle), 0, std::sin(angle));
    const PointSet& points = document.points();
    const vec3 wanted((model - points.origin) / points.modelUnits);
    Index nearest = 0;
    for (Index i = 1; i < points.size(); ++i)
      if (glm::length(points.positions[i] - wanted) <
          glm::length(points.positions[nearest] - wanted))
        nearest = i;
    stroke.points.push_back(nearest);
    stroke.positions.push_back(points.positions[nearest]);
  }
  return stroke;
}

}  // namespace dapple::fixtures
