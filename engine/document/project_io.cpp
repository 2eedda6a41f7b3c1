#include "document/project_io.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "base/errors.h"
#include "base/hash_rng.h"
#include "document/channels.h"
#include "document/edits.h"
#include "document/options_table.h"
#include "document/project_borders.h"
#include "document/project_columns.h"
#include "io/output_file.h"
#include "io/ply.h"

namespace dapple {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using namespace project;

constexpr const char* kMark = "Dapple project";  // the first comment
constexpr std::size_t kHashBlock = std::size_t{1} << 20;
constexpr int kFewestNeighbours = 8, kMostNeighbours = 128;

// ---- columns -------------------------------------------------------------------------------

constexpr auto kTexel = {"texel_x", "texel_y"};
constexpr auto kFrame = {"frame_sx", "frame_sy", "frame_sz", "frame_tx", "frame_ty",
                         "frame_tz", "frame_nx", "frame_ny", "frame_nz"};
constexpr auto kColour = {"red", "green", "blue"};

Element pointElement(const Document& document) {
  Element points{.name = "point"};
  add<std::uint8_t>(points, {"region"}, *document.labels);
  if (document.selection) {
    std::vector<std::uint8_t> selected(document.size());
    for (std::size_t i = 0; i < selected.size(); ++i) selected[i] = document.selection->has(i);
    add<std::uint8_t>(points, {"selected"}, selected);
  }
  const Results& results = document.results;
  if (!results.source) return points;
  add<std::uint16_t>(points, {"source"}, *results.source);
  add<float>(points, kTexel, *results.texel);
  add<float>(points, kFrame, *results.frame);
  if (results.scale) add<float>(points, {"scale"}, *results.scale);
  if (results.level) add<float>(points, {"level"}, *results.level);
  add<float>(points, kColour, *results.colour);
  add<std::uint8_t>(points, {"state"}, *results.state);
  add<std::uint32_t>(points, {"patch"}, *results.patch);
  add<float>(points, {"error"}, *results.error);
  add<std::uint32_t>(points, {"order"}, *results.order);
  return points;
}

Element strokeElement(const Document& document) {
  std::vector<std::uint8_t> region;
  std::vector<float> weight, scale;
  std::vector<std::vector<float>> positions;
  std::vector<std::vector<Index>> points;
  for (const Region& r : *document.regions) {
    if (!r.strokes) continue;
    for (const Stroke& stroke : *r.strokes) {
      region.push_back(r.id);
      weight.push_back(stroke.weight);
      scale.push_back(stroke.scale.value_or(0));
      points.push_back(stroke.points);
      std::vector<float>& numbers = positions.emplace_back();
      for (const vec3& p : stroke.positions) numbers.insert(numbers.end(), {p.x, p.y, p.z});
    }
  }
  Element strokes{.name = "stroke"};
  add<std::uint8_t>(strokes, {"region"}, region);
  add<float>(strokes, {"weight"}, weight);
  add<float>(strokes, {"scale"}, scale);
  addLists(strokes, "positions", positions);
  addLists(strokes, "points", points);
  return strokes;
}

Element blendElement(const Results& results) {
  std::vector<std::uint16_t> source;
  std::vector<Index> point, patch;
  std::vector<vec2> texel;
  std::vector<float> weight;
  for (std::size_t s = 0; s < results.sources.size(); ++s) {
    const ResultSource& from = *results.sources[s];
    for (std::size_t b = 0, term = 0; b < from.blended.size(); ++b)
      for (; term < from.blendEnd[b]; ++term) {
        source.push_back(static_cast<std::uint16_t>(s));
        point.push_back(from.blended[b]);
        texel.push_back(from.blend[term].texel);
        patch.push_back(from.blend[term].patch);
        weight.push_back(from.blend[term].weight);
      }
  }
  Element blends{.name = "blend"};
  add<std::uint16_t>(blends, {"source"}, source);
  add<std::uint32_t>(blends, {"point"}, point);
  add<float>(blends, kTexel, texel);
  add<std::uint32_t>(blends, {"patch"}, patch);
  add<float>(blends, {"weight"}, weight);
  return blends;
}

// ---- settings ------------------------------------------------------------------------------

json optionsJson(const TextureOptions& options) {
  json out = json::object();
  for (const OptionRow& row : optionsTable()) out[std::string(row.name)] = optionText(options, row);
  return out;
}

TextureOptions optionsOf(const json& from) {
  TextureOptions options;
  for (const OptionRow& row : optionsTable())
    if (const auto at = from.find(std::string(row.name)); at != from.end())
      setOption(options, row, at->get<std::string>());
  // As it was called before there were fields.
  if (from.value("random-directions", "no") == "yes") options.field = FieldMethod::Random;
  return options;
}

json pathJson(const std::string& path, const fs::path& project) {
  const fs::path full = fs::absolute(path);
  const fs::path relative = full.lexically_relative(fs::absolute(project).parent_path());
  return {{"path", full.string()}, {"relative", relative.string()}};
}

// Beside the project first: a folder that was moved or copied as a whole goes on working.
std::vector<fs::path> placesOf(const json& from, const fs::path& project) {
  std::vector<fs::path> places;
  if (const std::string relative = from.at("relative"); !relative.empty())
    places.push_back((fs::absolute(project).parent_path() / relative).lexically_normal());
  if (const fs::path full = from.at("path").get<std::string>();
      places.empty() || full != places.front())
    places.push_back(full);
  return places;
}

// The first of them that is there; else the last.
std::string placeOf(const json& from, const fs::path& project) {
  const std::vector<fs::path> places = placesOf(from, project);
  const auto there = std::find_if(places.begin(), places.end(), [](const fs::path& place) {
    std::error_code ignored;
    return fs::exists(place, ignored);
  });
  return (there == places.end() ? places.back() : *there).string();
}

json swatchJson(const SwatchReference& reference, const fs::path& project) {
  if (reference.path.empty()) return nullptr;
  json out = pathJson(reference.path, project);
  for (std::size_t c = 0; c < kChannels; ++c)
    if (const std::string& path = reference.channels.paths[c]; !path.empty())
      out["channels"][std::string(channelName(static_cast<Channel>(c)))] = pathJson(path, project);
  if (reference.channels.greenDown) out["greenDown"] = true;
  if (const auto& crop = reference.crop)
    out["crop"] = {crop->x, crop->y, crop->width, crop->height};
  return out;
}

SwatchReference swatchReference(const json& from, const fs::path& project) {
  SwatchReference out;
  if (from.is_null()) return out;
  out.path = placeOf(from, project);
  if (const auto channels = from.find("channels"); channels != from.end())
    for (const auto& [name, path] : channels->items())
      out.channels[channelNamed(name)] = placeOf(path, project);
  out.channels.greenDown = from.value("greenDown", false);
  if (const auto at = from.find("crop"); at != from.end())
    out.crop = PixelRect{at->at(0), at->at(1), at->at(2), at->at(3)};
  return out;
}

json regionJson(const Region& region, const fs::path& project) {
  return {{"id", region.id},
          {"name", region.name},
          {"colour", {region.colour.x, region.colour.y, region.colour.z}},
          {"visible", region.visible},
          {"locked", region.locked},
          {"swatch", swatchJson(region.reference, project)},
          {"rotation", region.rotation},
          {"border", kBorderKinds[static_cast<std::size_t>(region.borderKind)]},
          {"borderWidth", region.borderWidth},
          {"options", optionsJson(region.options)}};
}

// Projects from before there were kinds blend where they have a width.
void setBorder(const json& from, Region& region) {
  const double width = from.at("borderWidth");
  const auto kind = from.find("border");
  if (kind == from.end()) {
    region.borderKind = width > 0 ? BorderKind::Blend : BorderKind::Hard;
    if (width > 0) region.borderWidth = width;
    return;
  }
  const auto named =
      kind->is_string() ? borderKindNamed(kind->get_ref<const std::string&>()) : std::nullopt;
  if (!named) throw InvalidInput(fmt::format("a region has a border of kind {}", kind->dump()));
  region.borderKind = *named;
  region.borderWidth = width;
}

Region regionOf(const json& from, const fs::path& project) {
  Region region;
  const std::int64_t id = from.at("id");
  if (id < 0 || id >= static_cast<std::int64_t>(kMostRegions))
    throw InvalidInput(fmt::format("a region has the id {}", id));
  region.id = static_cast<RegionId>(id);
  region.name = from.at("name");
  for (int c = 0; c < 3; ++c) region.colour[c] = from.at("colour").at(static_cast<std::size_t>(c));
  region.visible = from.at("visible");
  region.locked = from.at("locked");
  region.reference = swatchReference(from.at("swatch"), project);
  region.rotation = from.at("rotation");
  setBorder(from, region);
  region.options = optionsOf(from.at("options"));
  return region;
}

json sourceJson(const ResultSource& source, const fs::path& project) {
  const SynthesisStatistics& s = source.statistics;
  return {
      {"region", source.region},
      {"swatch", swatchJson(source.reference, project)},
      {"unit", source.unit},
      {"partial", source.partial},
      {"options", optionsJson(source.options)},
      {"statistics", {s.patches, s.gapShare, s.matchedShare, s.meanDistortion, s.maxDistortion}}};
}

ResultSource sourceOf(const json& from, const fs::path& project) {
  ResultSource source;
  source.region = from.at("region");
  source.reference = swatchReference(from.at("swatch"), project);
  source.unit = from.at("unit");
  source.partial = from.at("partial");
  source.options = optionsOf(from.at("options"));
  const json& s = from.at("statistics");
  source.statistics = {s.at(0), s.at(1), s.at(2), s.at(3), s.at(4)};
  return source;
}

json settingsOf(const Document& document, const fs::path& project) {
  const OpenedScan& scan = *document.scan;
  json from = pathJson(scan.path, project);
  from["hash"] = fmt::format("{:016x}", scan.hash);
  from["points"] = document.size();
  from["neighbours"] = scan.neighbours;
  from["samples"] = scan.load.samples;
  from["seed"] = scan.load.seed;
  json regions = json::array(), sources = json::array();
  for (const Region& region : *document.regions) regions.push_back(regionJson(region, project));
  for (const auto& source : document.results.sources)
    sources.push_back(sourceJson(*source, project));
  return {{"version", kProjectVersion}, {"scan", from}, {"regions", regions}, {"sources", sources}};
}

RecordTable readTable(const fs::path& path, Monitor& monitor) {
  monitor.begin(Stage::Load, 0);
  InputFile file(path, monitor);
  if (!looksLikePly(file.peek(std::min<std::size_t>(16, file.size()))))
    throw InvalidInput(file.path() + ": this is no Dapple project");
  return readPly(file, monitor);
}

json readSettings(const RecordTable& table, const std::string& file) {
  const auto mark = std::find(table.comments.begin(), table.comments.end(), kMark);
  if (mark == table.comments.end())
    throw InvalidInput(file + ": this PLY file is no Dapple project; open it as a scan");
  std::string text;
  std::for_each(mark + 1, table.comments.end(),
                [&](const std::string& line) { text += line + "\n"; });
  json settings = json::parse(text, nullptr, false);
  if (!settings.is_object()) refuse(file, "its settings are no JSON");
  const json version = settings.value("version", json());
  if (!version.is_number_integer()) refuse(file, "it names no version");
  if (version != kProjectVersion)
    throw InvalidInput(
        fmt::format("{}: this is a project of version {}, and this Dapple reads "
                    "version {}; open it with the Dapple that wrote it",
                    file, version.dump(), kProjectVersion));
  return settings;
}

// ---- putting together ----------------------------------------------------------------------

// What a reader of settings refuses, with the file that they are in.
template <class T>
T checked(const std::string& file, T (*read)(const json&, const fs::path&), const json& from) {
  try {
    return read(from, file);
  } catch (const InvalidInput& error) {
    refuse(file, error.what());
  }
}

std::shared_ptr<const OpenedScan> reopened(const json& from, const OpenProject& command,
                                           const TakePoints& loaded, Monitor& monitor) {
  std::vector<fs::path> places = placesOf(from, command.path);
  if (!command.scan.empty()) places = {command.scan};
  LoadOptions load{.samples = from.at("samples"), .seed = from.at("seed")};
  const std::string hash = from.at("hash");
  std::string seen;
  for (const fs::path& place : places) {
    std::error_code ignored;
    if (!fs::exists(place, ignored)) continue;
    auto scan =
        std::make_shared<OpenedScan>(openScan(place, load, from.at("neighbours"), loaded, monitor));
    if (fmt::format("{:016x}", scan->hash) == hash) return scan;
    seen = place.string();
  }
  if (!seen.empty())
    throw InvalidInput(
        fmt::format("{}: {} is not the scan that the project was made with (its "
                    "bytes differ); open the project with the place of the right one",
                    command.path, seen));
  std::string tried;
  for (const fs::path& place : places) tried += (tried.empty() ? "" : " nor at ") + place.string();
  throw InvalidInput(
      fmt::format("{}: its scan is not at {}; put it there, or open the project with "
                  "the place where the scan is now",
                  command.path, tried));
}

Column<Region> readRegions(const json& settings, const OpenProject& command,
                           const CommandContext& context) {
  std::vector<Region> regions;
  std::array<bool, 256> taken{};
  for (const json& from : settings.at("regions")) {
    Region region = checked(command.path, regionOf, from);
    if (std::exchange(taken[region.id], true))
      refuse(command.path, fmt::format("two regions have the id {}", region.id));
    if (!region.reference.path.empty()) try {
        DAPPLE_CHECK(static_cast<bool>(context.readImage), ==, true);
        const Image whole = context.readImage(region.reference.path);
        region.image = std::make_shared<const Image>(cropped(whole, region.reference));
        region.swatch = swatchFor(region);
        region.maps = readMaps(region.reference, whole, context.readImage,
                               [&](Channel channel, const std::string& why) {
                                 if (context.note)
                                   context.note(
                                       fmt::format("The {} map of region '{}' is not "
                                                   "available: {}",
                                                   channelName(channel), region.name, why));
                               });
      } catch (const std::runtime_error& error) {
        region.image = nullptr;
        if (context.note)
          context.note(fmt::format("The swatch of region '{}' is not available: {}", region.name,
                                   error.what()));
      }
    regions.push_back(std::move(region));
  }
  if (!taken[kUnassigned]) refuse(command.path, "the region of all unassigned points is missing");
  return std::make_shared<const std::vector<Region>>(std::move(regions));
}

struct RegionStroke {
  RegionId region;
  Stroke stroke;
};

std::vector<RegionStroke> strokesOf(const Columns& columns) {
  std::vector<RegionStroke> out;
  if (columns.count() == 0) return out;
  const auto region = columns.read<std::uint8_t, std::uint8_t>({"region"});
  const auto weight = columns.read<float, float>({"weight"});
  const auto scale = columns.read<float, float>({"scale"});
  const auto positions = columns.lists<float, vec3>("positions");
  const auto points = columns.lists<Index, Index>("points");
  for (std::size_t s = 0; s < region->size(); ++s) {
    Stroke stroke{.positions = positions[s], .points = points[s], .weight = (*weight)[s]};
    if ((*scale)[s] != 0) stroke.scale = (*scale)[s];
    out.push_back({(*region)[s], std::move(stroke)});
  }
  return out;
}

void readStrokes(const Columns& columns, Document& document, const std::string& file) {
  for (RegionStroke& from : strokesOf(columns)) {
    try {
      document =
          edited(document, AddStroke{.region = from.region, .stroke = std::move(from.stroke)});
    } catch (const InvalidInput& error) {
      refuse(file, error.what());
    }
  }
}

void readBlends(const Columns& columns, std::vector<ResultSource>& sources, std::size_t points,
                const std::string& file) {
  if (columns.count() == 0) return;
  const auto source = columns.read<std::uint16_t, std::uint16_t>({"source"});
  const auto point = columns.read<Index, Index>({"point"});
  const auto texel = columns.read<float, vec2>(kTexel);
  const auto patch = columns.read<Index, Index>({"patch"});
  const auto weight = columns.read<float, float>({"weight"});
  for (std::size_t b = 0; b < source->size(); ++b) {
    const Index i = (*point)[b];
    if ((*source)[b] >= sources.size() || i >= points)
      refuse(file, fmt::format("blend {} is of a point or source that does not exist", b));
    ResultSource& to = sources[(*source)[b]];
    if (!to.blended.empty() && i < to.blended.back())
      refuse(file, fmt::format("blend {} is out of order", b));
    if (to.blended.empty() || to.blended.back() != i)
      to.blended.push_back(i), to.blendEnd.push_back(0);
    to.blend.push_back({(*texel)[b], (*patch)[b], (*weight)[b]});
    to.blendEnd.back() = to.blend.size();
  }
}

// Gives a source the swatch that it was made from, when a region still has it.
void findSwatch(ResultSource& source, const std::vector<Region>& regions) {
  for (const Region& region : regions)
    if (region.swatch && sameImage(region.reference, source.reference) &&
        region.options.tileable == source.options.tileable) {
      source.swatch = region.swatch;
      source.maps = region.maps;
      return;
    }
}

Results readResults(const json& settings, const RecordTable& table, const Document& document,
                    const std::string& file) {
  Results results;
  const Columns points(file, table, "point");
  if (!points.has("source")) return results;
  std::vector<ResultSource> sources;
  for (const json& from : settings.at("sources")) sources.push_back(checked(file, sourceOf, from));
  readBlends(Columns(file, table, "blend"), sources, points.count(), file);
  for (ResultSource& source : sources) {
    findSwatch(source, *document.regions);
    results.sources.push_back(std::make_shared<const ResultSource>(std::move(source)));
  }
  results.source = points.read<std::uint16_t, std::uint16_t>({"source"});
  for (const std::uint16_t s : *results.source)
    if (s != kNoSource && s >= results.sources.size())
      refuse(file, fmt::format("a point comes from source {} of {}", s, results.sources.size()));
  results.texel = points.read<float, vec2>(kTexel);
  results.frame = points.read<float, TangentFrame>(kFrame);
  if (points.has("scale")) {
    results.scale = points.read<float, float>({"scale"});
    for (const float scale : *results.scale)
      if (!(scale > 0) || !std::isfinite(scale))
        refuse(file, fmt::format("the swatch has scale {} at a point", scale));
  }
  if (points.has("level")) {
    results.level = points.read<float, float>({"level"});
    for (const float level : *results.level)
      if (!(level >= 0) || !std::isfinite(level))
        refuse(file, fmt::format("a point is read at level {} of its swatch", level));
  }
  results.colour = points.read<float, vec3>(kColour);
  results.state = points.read<std::uint8_t, PointState>({"state"});
  for (const PointState state : *results.state)
    if (state > PointState::Matched) refuse(file, "a point has a state that does not exist");
  results.patch = points.read<Index, Index>({"patch"});
  results.error = points.read<float, float>({"error"});
  results.order = points.read<Index, Index>({"order"});
  results.border = readBorder(table, points.count(), results.sources.size(), file);
  return results;
}

Document assembled(const json& settings, const RecordTable& table, const OpenProject& command,
                   const CommandContext& context, Monitor& monitor) {
  const std::string& file = command.path;
  const Columns points(file, table, "point");
  const std::size_t count = settings.at("scan").at("points");
  if (points.count() != count)
    refuse(file, fmt::format("it has {} points, but its settings say {}", points.count(), count));
  Document document;
  document.scan = reopened(settings.at("scan"), command, context.loaded, monitor);
  if (document.size() != count)
    throw InvalidInput(fmt::format("{}: it was made for {} points, but {} gives {}", file, count,
                                   document.scan->path, document.size()));
  document.regions = readRegions(settings, command, context);
  document.labels = points.read<std::uint8_t, RegionId>({"region"});
  for (const RegionId id : *document.labels)
    if (!findRegion(document, id)) refuse(file, fmt::format("a point is of region {}", id));
  if (points.has("selected")) {
    const auto selected = points.read<std::uint8_t, std::uint8_t>({"selected"});
    PointMask mask(count);
    for (std::size_t i = 0; i < count; ++i)
      if ((*selected)[i]) mask.add(i);
    if (mask.count() > 0) document.selection = std::make_shared<const PointMask>(std::move(mask));
  }
  readStrokes(Columns(file, table, "stroke"), document, file);
  document.results = readResults(settings, table, document, file);
  return document;
}

std::uint64_t hashOf(const fs::path& path, Monitor& monitor) {
  InputFile file(path, monitor);
  std::uint64_t hash = mixBits(file.size());
  while (file.remaining() > 0) {
    const std::string_view block = file.peek(std::min(kHashBlock, file.remaining()));
    const std::string_view bytes = block.substr(0, kHashBlock);
    for (std::size_t at = 0; at < bytes.size(); at += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes.data() + at, std::min<std::size_t>(8, bytes.size() - at));
      hash = mixBits(hash ^ word);
    }
    file.skip(bytes.size());
  }
  return hash;
}

}  // namespace

