// Before a scan is exported: the format, what goes into the file, and what it cannot hold.
#pragma once

#include <optional>

#include "document/commands.h"
#include "document/export_format.h"

namespace dapple {

class ExportDialog {
 public:
  void open() { opening_ = true; }
  bool isOpen() const { return open_ || opening_; }

  // Once a frame, outside windows. True in the frame in which the user goes on to choose a file.
  // Marks: "export.format.ply", ".obj", ".xyz", "export.corners", "export.accept", "export.cancel".
  bool draw(const Document& document);

  // What was chosen; its path is to be filled in.
  ExportScan command() const { return {.options = options_, .ascii = ascii_}; }
  ScanFormat format() const { return format_; }

 private:
  void formatRows();
  void contentRows(const Document& document);
  void losses(const Document& document) const;

  ScanFormat format_ = ScanFormat::Ply;
  ExportOptions options_{.sourceMap = true};
  bool ascii_ = false, opening_ = false, open_ = false;
};

// Into how many parts a scan is segmented by itself.
class SegmentDialog {
 public:
  void open() { opening_ = true; }
  bool isOpen() const { return open_ || opening_; }
  // The command, in the frame in which the user goes on. Marks: "segment.parts", "segment.accept".
  std::optional<SegmentAutomatically> draw();

 private:
  float parts_ = 4;
  bool opening_ = false, open_ = false;
};

}  // namespace dapple
