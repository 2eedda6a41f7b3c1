// Progress for people at a terminal, for logs and for other programs; all on standard error.
#pragma once

#include "app/cli/cli.h"

namespace dapple {

// "auto" is a bar on a terminal and lines otherwise. Throws InvalidInput for another name.
ProgressStyle progressStyle(const CommonOptions& common);

class ProgressPrinter {
 public:
  explicit ProgressPrinter(ProgressStyle style) : style_(style) {}
  ~ProgressPrinter();  // ends the bar's line

  void show(const Progress& progress);

 private:
  void showBar(const Progress& progress);
  void showLine(const Progress& progress);
  static void showJson(const Progress& progress);

  ProgressStyle style_;
  bool barOpen_ = false;
  bool started_ = false;
  Stage stage_ = Stage::Load;
  int tenths_ = 0;
};

}  // namespace dapple
