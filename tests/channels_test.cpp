#include "document/channels.h"

#include <doctest/doctest.h>

#include <fstream>
#include <random>

#include "base/errors.h"
#include "document/live_regions.h"
#include "document/textured_scan.h"
#include "document_fixtures.h"
#include "fixtures.h"
#include "points/tangent_frames.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

constexpr int kSize = 48;  // of the fixtures' swatches

// Roughness grows to the right, height downwards; the normal leans to the right, and up as OpenGL
// has it; "small" does not fit.
Image mapNamed(const std::filesystem::path& path) {
  const std::string stem = path.stem().string();
  Image image{.width = kSize, .height = kSize, .channels = 3};
  image.pixels.resize(std::size_t{3} * kSize * kSize);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x)
      for (int c = 0; c < 3; ++c) {
        float& value = image.at(x, y, c);
        if (stem.ends_with("rough")) value = (static_cast<float>(x) + 0.5f) / kSize;
        if (stem.ends_with("height")) value = (static_cast<float>(y) + 0.5f) / kSize;
        if (stem.ends_with("nor_gl")) value = c == 0 ? 0.8f : c == 1 ? 0.6f : 0.9f;
        if (stem.ends_with("nor_dx")) value = c == 0 ? 0.8f : c == 1 ? 0.4f : 0.9f;
        if (stem.ends_with("flat")) value = c == 2 ? 1 : 0.5f;
      }
  if (stem.ends_with("small")) return noise(20);
  const bool known = stem.ends_with("rough") || stem.ends_with("height") ||
                     stem.ends_with("nor_gl") || stem.ends_with("nor_dx") || stem.ends_with("flat");
  return known ? image : imageNamed(path);
}

CommandContext context(std::vector<std::string>* notes = nullptr) {
  CommandContext out{.readImage = mapNamed};
  out.note = [notes](const std::string& text) {
    if (notes) notes->push_back(text);
  };
  return out;
}

Document with(const Document& d, const Command& command,
              std::vector<std::string>* notes = nullptr) {
  return applied(d, command, context(notes));
}

PointChannels channels(const Document& d) {
  Workers workers;
  Monitor monitor(workers);
  return channelsOf(d, monitor);
}

const std::vector<float>& scalar(const PointChannels& c, Channel channel) {
  return c.scalar[static_cast<std::size_t>(channel)];
}

SwatchReference reference(const std::string& path,
                          const std::vector<std::pair<Channel, std::string>>& files) {
  SwatchReference out{.path = path};
  for (const auto& [channel, file] : files) out.channels[channel] = file;
  return out;
}

Document textured(const TestFolder& folder, const SwatchReference& swatch,
                  Method method = Method::Hybrid) {
  Document d = sphereDocument(folder, 1500);
  TextureOptions options;
  options.method = method;
  options.tileable = Tileable::No;  // so that a ramp has no jump inside of a texel
  options.heightWeight = 0;
  d = with(d, SetRegion{.region = 0, .options = options});
  d = with(d, SetSwatch{.region = 0, .reference = swatch});
  return with(d, Synthesize{});
}

}  // namespace

TEST_CASE("channels are read at the texels that the colours come from, and change none") {
  const TestFolder folder;
  const Document plain = textured(folder, {.path = "/s/noise.png"});
  const Document d =
      textured(folder, reference("/s/noise.png", {{Channel::Roughness, "/s/rough.png"},
                                                  {Channel::Height, "/s/height.png"}}));
  CHECK(*d.results.colour == *plain.results.colour);
  CHECK(*d.results.texel == *plain.results.texel);
  CHECK(channels(plain).empty());
  const PointChannels c = channels(d);
  CHECK(c.normal.empty());
  CHECK(scalar(c, Channel::Metallic).empty());
  float worst = 0;
  for (Index i = 0; i < d.size(); ++i) {
    const vec2 texel = glm::clamp((*d.results.texel)[i], vec2(0.5f), vec2(kSize - 0.5f));
    worst = std::max(worst, std::abs(scalar(c, Channel::Roughness)[i] - texel.x / kSize));
    worst = std::max(worst, std::abs(scalar(c, Channel::Height)[i] - texel.y / kSize));
  }
  CHECK(worst < 1e-5f);
}