OpenedScan openScan(const fs::path& path, const LoadOptions& load, int neighbours,
                    const TakePoints& loaded, Monitor& monitor) {
  if (neighbours < kFewestNeighbours || neighbours > kMostNeighbours)
    throw InvalidInput(fmt::format("neighbours: {} is outside {} to {}", neighbours,
                                   kFewestNeighbours, kMostNeighbours));
  OpenedScan scan{.path = fs::absolute(path).lexically_normal().string(),
                  .load = load,
                  .neighbours = neighbours};
  scan.prepared = prepareScan(path, load, neighbours, loaded, monitor);
  scan.hash = hashOf(path, monitor);
  return scan;
}

void saveProject(const Document& document, const fs::path& path, Monitor& monitor) {
  if (!document.scan) throw InvalidInput("there is nothing to save; open a scan first");
  RecordTable table;
  table.comments.push_back(kMark);
  std::string text = settingsOf(document, path).dump(1, ' ', false, json::error_handler_t::replace);
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    table.comments.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  table.elements = {pointElement(document), strokeElement(document),
                    blendElement(document.results)};
  addBorder(table, document.results.border.get());
  monitor.begin(Stage::Save, document.size());
  OutputFile file(path);
  writePly(file, table, false, monitor);
  monitor.checkpoint();
  file.commit();
}

