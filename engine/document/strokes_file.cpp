#include "document/strokes_file.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/errors.h"
#include "document/project_io.h"
#include "io/output_file.h"
#include "io/ply.h"
#include "points/kd_tree.h"

namespace dapple {
namespace {

using json = nlohmann::ordered_json;

constexpr const char* kFormat = "dapple-strokes";
constexpr int kVersion = 1;
constexpr float kFarthest = 0.1f;  // from the scan, in diagonals of its bounds

// Where strokes are laid onto a scan.
class Surface {
 public:
  Surface(const PointSet& points, const Neighborhoods& neighborhoods)
      : points_(points),
        cloud_{points.positions},
        tree_(3, cloud_, nanoflann::KDTreeSingleIndexAdaptorParams(16)),
        spacing_(static_cast<float>(meanSpacing(neighborhoods, points.positions))) {
    tree_.buildIndex();
    vec3 low(points.positions.at(0)), high(low);
    for (const vec3& p : points.positions) low = glm::min(low, p), high = glm::max(high, p);
    diagonal_ = glm::length(high - low);
  }

  Index nearest(const vec3& to, float& distance) const {
    std::uint32_t id = 0;
    float squared = 0;
    tree_.knnSearch(&to.x, 1, &id, &squared);
    distance = std::sqrt(squared);
    return id;
  }

  // The stroke along a line of local positions.
  void lay(const std::vector<vec3>& line, Stroke& stroke, Monitor& monitor) const {
    float distance = 0;
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
      const float length = distanceBetween(line[i], line[i + 1]);
      const int steps = std::max(1, static_cast<int>(std::ceil(length / spacing_)));
      for (int step = i == 0 ? 0 : 1; step <= steps; ++step) {
        if (step % 1024 == 0) monitor.checkpoint();
        const float t = static_cast<float>(step) / static_cast<float>(steps);
        const vec3 at = line[i] + t * (line[i + 1] - line[i]);
        const Index point = nearest(at, distance);
        if (!stroke.points.empty() && stroke.points.back() == point) continue;
        const vec3& n = points_.normals[point];
        stroke.points.push_back(point);
        stroke.positions.push_back(at - n * glm::dot(n, at - points_.positions[point]));
      }
    }
  }

  float diagonal() const { return diagonal_; }