TEST_CASE("a normal map is turned into the points' frames, green up or down") {
  const TestFolder folder;
  SwatchReference swatch = reference("/s/noise.png", {{Channel::Normal, "/s/nor_gl.png"}});
  const Document d = textured(folder, swatch);
  swatch.channels[Channel::Normal] = "/s/nor_dx.png";
  swatch.channels.greenDown = true;
  const Document turned = with(d, SetSwatch{.region = 0, .reference = swatch});
  const PointChannels c = channels(d), same = channels(turned);
  const vec3 wanted = glm::normalize(vec3(0.6f, 0.2f, 0.8f));
  float worst = 0;
  for (Index i = 0; i < d.size(); ++i) {
    const TangentFrame f = orthonormalFrame(d.points().normals[i], (*d.results.frame)[i].t);
    const vec3 expected = wanted.x * f.s + wanted.y * f.t + wanted.z * f.n;
    worst =
        std::max({worst, glm::length(c.normal[i] - expected),
                  glm::length(same.normal[i] - expected), std::abs(glm::length(c.normal[i]) - 1)});
  }
  CHECK(worst < 1e-4f);
  const Document even = textured(folder, reference("/s/noise.png", {{Channel::Normal, "flat"}}));
  const PointChannels evenly = channels(even);
  for (Index i = 0; i < d.size(); ++i)
    CHECK(glm::length(evenly.normal[i] - d.points().normals[i]) < 1e-5f);
}

TEST_CASE("blended gaps and borders mix channels with the weights of their colours") {
  const TestFolder folder;
  Document d = sphereDocument(folder, 3000);
  d = with(d, Select{.points = half(d, true)});
  d = with(d, AddRegion{});
  TextureOptions options;
  options.method = Method::Patches, options.repair = 0;  // blends stay
  options.tileable = Tileable::No;
  for (const RegionId r : {0, 1})
    d = with(
        d, SetRegion{
               .region = r, .borderWidth = 8, .borderKind = BorderKind::Blend, .options = options});
  d = with(d, SetSwatch{.region = 0,
                        .reference = reference("/s/noise.png", {{Channel::Roughness, "rough"}})});
  d = with(d, SetSwatch{.region = 1, .reference = {.path = "/s/bricks.png"}});
  d = with(d, Synthesize{});
  REQUIRE(d.results.border);
  REQUIRE(!d.results.sources[0]->blended.empty());
  const PointChannels c = channels(d);
  std::vector<SourceTerm> terms;
  std::size_t none = 0, mixed = 0;
  for (Index i = 0; i < d.size(); ++i) {
    gatherTerms(d.results, i, terms);
    float sum = 0, weight = 0;
    for (const SourceTerm& term : terms)
      if (d.results.sources[term.source]->region == 0) {
        sum += term.weight * std::clamp(term.texel.x, 0.5f, kSize - 0.5f) / kSize;
        weight += term.weight;
      }
    const float value = scalar(c, Channel::Roughness)[i];
    none += weight == 0 ? 1 : 0;
    mixed += weight > 0 && terms.size() > 1 ? 1 : 0;
    if (weight == 0)
      CHECK(std::isnan(value));
    else
      CHECK(std::abs(value - sum / weight) < 1e-4f);
  }
  CHECK(none > 800);
  CHECK(mixed > 100);
}

TEST_CASE("maps of another size are refused by the names of both, unless they were only found") {
  const TestFolder folder;
  Document d = sphereDocument(folder, 400);
  try {
    with(d, SetSwatch{.region = 0,
                      .reference = reference("/s/noise.png", {{Channel::Height, "/s/small.png"}})});
    FAIL("no error");
  } catch (const InvalidInput& error) {
    const std::string text = error.what();
    CHECK(text.find("/s/small.png") != text.npos);
    CHECK(text.find("/s/noise.png") != text.npos);
    CHECK(text.find("20 x 20") != text.npos);
    CHECK(text.find("48 x 48") != text.npos);
  }
  CHECK_THROWS_AS(
      with(d, SetSwatch{.region = 0,
                        .reference = reference("/s/noise.png", {{Channel::Height, "none"}})}),
      IoError);
  for (const char* name : {"noise.png", "noise_rough.png", "noise_disp.png", "noise_ao.txt"})
    std::ofstream(folder / name) << "x";
  std::vector<std::string> notes;
  CommandContext small = context(&notes);
  small.readImage = [](const std::filesystem::path& path) {
    return path.stem() == "noise_disp" ? noise(20) : mapNamed(path);
  };
  d = applied(d, SetSwatch{.region = 0, .reference = {.path = folder / "noise.png"}}, small);
  const Region& region = *findRegion(d, 0);
  CHECK(region.reference.channels[Channel::Roughness] == folder / "noise_rough.png");
  CHECK(region.reference.channels[Channel::Height].empty());
  REQUIRE(region.maps);
  CHECK(region.maps->has(Channel::Roughness));
  CHECK(!region.maps->has(Channel::Height));
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].find("noise_disp.png") != std::string::npos);
  d = applied(
      d, SetSwatch{.region = 0, .reference = {.path = folder / "noise.png"}, .findChannels = false},
      small);
  CHECK(!findRegion(d, 0)->maps);
}

