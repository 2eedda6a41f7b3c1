// The quick commands, one function each: what apply() calls. All throw InvalidInput when the
// command names what is not there, and Cancelled.
#pragma once

#include "document/apply.h"

namespace dapple {

// Throws InvalidInput when there is no such region.
const Region& regionOf(const Document& document, RegionId id);

// The image cropped, and the swatch that a region's options make of it. Throws InvalidInput.
Image cropped(const Image& image, const SwatchReference& reference);
std::shared_ptr<const Swatch> swatchFor(const Region& region);

// A colour for the next region, as unlike the others as can be.
vec3 nextColour(const std::vector<Region>& regions);

Document edited(const Document& document, const AddRegion& command);
Document edited(const Document& document, const RemoveRegion& command);
Document edited(const Document& document, const SetRegion& command);
Document edited(const Document& document, const ShowOnly& command);
Document edited(const Document& document, const MoveRegion& command);
Document edited(const Document& document, const AssignSelection& command);
Document edited(const Document& document, const SetSwatch& command, const CommandContext& context);
Document edited(const Document& document, const AddStroke& command);
Document edited(const Document& document, const SetStroke& command);
Document edited(const Document& document, const RemoveStroke& command);

Document edited(const Document& document, const Select& command);
Document edited(const Document& document, const SelectAll& command);
Document edited(const Document& document, const SelectRegion& command);
Document edited(const Document& document, const SelectConnected& command, Monitor& monitor);
Document edited(const Document& document, const SelectWand& command, Monitor& monitor);
Document edited(const Document& document, const GrowSelection& command, Monitor& monitor);
Document edited(const Document& document, const ShrinkSelection& command, Monitor& monitor);
Document edited(const Document& document, const InvertSelection& command);

}  // namespace dapple