 private:
  const PointSet& points_;
  KdCloud cloud_;
  KdTree tree_;
  float spacing_, diagonal_ = 0;
};

// What is wrong with a stroke, without its file and number.
[[noreturn]] void refuse(const std::string& cause, const std::string& remedy) {
  throw InvalidInput(fmt::format("{}; {}", cause, remedy));
}

dvec3 positionOf(const json& from, std::size_t index) {
  dvec3 out(0);
  bool good = from.is_array() && from.size() == 3;
  for (int c = 0; good && c < 3; ++c) {
    const json& number = from[static_cast<std::size_t>(c)];
    good = number.is_number();
    if (good) out[c] = number.get<double>();
    good = good && std::isfinite(out[c]);
  }
  if (!good) refuse(fmt::format("position {} is {}", index, from.dump()), "give three numbers");
  return out;
}

float positiveNumber(const json& from, const char* name) {
  const json& value = from.at(name);
  if (!value.is_number() || !(value.get<float>() > 0) || !std::isfinite(value.get<float>()))
    refuse(fmt::format("its {} is {}", name, value.dump()), "give a number above 0");
  return value.get<float>();
}

std::vector<vec3> lineOf(const json& from, const PointSet& points, const Surface& surface) {
  if (!from.contains("positions") || !from["positions"].is_array() || from["positions"].size() < 2)
    refuse("it has no list \"positions\" of two or more", "give the points of a line");
  std::vector<vec3> line;
  for (const json& position : from["positions"]) {
    const dvec3 model = positionOf(position, line.size());
    const vec3 local((model - points.origin) / points.modelUnits);
    float distance = 0;
    surface.nearest(local, distance);
    if (!(distance <= kFarthest * surface.diagonal()))
      refuse(fmt::format("position {} lies {:.3g} away from the scan, whose size is {:.3g}",
                         line.size(), static_cast<double>(distance) * points.modelUnits,
                         static_cast<double>(surface.diagonal()) * points.modelUnits),
             "give positions on its surface, in its own units");
    line.push_back(local);
  }
  return line;
}

NamedStroke strokeOf(const json& from, const PointSet& points, const Surface& surface,
                     Monitor& monitor) {
  if (!from.is_object()) refuse("it is no object", "give {\"positions\": [[x, y, z], ...]}");
  NamedStroke out;
  if (from.contains("weight")) out.stroke.weight = positiveNumber(from, "weight");
  if (from.contains("scale")) out.stroke.scale = positiveNumber(from, "scale");
  if (from.contains("region")) {
    if (!from["region"].is_string()) refuse("its region is no text", "give a region's name");
    out.region = from["region"].get<std::string>();
  }
  surface.lay(lineOf(from, points, surface), out.stroke, monitor);
  if (out.stroke.points.size() < 2)
    refuse("all of it is nearest to one point of the scan", "draw a longer line");
  return out;
}

std::string textOf(InputFile& file) {
  std::string text;
  while (file.remaining() > 0) {
    const std::string_view block = file.peek(1);
    text += block;
    file.skip(block.size());
  }
  return text;
}

const json& listOf(const json& whole, const std::string& file) {
  if (!whole.is_object() || whole.value("format", json()) != kFormat)
    throw InvalidInput(fmt::format(
        "{}: this is neither a file of strokes (JSON with \"format\": \"{}\") nor a Dapple "
        "project; give one of them",
        file, kFormat));
  const json version = whole.value("version", json());
  if (version != kVersion)
    throw InvalidInput(
        fmt::format("{}: these are strokes of version {}, and this Dapple reads "
                    "version {}; write them as such",
                    file, version.dump(), kVersion));
  if (!whole.contains("strokes") || !whole["strokes"].is_array())
    throw InvalidInput(
        fmt::format("{}: it has no list \"strokes\"; add one, even if it is empty", file));
  return whole["strokes"];
}

}  // namespace

std::vector<NamedStroke> readStrokes(const std::filesystem::path& path, const PointSet& points,
                                     const Neighborhoods& neighborhoods, Monitor& monitor) {
  InputFile file(path, monitor);
  if (looksLikePly(file.peek(std::min<std::size_t>(16, file.size()))))
    return readProjectStrokes(path, points.size(), monitor);
  const json whole = json::parse(textOf(file), nullptr, false);
  const json& list = listOf(whole, file.path());
  std::vector<NamedStroke> strokes;
  if (list.empty()) return strokes;
  const Surface surface(points, neighborhoods);
  for (std::size_t s = 0; s < list.size(); ++s) {
    try {
      strokes.push_back(strokeOf(list[s], points, surface, monitor));
    } catch (const InvalidInput& error) {
      throw InvalidInput(fmt::format("{}: stroke {}: {}", file.path(), s, error.what()));
    }
  }
  return strokes;
}

void writeStrokes(const std::filesystem::path& path, const std::vector<NamedStroke>& strokes,
                  const PointSet& points) {
  json list = json::array();
  for (const NamedStroke& named : strokes) {
    json positions = json::array();
    for (const vec3& p : named.stroke.positions) {
      const dvec3 model = points.origin + points.modelUnits * dvec3(p);
      positions.push_back({model.x, model.y, model.z});
    }
    json stroke{{"positions", positions}, {"weight", named.stroke.weight}};
    if (named.stroke.scale) stroke["scale"] = *named.stroke.scale;
    if (!named.region.empty()) stroke["region"] = named.region;
    list.push_back(std::move(stroke));
  }
  const json whole{{"format", kFormat}, {"version", kVersion}, {"strokes", list}};
  const std::string text = whole.dump(1) + "\n";
  OutputFile file(path);
  file.write(text.data(), text.size());
  file.commit();
}

std::vector<Stroke> strokesFrom(const std::filesystem::path& path, const PointSet& points,
                                const Neighborhoods& neighborhoods, Monitor& monitor) {
  std::vector<Stroke> out;
  if (path.empty()) return out;
  for (NamedStroke& named : readStrokes(path, points, neighborhoods, monitor))
    out.push_back(std::move(named.stroke));
  return out;
}

}  // namespace dapple