TEST_CASE("channels are cropped as the swatch is, and those of a result follow the region's") {
  const TestFolder folder;
  SwatchReference swatch = reference("/s/noise.png", {});
  swatch.crop = PixelRect{8, 4, 30, 32};
  Document d = textured(folder, swatch);
  CHECK(channels(d).empty());
  swatch.channels[Channel::Roughness] = "rough";
  const Document later = with(d, SetSwatch{.region = 0, .reference = swatch});
  CHECK(later.results.sources == d.results.sources);  // nothing was made again
  CHECK(touchedRegions(d, later).empty());            // nor is to be
  const std::vector<float> values = scalar(channels(later), Channel::Roughness);
  for (Index i = 0; i < d.size(); ++i) {
    const float x = std::clamp((*d.results.texel)[i].x, 0.5f, 29.5f) + 8;
    CHECK(std::abs(values[i] - x / kSize) < 1e-5f);
  }
  // Another swatch is not that of the results: they keep what they were made with.
  const Document made = with(later, Synthesize{});
  const Document other = with(made, SetSwatch{.region = 0, .reference = {.path = "/s/bricks.png"}});
  CHECK(scalar(channels(other), Channel::Roughness) == values);
}

TEST_CASE("projects keep channels, and note those that are missing") {
  const TestFolder folder;
  SwatchReference swatch = reference(
      "/s/noise.png", {{Channel::Roughness, "/s/rough.png"}, {Channel::Normal, "/s/nor_dx.png"}});
  swatch.channels.greenDown = true;
  const Document d = textured(folder, swatch);
  with(d, SaveProject{.path = folder / "a.dapple"});
  std::vector<std::string> notes;
  const Document again = with(emptyDocument(), OpenProject{.path = folder / "a.dapple"}, &notes);
  CHECK(notes.empty());
  CHECK(sameContent(again, d));
  CHECK(findRegion(again, 0)->reference == swatch);
  CHECK(channels(again).normal == channels(d).normal);
  CommandContext gone = context(&notes);
  gone.readImage = [](const std::filesystem::path& path) {
    if (path.stem() == "rough") throw IoError(path.string(), "", "gone", "Put it back.");
    return mapNamed(path);
  };
  const Document lacking = applied(emptyDocument(), OpenProject{.path = folder / "a.dapple"}, gone);
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].find("roughness") != std::string::npos);
  CHECK(findRegion(lacking, 0)->reference == swatch);
  CHECK(scalar(channels(lacking), Channel::Roughness).empty());
  CHECK(channels(lacking).normal == channels(d).normal);
}

