#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "app/assets_path.h"
#include "app/cli/cli.h"
#include "app/editor/editor.h"
#include "app/editor/settings.h"
#include "app/gui/desktop_dialog.h"
#include "app/gui/window.h"
#include "base/errors.h"

namespace dapple {
namespace {

// How often something that works in the background is looked at, seconds.
constexpr double kLook = 0.1;

constexpr std::chrono::seconds kDialogStarts(2);  // or our own is used

struct EditArguments {
  std::vector<std::string> files;
  bool factorySettings = false;
};

void runEdit(const EditArguments& arguments, const CommonOptions& common) {
  const std::vector<std::string>& files = arguments.files;
  for (const std::string& file : files)
    if (!std::filesystem::exists(file))
      throw IoError(file, "", "there is no such file", "Check the name and the folder");
  const std::filesystem::path config =
      arguments.factorySettings ? std::filesystem::path() : userConfigFolder();
  const Settings remembered = peekSettings(config);
  std::unique_ptr<Window> window;
  try {
    window = std::make_unique<Window>(WindowOptions{.width = remembered.windowWidth,
                                                    .height = remembered.windowHeight,
                                                    .applicationId = "org.dapple.Dapple"});
  } catch (const NoWindow& error) {
    throw InvalidInput(error.what());
  }
  Editor editor({.assets = assetsFolder(),
                 .threads = static_cast<unsigned>(common.table.threads),
                 .wake = Window::wake,
                 .config = config,
                 .state = userStateFolder(),
                 .desktopScale = window->desktopScale(),
                 .askDesktop = [parent = window->portalName()](const FileQuestion& question,
                                                               const std::stop_token& stop) {
                   return askPortal(question, parent, kDialogStarts, stop);
                 }});
  for (const std::string& file : files) editor.open(std::filesystem::absolute(file));
  window->onClose([&] { return editor.mayClose(); });
  std::string title;
  window->run([&] {
    const bool again = editor.frame(window->width(), window->height());
    if (editor.title() != title) window->setTitle(title = editor.title());
    if (editor.wantsToClose()) window->close();
    if (again) return NextFrame::now();
    return editor.engine().status().busy || editor.waiting() ? NextFrame::after(kLook)
                                                             : NextFrame::onEvent();
  });
}

}  // namespace

Subcommand addEditCommand(CLI::App& app, CommonOptions& common) {
  CLI::App* sub = app.add_subcommand("edit", "Open the editor; so does dapple without a command.");
  auto arguments = std::make_shared<EditArguments>();
  sub->add_option("files", arguments->files, "a scan or a project, and images: swatches");
  sub->add_flag("--factory-settings", arguments->factorySettings,
                "neither read nor write the user's settings and keys");
  addTableOption(*sub, "threads", common);
  // Stopped by a signal it leaves what recovery needs: closing it in order would throw that away.
  return {.app = sub,
          .common = &common,
          .run = [arguments, &common](Monitor&) { runEdit(*arguments, common); },
          .staysOpen = true};
}

}  // namespace dapple
