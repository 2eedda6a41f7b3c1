// What a user can do to a document. Every change, from window or command line, is one of these.
#pragma once

#include <filesystem>
#include <functional>
#include <variant>

#include "document/document.h"
#include "document/textured_scan.h"
#include "regions/segmentation.h"

namespace dapple {

enum class SelectMode { Replace, Add, Subtract, Intersect };

struct OpenScan {
  std::string path;
  LoadOptions load;
  int neighbours = 25;
};
struct AddRegion {
  std::string name;            // empty: numbered
  std::optional<vec3> colour;  // else one that differs from the others
  bool fromSelection = true;   // the selected points become its own
};
struct RemoveRegion {
  RegionId region;  // its points become unassigned
};
struct SetRegion {  // what is given
  RegionId region;
  std::optional<std::string> name;
  std::optional<vec3> colour;
  std::optional<bool> visible, locked;
  std::optional<double> rotation, borderWidth;
  std::optional<BorderKind> borderKind;
  std::optional<TextureOptions> options;
  unsigned gesture = 0;  // not 0: with others of the same number one step of the history
};
struct ShowOnly {  // the other regions are hidden; none given: all are shown
  std::optional<RegionId> region;
};
struct MoveRegion {
  RegionId region;
  std::size_t position;  // in the list
};
struct Select {
  std::vector<Index> points;  // Replace with none: nothing is selected
  SelectMode mode = SelectMode::Replace;
};
struct SelectAll {};
struct SelectRegion {
  RegionId region;
  SelectMode mode = SelectMode::Replace;
};
struct SelectConnected {
  Index seed;
  SelectMode mode = SelectMode::Replace;
};
struct SelectWand {
  Index seed;
  WandOptions wand;  // a Distance in mean point spacings
  SelectMode mode = SelectMode::Replace;
};
struct GrowSelection {
  int steps = 1;
};
struct ShrinkSelection {
  int steps = 1;
};
struct InvertSelection {};
struct AssignSelection {
  RegionId region;  // points of locked regions stay
};
struct SetSwatch {
  RegionId region;
  SwatchReference reference;  // an empty path: no swatch; a folder: swatchFile() of it
  unsigned gesture = 0;       // as SetRegion's
  // Channels that the reference does not name are looked for beside the swatch
  // (material_files.h); what is found and does not fit is noted, not refused.
  bool findChannels = true;
};
struct AddStroke {
  RegionId region;
  Stroke stroke;
};
struct SetStroke {
  RegionId region;
  std::size_t stroke;
  Stroke value;
  unsigned gesture = 0;  // as SetRegion's
};
struct RemoveStroke {
  RegionId region;
  std::size_t stroke;
};
struct SegmentAutomatically {
  int parts = 4;  // new regions, set up as kUnassigned is, in place of all that are not locked
};
struct Synthesize {
  std::optional<RegionId> region;  // else every region that has a swatch and is not locked
  // Points whose result is what is asked for keep it, as far as the method allows that; the others
  // are to suit them. Else all points are synthesized, and the result does not depend on the last.
  bool onlyChanged = false;
};
// Makes region borders again, by the kinds, widths and results that there are: after
// SetRegion{.borderWidth}. Synthesize does it, too.
struct BlendBorders {};
struct ClearResult {
  std::optional<RegionId> region;
};
struct OpenProject {
  std::string path;
  std::string scan;  // where the scan is now, if neither place that the project names holds it
};
struct SaveProject {
  std::string path;
};
struct ExportScan {
  std::string path;
  ExportOptions options;
  bool ascii = false;
};
struct Undo {};
struct Redo {};
struct GoTo {
  std::size_t entry;  // of the history
};

using Command =
    std::variant<OpenScan, AddRegion, RemoveRegion, SetRegion, ShowOnly, MoveRegion, Select,
                 SelectAll, SelectRegion, SelectConnected, SelectWand, GrowSelection,
                 ShrinkSelection, InvertSelection, AssignSelection, SetSwatch, AddStroke, SetStroke,
                 RemoveStroke, SegmentAutomatically, Synthesize, BlendBorders, ClearResult,
                 OpenProject, SaveProject, ExportScan, Undo, Redo, GoTo>;

}  // namespace dapple
