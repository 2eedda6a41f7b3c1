#include <algorithm>
#include <array>
#include <cmath>

#include "base/errors.h"
#include "document/channels.h"
#include "document/edits.h"
#include "document/options_table.h"
#include "swatch/material_files.h"

namespace dapple {
namespace {

constexpr double kMostRotation = 36000;
constexpr double kWidestBorder = 1000;
constexpr std::size_t kLongestName = 200;
// Told apart by most people with a colour deficiency as well.
constexpr std::array<vec3, 8> kPalette{vec3(0.90f, 0.62f, 0.00f), vec3(0.34f, 0.71f, 0.91f),
                                       vec3(0.00f, 0.62f, 0.45f), vec3(0.94f, 0.89f, 0.26f),
                                       vec3(0.00f, 0.45f, 0.70f), vec3(0.84f, 0.37f, 0.00f),
                                       vec3(0.80f, 0.47f, 0.65f), vec3(0.55f, 0.34f, 0.29f)};

template <class T>
std::shared_ptr<const std::vector<T>> shared(std::vector<T> column) {
  return std::make_shared<const std::vector<T>>(std::move(column));
}

std::size_t positionOf(const Document& document, RegionId id) {
  return static_cast<std::size_t>(&regionOf(document, id) - document.regions->data());
}

Document withRegion(const Document& document, std::size_t position, Region region) {
  std::vector<Region> regions = *document.regions;
  regions[position] = std::move(region);
  Document out = document;
  out.regions = shared(std::move(regions));
  return out;
}

RegionId freeId(const std::vector<Region>& regions) {
  std::array<bool, kMostRegions> taken{};
  for (const Region& region : regions) taken[region.id] = true;
  const auto at = std::find(taken.begin(), taken.end(), false);
  if (at == taken.end())
    throw InvalidInput(
        fmt::format("there are {} regions already, the most that a document can "
                    "hold; remove one first",
                    kMostRegions));
  return static_cast<RegionId>(at - taken.begin());
}

void checkName(const std::string& name) {
  if (name.empty() || name.size() > kLongestName)
    throw InvalidInput(
        fmt::format("a region's name has {} bytes; give 1 to {}", name.size(), kLongestName));
}

void checkNumber(const char* what, double value, double low, double high) {
  if (!(value >= low && value <= high))
    throw InvalidInput(fmt::format("{}: {} is outside {} to {}", what, value, low, high));
}

bool needsNewSwatch(const TextureOptions& a, const TextureOptions& b) {
  return a.tileable != b.tileable || stackLevels(a) != stackLevels(b);
}

std::vector<Stroke> strokesOf(const Region& region, std::size_t stroke) {
  std::vector<Stroke> strokes = region.strokes ? *region.strokes : std::vector<Stroke>();
  if (stroke >= strokes.size())
    throw InvalidInput(fmt::format("region '{}' has {} strokes, there is no stroke {}", region.name,
                                   strokes.size(), stroke + 1));
  return strokes;
}

Document withStrokes(const Document& document, RegionId id, std::vector<Stroke> strokes) {
  Region region = regionOf(document, id);
  region.strokes = strokes.empty() ? nullptr : shared(std::move(strokes));
  return withRegion(document, positionOf(document, id), std::move(region));
}

// What is named must fit; what is found may.
void attachChannels(Region& region, const Image& whole, const SetSwatch& command,
                    const CommandContext& context) {
  ChannelPaths& named = region.reference.channels;
  region.maps = readMaps(region.reference, whole, context.readImage);
  if (!command.findChannels) return;
  const ChannelPaths beside = findChannels(region.reference.path);
  if (named[Channel::Normal].empty()) named.greenDown = beside.greenDown;
  bool found = false;
  for (std::size_t c = 0; c < kChannels; ++c)
    if (named.paths[c].empty() && !beside.paths[c].empty())
      named.paths[c] = beside.paths[c], found = true;
  if (!found) return;
  region.maps = readMaps(
      region.reference, whole, context.readImage, [&](Channel channel, const std::string& why) {
        named[channel].clear();
        if (context.note)
          context.note(fmt::format("The {} map beside the swatch is left out: {}",
                                   channelName(channel), why));
      });
}

// Labels with the points of `mask` at `region`, but for points of locked regions.
Document assigned(const Document& document, const PointMask& mask, RegionId region) {
  std::array<bool, 256> locked{};
  for (const Region& r : *document.regions) locked[r.id] = r.locked;
  if (locked[region])
    throw InvalidInput(fmt::format("region '{}' is locked; unlock it to give it points",
                                   regionOf(document, region).name));
  std::vector<RegionId> labels = *document.labels;
  for (const Index i : mask.points())
    if (!locked[labels[i]]) labels[i] = region;
  Document out = document;
  out.labels = shared(std::move(labels));
  return out;
}

}  // namespace

const Region& regionOf(const Document& document, RegionId id) {
  const Region* region = findRegion(document, id);
  if (!region) throw InvalidInput(fmt::format("there is no region {}", id));
  return *region;
}

Image cropped(const Image& image, const SwatchReference& reference) {
  if (!reference.crop) return image;
  const PixelRect& r = *reference.crop;
  if (r.x < 0 || r.y < 0 || r.width < 2 || r.height < 2 || r.width > image.width - r.x ||
      r.height > image.height - r.y)
    throw InvalidInput(
        fmt::format("{}: the crop {}x{} at ({}, {}) does not lie in the image of {}x{} pixels; "
                    "give one inside, "
                    "of 2x2 or more",
                    reference.path, r.width, r.height, r.x, r.y, image.width, image.height));
  Image out{.width = r.width, .height = r.height, .channels = image.channels};
  const auto rowSize = static_cast<std::size_t>(r.width) * static_cast<std::size_t>(image.channels);
  for (int y = 0; y < r.height; ++y) {
    const float* row =
        image.pixels.data() + (static_cast<std::size_t>(y + r.y) * image.width + r.x) *
                                  static_cast<std::size_t>(image.channels);
    out.pixels.insert(out.pixels.end(), row, row + rowSize);
  }
  return out;
}

std::shared_ptr<const Swatch> swatchFor(const Region& region) {
  return std::make_shared<const Swatch>(makeSwatch(
      *region.image, region.options.tileable, stackLevels(region.options), region.reference.path));
}

vec3 nextColour(const std::vector<Region>& regions) {
  std::array<std::size_t, kPalette.size()> used{};
  for (const Region& region : regions)
    for (std::size_t c = 0; c < kPalette.size(); ++c)
      used[c] += region.colour == kPalette[c] ? 1 : 0;
  return kPalette[static_cast<std::size_t>(std::min_element(used.begin(), used.end()) -
                                           used.begin())];
}

Document edited(const Document& document, const AddRegion& command) {
  Region region;
  region.id = freeId(*document.regions);
  region.name = command.name.empty() ? fmt::format("Region {}", region.id) : command.name;
  checkName(region.name);
  region.colour = command.colour.value_or(nextColour(*document.regions));
  const RegionId id = region.id;
  std::vector<Region> regions = *document.regions;
  regions.push_back(std::move(region));
  Document out = document;
  out.regions = shared(std::move(regions));
  if (command.fromSelection && out.selection) out = assigned(out, *out.selection, id);
  return out;
}

Document edited(const Document& document, const RemoveRegion& command) {
  const Region& region = regionOf(document, command.region);
  if (region.id == kUnassigned)
    throw InvalidInput(fmt::format(
        "region '{}' holds the points that belong to no other; it cannot be removed", region.name));
  if (region.locked)
    throw InvalidInput(fmt::format("region '{}' is locked; unlock it to remove it", region.name));
  std::vector<Region> regions = *document.regions;
  std::erase_if(regions, [&](const Region& r) { return r.id == command.region; });
  Document out = document;
  out.regions = shared(std::move(regions));
  if (document.labels) {
    std::vector<RegionId> labels = *document.labels;
    std::replace(labels.begin(), labels.end(), command.region, kUnassigned);
    out.labels = shared(std::move(labels));
  }
  return out;
}

Document edited(const Document& document, const SetRegion& command) {
  Region region = regionOf(document, command.region);
  if (command.name) checkName(*command.name), region.name = *command.name;
  if (command.colour) region.colour = glm::clamp(*command.colour, vec3(0), vec3(1));
  if (command.visible) region.visible = *command.visible;
  if (command.locked) region.locked = *command.locked;
  if (command.rotation) {
    checkNumber("rotation", *command.rotation, -kMostRotation, kMostRotation);
    region.rotation = *command.rotation;
  }
  if (command.borderWidth) {
    checkNumber("border width", *command.borderWidth, 0, kWidestBorder);
    region.borderWidth = *command.borderWidth;
  }
  if (command.borderKind) region.borderKind = *command.borderKind;
  if (command.options) {
    validate(*command.options);
    const bool remake = region.image && needsNewSwatch(region.options, *command.options);
    region.options = *command.options;
    if (remake) region.swatch = swatchFor(region);
  }
  return withRegion(document, positionOf(document, command.region), std::move(region));
}

Document edited(const Document& document, const ShowOnly& command) {
  if (command.region) regionOf(document, *command.region);
  std::vector<Region> regions = *document.regions;
  for (Region& region : regions) region.visible = !command.region || region.id == *command.region;
  Document out = document;
  out.regions = shared(std::move(regions));
  return out;
}

Document edited(const Document& document, const MoveRegion& command) {
  std::vector<Region> regions = *document.regions;
  const std::size_t from = positionOf(document, command.region);
  if (command.position >= regions.size())
    throw InvalidInput(fmt::format("there is no place {} in a list of {} regions",
                                   command.position + 1, regions.size()));
  Region moved = std::move(regions[from]);
  regions.erase(regions.begin() + static_cast<std::ptrdiff_t>(from));
  regions.insert(regions.begin() + static_cast<std::ptrdiff_t>(command.position), std::move(moved));
  Document out = document;
  out.regions = shared(std::move(regions));
  return out;
}

Document edited(const Document& document, const AssignSelection& command) {
  regionOf(document, command.region);
  if (!document.selection)
    throw InvalidInput("nothing is selected; select the points that the region should have");
  return assigned(document, *document.selection, command.region);
}

Document edited(const Document& document, const SetSwatch& command, const CommandContext& context) {
  Region region = regionOf(document, command.region);
  region.reference = command.reference;
  region.image = nullptr;
  region.swatch = nullptr;
  region.maps = nullptr;
  if (!command.reference.path.empty()) {
    DAPPLE_CHECK(static_cast<bool>(context.readImage), ==, true);
    region.reference.path = swatchFile(command.reference.path).string();
    const Image whole = context.readImage(region.reference.path);
    region.image = std::make_shared<const Image>(cropped(whole, region.reference));
    // Only channels have changed: what compares swatches by their address is to see that.
    const Region& old = regionOf(document, command.region);
    const bool same = old.swatch && sameImage(old.reference, region.reference) &&
                      old.image->width == region.image->width &&
                      old.image->pixels == region.image->pixels;
    if (same) region.image = old.image;
    region.swatch = same ? old.swatch : swatchFor(region);
    attachChannels(region, whole, command, context);
  }
  return withRegion(document, positionOf(document, command.region), std::move(region));
}

Document edited(const Document& document, const AddStroke& command) {
  const Region& region = regionOf(document, command.region);
  validate(command.stroke, document.size());
  std::vector<Stroke> strokes = region.strokes ? *region.strokes : std::vector<Stroke>();
  strokes.push_back(command.stroke);
  return withStrokes(document, command.region, std::move(strokes));
}

Document edited(const Document& document, const SetStroke& command) {
  std::vector<Stroke> strokes = strokesOf(regionOf(document, command.region), command.stroke);
  validate(command.value, document.size());
  strokes[command.stroke] = command.value;
  return withStrokes(document, command.region, std::move(strokes));
}

Document edited(const Document& document, const RemoveStroke& command) {
  std::vector<Stroke> strokes = strokesOf(regionOf(document, command.region), command.stroke);
  strokes.erase(strokes.begin() + static_cast<std::ptrdiff_t>(command.stroke));
  return withStrokes(document, command.region, std::move(strokes));
}

}  // namespace dapple
