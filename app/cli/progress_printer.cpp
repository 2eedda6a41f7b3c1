#include "app/cli/progress_printer.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "base/errors.h"

namespace dapple {
namespace {

constexpr int kBarWidth = 28;
constexpr double kLeastRate = 1000;  // points/s; below, what is counted are not the scan's points

std::string rate(double pointsPerSecond) {
  if (pointsPerSecond >= 1e6) return fmt::format("{:.2f} M points/s", pointsPerSecond / 1e6);
  return fmt::format("{:.0f} k points/s", pointsPerSecond / 1e3);
}

}  // namespace

ProgressStyle progressStyle(const CommonOptions& common) {
  if (common.quiet) return ProgressStyle::Quiet;
  if (common.progress == "json") return ProgressStyle::Json;
  if (common.progress == "lines") return ProgressStyle::Lines;
  if (common.progress == "bar") return ProgressStyle::Bar;
  if (common.progress != "auto")
    throw InvalidInput(
        fmt::format("--progress: '{}' is not allowed; give auto|bar|lines|json", common.progress));
  return isatty(STDERR_FILENO) ? ProgressStyle::Bar : ProgressStyle::Lines;
}

ProgressPrinter::~ProgressPrinter() {
  if (barOpen_) std::fputs("\r\033[K", stderr);
}

void ProgressPrinter::show(const Progress& progress) {
  switch (style_) {
    case ProgressStyle::Bar:
      return showBar(progress);
    case ProgressStyle::Json:
      return showJson(progress);
    case ProgressStyle::Quiet:
      return;
    default:
      return showLine(progress);
  }
}

void ProgressPrinter::showBar(const Progress& progress) {
  const int filled = static_cast<int>(progress.fraction * kBarWidth);
  std::string line = fmt::format("\r{:<11}[{:#<{}}{:.<{}}] {:3.0f} %", stageName(progress.stage),
                                 "", filled, "", kBarWidth - filled, progress.fraction * 100);
  if (progress.pointsPerSecond >= kLeastRate)
    line +=
        fmt::format("  {}, {:.1f} s left", rate(progress.pointsPerSecond), progress.secondsLeft);
  line += "\033[K";
  std::fputs(line.c_str(), stderr);
  barOpen_ = true;
}

// A line when a stage begins and at every further tenth of a stage that takes its time.
void ProgressPrinter::showLine(const Progress& progress) {
  const int tenths = static_cast<int>(progress.fraction * 10);
  const bool begins = !started_ || progress.stage != stage_;
  if (!begins && tenths <= tenths_) return;
  started_ = true;
  stage_ = progress.stage;
  tenths_ = begins ? 0 : tenths;
  std::string line = stageName(stage_);
  if (tenths_ > 0) line += fmt::format(" {:.0f} %", progress.fraction * 100);
  if (tenths_ > 0 && progress.pointsPerSecond >= kLeastRate)
    line += ", " + rate(progress.pointsPerSecond);
  line += '\n';
  std::fputs(line.c_str(), stderr);
}

void ProgressPrinter::showJson(const Progress& progress) {
  const nlohmann::ordered_json line{{"stage", stageName(progress.stage)},
                                    {"fraction", progress.fraction},
                                    {"points_per_second", progress.pointsPerSecond},
                                    {"seconds_left", progress.secondsLeft}};
  std::fputs((line.dump() + '\n').c_str(), stderr);
}

}  // namespace dapple
