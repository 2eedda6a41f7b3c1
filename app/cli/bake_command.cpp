// A project without a window: what `dapple edit` would synthesize and export.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <memory>

#include "app/cli/cli.h"
#include "app/cli/report.h"
#include "base/errors.h"
#include "document/apply.h"
#include "document/export_format.h"
#include "document/project_io.h"
#include "io/image_io.h"

namespace dapple {
namespace {

const std::string kKinds = fmt::format("{}", fmt::join(kBorderKinds, "|"));

struct BakeArguments {
  std::string project, scan, border, save;
  std::optional<double> borderWidth;
  bool onlyChanged = false;
  ExportScan exported;
};

// Without a swatch that the project names, the result would be another one, and nobody would see.
void checkSwatches(const Document& document, const BakeArguments& a) {
  std::size_t ready = 0;
  for (const Region& region : *document.regions) {
    if (!region.reference.path.empty() && !region.swatch)
      throw InvalidInput(
          fmt::format("{}: the swatch of \"{}\" cannot be read: {}; put it back, or "
                      "give the region another one with dapple edit",
                      a.project, region.name, region.reference.path));
    ready += region.swatch && !region.locked;
  }
  if (ready == 0)
    throw InvalidInput(
        fmt::format("{}: no region that is not locked has a swatch; give one to a region with "
                    "dapple edit",
                    a.project));
}

class Bake {
 public:
  Bake(const BakeArguments& a, const CommonOptions& common, Monitor& monitor)
      : a_(a), quiet_(common.quiet), monitor_(monitor) {
    context_.readImage = [](const auto& path) { return readImage(path); };
    context_.note = [this](const std::string& text) {
      if (!quiet_) fmt::print("{}\n", text);
    };
  }

  void run() {
    give(OpenProject{.path = a_.project, .scan = a_.scan});
    checkSwatches(document_, a_);
    setBorders();
    const auto begin = std::chrono::steady_clock::now();
    give(Synthesize{.onlyChanged = a_.onlyChanged});
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    give(a_.exported);
    if (!a_.save.empty()) give(SaveProject{a_.save});
    if (quiet_) return;
    fmt::print("{} points in {} regions in {:.2f} s\n{}\n", document_.size(),
               document_.regions->size(), seconds.count(), a_.exported.path);
    if (!a_.save.empty()) fmt::print("{}\n", a_.save);
  }

 private:
  void give(const Command& command) { document_ = apply(document_, command, context_, monitor_); }

  void setBorders() {
    SetRegion all{.borderWidth = a_.borderWidth};
    if (!a_.border.empty()) all.borderKind = borderKindNamed(a_.border);
    if (!all.borderKind && !all.borderWidth) return;
    const Column<Region> regions = document_.regions;
    for (const Region& region : *regions) {
      all.region = region.id;
      give(all);
    }
  }

  const BakeArguments& a_;
  bool quiet_;
  Monitor& monitor_;
  CommandContext context_;
  Document document_ = emptyDocument();
};

void runBake(const BakeArguments& a, const CommonOptions& common, Monitor& monitor) {
  validate(common.table);
  for (const std::string& path : {a.exported.path, a.save}) checkWritable(path);
  exportFormat(a.exported.path);
  if (!a.border.empty() && !borderKindNamed(a.border))
    throw InvalidInput(
        fmt::format("--border: '{}' is not allowed; choose one of {}", a.border, kKinds));
  Bake(a, common, monitor).run();
}

}  // namespace

Subcommand addBakeCommand(CLI::App& app, CommonOptions& common) {
  CLI::App* sub = app.add_subcommand(
      "bake", "Texture a scan as a project says, region by region, without a window.");
  auto a = std::make_shared<BakeArguments>();
  sub->add_option("project", a->project, "project that dapple edit saved: .dapple")->required();
  addExportOptions(*sub, a->exported);
  sub->add_option("--scan", a->scan, "where the scan is now, if the project does not find it");
  sub->add_flag("--only-changed", a->onlyChanged,
                "keep what the project has of results that are still what it asks for");
  sub->add_option("--border", a->border,
                  kKinds + ": how regions meet, in place of what the project says");
  sub->add_option("--border-width", a->borderWidth,
                  "of the band where regions blend or are cut, in mean point spacings, in place of "
                  "what the project says");
  sub->add_option("--save", a->save, "also write the project with its results: .dapple");
  addCommonOptions(*sub, common);
  return {sub, &common, [a, &common](Monitor& monitor) { runBake(*a, common, monitor); }};
}

}  // namespace dapple