Document loadProject(const OpenProject& command, const CommandContext& context, Monitor& monitor) {
  const RecordTable table = readTable(command.path, monitor);
  const json settings = readSettings(table, command.path);
  try {
    return assembled(settings, table, command, context, monitor);
  } catch (const json::exception& error) {
    refuse(command.path, fmt::format("its settings lack something ({})", error.what()));
  }
}

std::vector<NamedStroke> readProjectStrokes(const fs::path& path, std::size_t points,
                                            Monitor& monitor) {
  const std::string file = path.string();
  const RecordTable table = readTable(path, monitor);
  const json settings = readSettings(table, file);
  const std::size_t own = Columns(file, table, "point").count();
  if (own != points)
    throw InvalidInput(
        fmt::format("{}: its strokes run over a scan of {} points, and this one has {}; give the "
                    "scan that the project was made with",
                    file, own, points));
  std::map<RegionId, std::string> names;
  try {
    for (const json& region : settings.at("regions"))
      names[region.at("id").get<RegionId>()] = region.at("name");
  } catch (const json::exception& error) {
    refuse(file, fmt::format("its settings lack something ({})", error.what()));
  }
  std::vector<NamedStroke> out;
  for (RegionStroke& from : strokesOf(Columns(file, table, "stroke"))) {
    try {
      validate(from.stroke, points);
    } catch (const InvalidInput& error) {
      refuse(file, error.what());
    }
    out.push_back({std::move(from.stroke), names[from.region]});
  }
  return out;
}

}  // namespace dapple
