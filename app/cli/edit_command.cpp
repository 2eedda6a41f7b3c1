#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "app/assets_path.h"
#include "app/cli/cli.h"
#include "app/editor/editor.h"
#include "app/gui/window.h"
#include "base/errors.h"

namespace dapple {
namespace {

// How often something that works in the background is looked at, seconds.
constexpr double kLook = 0.1;

void runEdit(const std::vector<std::string>& files, const CommonOptions& common) {
  for (const std::string& file : files)
    if (!std::filesystem::exists(file))
      throw IoError(file, "", "there is no such file", "Check the name and the folder");
  std::unique_ptr<Window> window;
  try {
    window = std::make_unique<Window>(WindowOptions{.applicationId = "org.dapple.Dapple"});
  } catch (const NoWindow& error) {
    throw InvalidInput(error.what());
  }
  Editor editor({.assets = assetsFolder(),
                 .threads = static_cast<unsigned>(common.table.threads),
                 .wake = Window::wake});
  for (const std::string& file : files) editor.open(std::filesystem::absolute(file));
  window->run([&] {
    const bool again = editor.frame(window->width(), window->height());
    if (editor.wantsToClose()) window->close();
    if (again) return NextFrame::now();
    return editor.engine().status().busy ? NextFrame::after(kLook) : NextFrame::onEvent();
  });
}

}  // namespace

Subcommand addEditCommand(CLI::App& app, CommonOptions& common) {
  CLI::App* sub = app.add_subcommand("edit", "Open the editor; so does dapple without a command.");
  auto files = std::make_shared<std::vector<std::string>>();
  sub->add_option("files", *files, "a scan or a project, and images: swatches");
  addTableOption(*sub, "threads", common.table);
  return {sub, &common, [files, &common](Monitor&) { runEdit(*files, common); }};
}

}  // namespace dapple
