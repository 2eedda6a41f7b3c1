// All that a user works on, as one value: a handful of shared, immutable columns. A copy costs a
// few pointers, so that every undo step is a Document.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "document/results.h"
#include "document/texture_job.h"
#include "regions/point_mask.h"
#include "regions/strokes.h"

namespace dapple {

// A scan as it was opened.
struct OpenedScan {
  PreparedScan prepared;
  std::string path;  // absolute
  LoadOptions load;
  int neighbours = 0;      // of prepared.neighborhoods
  std::uint64_t hash = 0;  // of the file's bytes
};

// How a region passes into its neighbours (border_blend.h).
enum class BorderKind { Hard, Blend, Cut };
inline constexpr std::array kBorderKinds{"hard", "blend", "cut"};  // as files have them
std::optional<BorderKind> borderKindNamed(std::string_view name);

// What a user says of a part of the scan. Its scale is options.scale.
struct Region {
  RegionId id = kUnassigned;
  std::string name;
  vec3 colour{0.6f};
  bool visible = true;
  bool locked = false;  // its points stay its own and as they are
  SwatchReference reference;
  std::shared_ptr<const Image> image;  // cropped; null: none, or not found when the project opened
  std::shared_ptr<const Swatch> swatch;      // of image
  std::shared_ptr<const MaterialMaps> maps;  // of the same place; null: none
  TextureOptions options;
  double rotation = 0;  // of the swatch, degrees, counter-clockwise seen from outside
  BorderKind borderKind = BorderKind::Cut;
  double borderWidth = 16;  // of the band where it blends or is cut, mean point spacings
  Column<Stroke> strokes;   // null: none
};

struct Document {
  std::shared_ptr<const OpenedScan> scan;      // null: nothing is open
  Column<RegionId> labels;                     // n
  Column<Region> regions;                      // in the user's order; kUnassigned is always there
  std::shared_ptr<const PointMask> selection;  // null: nothing is selected
  Results results;

  std::size_t size() const { return scan ? scan->prepared.scan.points.size() : 0; }
  const PointSet& points() const { return scan->prepared.scan.points; }
};

// Nothing open, one region for all that will come.
Document emptyDocument();

// Null when there is none.
const Region* findRegion(const Document& document, RegionId id);
std::vector<Index> pointsOf(const Document& document, RegionId id);

// The colour that a viewer shows (n): results, else the scan's own, else kBare.
std::vector<vec3> shownColours(const Document& document);

// The results as one map, for what reads a whole scan at once (export). Its unit is that of the
// largest source, its scale tells what differs from it; its blends are those of gaps, not of
// borders (gatherTerms() has all). Throws InvalidInput when nothing is synthesized.
SourceMap wholeMap(const Document& document);

// The heap blocks that a document holds; the same block has the same address in all that share it.
struct MemoryBlock {
  const void* address = nullptr;
  std::size_t bytes = 0;
};
std::vector<MemoryBlock> memoryBlocks(const Document& document);

// Bytes of `document` that it does not share with `other`.
std::size_t ownBytes(const Document& document, const Document& other);

// True when all columns hold equal bytes and all regions equal settings, shared or not.
bool sameContent(const Document& a, const Document& b);

}  // namespace dapple