TEST_CASE("an exported scan has its channels as columns, and all texels of its borders") {
  const TestFolder folder;
  Document d = sphereDocument(folder, 2000);
  d = with(d, Select{.points = half(d, true)});
  d = with(d, AddRegion{});
  const SwatchReference swatch =
      reference("/s/noise.png", {{Channel::Roughness, "rough"}, {Channel::Normal, "nor_gl"}});
  d = with(d, SetSwatch{.region = 0, .reference = swatch});
  d = with(d, SetSwatch{.region = 1, .reference = {.path = "/s/bricks.png"}});
  for (const RegionId r : {0, 1})
    d = with(d, SetRegion{.region = r, .borderKind = BorderKind::Hard});
  const Document hard = with(d, Synthesize{});
  d = with(hard, SetRegion{.region = 0, .borderWidth = 8, .borderKind = BorderKind::Blend});
  d = with(d, BlendBorders{});
  const auto saved = [&](const Document& document) {
    with(document, ExportScan{.path = folder / "out.ply", .options = {.sourceMap = true}});
    Workers workers;
    Monitor monitor(workers);
    return loadScan(folder / "out.ply", {}, monitor);
  };
  CHECK(!saved(hard).table.find(kBorderElement));
  const Scan scan = saved(d);
  const PointChannels read = readChannels(scan), made = channels(d);
  // The file is in the order of the scan's; so are its points, of the same positions.
  REQUIRE(read.normal.size() == d.size());
  for (Index i = 0; i < d.size(); ++i) {
    const float a = scalar(read, Channel::Roughness)[i], b = scalar(made, Channel::Roughness)[i];
    CHECK((a == b || (std::isnan(a) && std::isnan(b))));
    CHECK(read.normal[i] == made.normal[i]);
  }
  const Element* blend = scan.table.find(kBorderElement);
  REQUIRE(blend);
  std::vector<vec3> colour(scan.pointOf.size(), vec3(0));
  std::vector<float> weight(colour.size(), 0);
  for (std::size_t b = 0; b < blend->count; ++b) {
    const auto v = static_cast<std::size_t>(blend->find("vertex")->at(b));
    const auto s = static_cast<std::size_t>(blend->find("swatch")->at(b));
    const vec2 texel(blend->find("texel_x")->at(b), blend->find("texel_y")->at(b));
    const auto level = static_cast<float>(blend->find("level")->at(b));
    const auto w = static_cast<float>(blend->find("weight")->at(b));
    colour[v] += w * sampleSwatch(*d.results.sources[s]->swatch, texel, level);
    weight[v] += w;
  }
  std::size_t points = 0;
  for (std::size_t v = 0; v < colour.size(); ++v) {
    if (weight[v] == 0) continue;
    ++points;
    CHECK(std::abs(weight[v] - 1) < 1e-4f);
    CHECK(glm::length(colour[v] - scan.points.colours[scan.pointOf[v]]) < 0.006f);  // of 8 bits
  }
  CHECK(points == d.results.border->points.size());
}

TEST_CASE(
    "an exported texel gives the colour again at its level, whatever the method and density") {
  const TestFolder folder;
  const Document sphere = [&] {
    const Document d = sphereDocument(folder, 1500);
    const Document parted = with(with(d, Select{.points = half(d, true)}), AddRegion{});
    return with(parted, SetRegion{.region = 0, .borderKind = BorderKind::Hard});
  }();
  for (const Method method : {Method::Hybrid, Method::Coordinates, Method::Patches, Method::Match,
                              Method::Mapping, Method::Grid, Method::Tiling})
    for (const auto& [scale, repair] :
         {std::pair(0.3, 3.), std::pair(0.3, 0.), std::pair(1., 3.)}) {
      CAPTURE(static_cast<int>(method));
      CAPTURE(scale);
      CAPTURE(repair);
      Document d = sphere;
      TextureOptions options{.method = method, .levels = 3, .scale = scale};
      options.gaps = GapFill::Match, options.repair = repair;
      for (const RegionId r : {0, 1}) {
        d = with(d, SetRegion{.region = r, .options = options});
        d = with(d, SetSwatch{.region = r, .reference = {.path = "/s/noise.png"}});
      }
      d = with(d, Synthesize{});
      with(d, SaveProject{.path = folder / "a.dapple"});
      CHECK(sameContent(with(emptyDocument(), OpenProject{.path = folder / "a.dapple"}), d));
      with(d, ExportScan{.path = folder / "out.ply", .options = {.sourceMap = true}});
      Workers workers;
      Monitor monitor(workers);
      const std::optional<SourceMap> map = readSourceMap(loadScan(folder / "out.ply", {}, monitor));
      REQUIRE(map);
      float worst = 0;
      for (Index i = 0; i < d.size(); ++i) {
        const ResultSource& source = *d.results.sources[(*d.results.source)[i]];
        if (!source.termsAt(i).empty()) continue;
        const float level = map->level.empty() ? 0 : map->level[i];
        const vec3 off = sampleSwatch(*source.swatch, map->texel[i], level) - map->colour[i];
        worst = std::max({worst, std::abs(off.x), std::abs(off.y), std::abs(off.z)});
      }
      CHECK(worst < 0.501f / 255);  // of 8 bits
    }
}
