#include "document/live_regions.h"

#include <algorithm>
#include <array>

#include "document/border_blend.h"
#include "document/channels.h"

namespace dapple {
namespace {

// Channels are attached by choosing the swatch again; a synthesis looks at heights only.
bool onlyChannels(const Region& a, const Region& b) {
  return sameImage(a.reference, b.reference) && !(a.reference == b.reference);
}

bool sameInput(const Region& a, const Region& b) {
  const bool sameSwatch = (a.image == b.image && a.swatch == b.swatch) || onlyChannels(a, b);
  return sameSwatch && sameHeights(a.maps.get(), b.maps.get(), b.options) &&
         a.options == b.options && a.rotation == b.rotation && a.strokes == b.strokes;
}

bool hasBorder(const Region& region) {
  return region.borderKind != BorderKind::Hard && region.borderWidth > 0;
}

}  // namespace

std::vector<RegionId> touchedRegions(const Document& before, const Document& after) {
  std::vector<RegionId> out;
  if (!after.scan || before.scan != after.scan) return out;
  std::array<bool, kMostRegions + 1> touched{};
  for (const Region& region : *after.regions) {
    const Region* old = findRegion(before, region.id);
    touched[region.id] = old && !sameInput(*old, region);
  }
  if (before.labels != after.labels)
    for (std::size_t i = 0; i < after.size(); ++i)
      if ((*before.labels)[i] != (*after.labels)[i]) touched[(*after.labels)[i]] = true;
  for (std::size_t id = 0; id < touched.size(); ++id)
    if (touched[id]) out.push_back(static_cast<RegionId>(id));
  return out;
}

bool bordersTouched(const Document& before, const Document& after) {
  if (!after.results.source || before.scan != after.scan) return false;
  bool wide = false, changed = before.labels != after.labels;
  for (const Region& region : *after.regions) {
    const Region* old = findRegion(before, region.id);
    wide |= hasBorder(region) || (old && hasBorder(*old));
    changed |= old && !asksForSameBorder(*old, region);
  }
  return wide && changed;
}

bool canSynthesize(const Document& document, RegionId id) {
  const Region* region = findRegion(document, id);
  return document.scan && region && region->swatch && !region->locked &&
         std::find(document.labels->begin(), document.labels->end(), id) != document.labels->end();
}

}  // namespace dapple
