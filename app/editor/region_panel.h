// The list of regions: what belongs to which, with which swatch, and what can be done with it.
#pragma once

#include <string>

#include "app/editor/swatch_library.h"
#include "document/engine.h"

namespace dapple {

class RegionPanel {
 public:
  // The rows with their menus. What the user does goes to the engine; returns the region that is
  // chosen now. Marks: "region.row.ID", "region.colour.ID", "region.visible.ID",
  // "region.locked.ID", "region.name" (the field of a new name).
  RegionId draw(const Document& document, RegionId chosen, SwatchLibrary& library, Engine& engine);

  // The row becomes a field for a new name.
  void rename(const Region& region);

 private:
  bool row(const std::vector<Region>& regions, std::size_t position, bool chosen);
  void chip(const Region& region);
  void name(const Region& region, float width);
  void buttons(const Region& region);
  void menu(const Region& region, std::size_t position, std::size_t count);

  SwatchLibrary* library_ = nullptr;  // while draw() runs
  Engine* engine_ = nullptr;
  RegionId renaming_ = kUnassigned;
  bool open_ = false, focus_ = false;  // the field
  std::string name_;
  vec3 picked_{0};        // in the colour's popup
  unsigned gesture_ = 0;  // of the drag that goes on
};

}  // namespace dapple
