#include "app/cli/cli.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/cli/progress_printer.h"
#include "base/errors.h"
#include "io/image_io.h"
#include "swatch/material_files.h"

namespace dapple {
namespace {

constexpr int kBug = 1, kBadInput = 2, kStopped = 130;

// Turns Ctrl-C into a stop request. A thread waits for the signal, so that nothing has to be done
// inside a handler; a second Ctrl-C ends the program at once.
class InterruptWatch {
 public:
  explicit InterruptWatch(std::stop_source& stop) {
    sigemptyset(&signals_);
    for (const int signal : {SIGINT, SIGTERM, SIGUSR2}) sigaddset(&signals_, signal);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
    thread_ = std::jthread([this, &stop] {
      for (int count = 0;; ++count) {
        int signal = 0;
        sigwait(&signals_, &signal);
        if (signal == SIGUSR2) return;  // our own: the work is done
        if (count > 0) _exit(kStopped);
        stop.request_stop();
      }
    });
  }
  ~InterruptWatch() { pthread_kill(thread_.native_handle(), SIGUSR2); }

 private:
  sigset_t signals_;
  std::jthread thread_;
};

int report(int code, const char* prefix, const char* text) {
  std::fprintf(stderr, "dapple: %s%s\n", prefix, text);
  return code;
}

// Without the program's name and, as CLI11 wants them, from the last to the first. A --shading
// without a word after it gets its value here: CLI11 would take the scan's name for it.
std::vector<std::string> argumentsOf(int argc, char** argv) {
  std::vector<std::string> all(argv + 1, argv + argc);
  if (all.empty()) return {"edit"};
  const auto isWord = [](const std::string& text) {
    return !text.empty() && text.find_first_not_of("abcdefghijklmnopqrstuvwxyz") == text.npos;
  };
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i] == "--shading" && (i + 1 == all.size() || !isWord(all[i + 1])))
      all[i] = "--shading=headlight";
  std::reverse(all.begin(), all.end());
  return all;
}

void runCommand(const Subcommand& command) {
  std::stop_source stop;
  std::optional<InterruptWatch> watch;
  if (!command.staysOpen) watch.emplace(stop);
  ProgressPrinter printer(progressStyle(*command.common));
  Workers workers(static_cast<unsigned>(command.common->table.threads));
  Monitor monitor(workers, stop.get_token(),
                  {.progress = [&](const Progress& progress) { printer.show(progress); }});
  command.run(monitor);
}

}  // namespace

void addTableOption(CLI::App& app, std::string_view name, CommonOptions& common) {
  const OptionRow* row = findOption(name);
  DAPPLE_CHECK(row != nullptr, ==, true);
  const std::string option = "--" + std::string(name);
  const std::string standard = optionText(TextureOptions{}, *row);
  auto set = [&common, row](const std::string& value) {
    setOption(common.table, *row, value);
    common.given.emplace_back(row->name);
    return true;
  };
  if (row->choices == "yes|no") {
    app.add_flag_function(
        fmt::format("{},!--no-{}", option, name),
        [set](std::int64_t count) { set(count > 0 ? "yes" : "no"); },
        fmt::format("{} [{}]", row->help, standard == "yes" ? "on" : "off"));
    return;
  }
  app.add_option_function<std::string>(option, set, fmt::format("{} [{}]", row->help, standard))
      ->type_name(optionRange(*row));
}

void addDrawingOptions(CLI::App& app, DrawingArguments& arguments) {
  app.add_option(
         "--texels", arguments.texels,
         "auto|on|off: show the swatch itself inside the splats where the view magnifies it")
      ->capture_default_str();
  app.add_option("--renderer", arguments.renderer,
                 "auto|gl|cpu: what draws, OpenGL or the processor; auto takes the processor where "
                 "OpenGL is only software, as it is without a display")
      ->capture_default_str();
  app.add_option("--shading", arguments.shading,
                 "off|headlight|studio: light the picture; --shading alone is headlight [off; "
                 "headlight for a scan without colours]");
  app.add_option("--background", arguments.background,
                 "white|grey|black|#rrggbb|red,green,blue (0 to 255)")
      ->capture_default_str();
}

void addExportOptions(CLI::App& app, ExportScan& command) {
  ExportOptions& options = command.options;
  app.add_option(
         "-o,--output", command.path,
         "textured scan to write: .ply with all columns; .obj with colours and, of a mesh, texture "
         "coordinates; .xyz with colours")
      ->required();
  app.add_flag("--ascii", command.ascii, "write the PLY as text");
  app.add_flag("--source-map", options.sourceMap,
               "also write swatch, texel, frame, patch, state, error and order of every point");
  app.add_flag("--texture-coordinates,!--no-texture-coordinates", options.corners,
               "where in the swatch the corners of a mesh's faces lie (PLY: texcoord; "
               "OBJ: vt, with the swatch in a .mtl file beside it) [on]");
  app.add_flag("--keep-colours", options.keepColours,
               "keep the scan's own colours as original_red, original_green, original_blue");
}

void addStrokesOption(CLI::App& app, std::string& path) {
  app.add_option("--strokes", path,
                 "lines over the surface along which the swatch's top points: JSON, or a Dapple "
                 "project of the same scan");
}

Swatch readSwatch(const std::string& path, Tileable tileable, int levels) {
  const std::string file = swatchFile(path).string();
  return makeSwatch(readImage(file), tileable, levels, file);
}

void addCommonOptions(CLI::App& app, CommonOptions& common) {
  addTableOption(app, "threads", common);
  app.add_flag("--quiet", common.quiet, "no progress and no summary");
  app.add_option("--progress", common.progress, "auto|bar|lines|json, on standard error")
      ->capture_default_str();
}

int runCommandLine(int argc, char** argv) {
  CLI::App app{"Dapple textures point-sampled scans by example.", "dapple"};
  app.set_version_flag("--version", DAPPLE_VERSION);
  app.require_subcommand(1);
  std::vector<CommonOptions> common(9);
  const std::vector<Subcommand> commands{
      addTextureCommand(app, common[0]), addInfoCommand(app, common[1]),
      addRenderCommand(app, common[2]),  addScoreCommand(app, common[3]),
      addFieldCommand(app, common[4]),   addSynth2dCommand(app, common[5]),
      addTileCommand(app, common[6]),    addBakeCommand(app, common[7]),
      addEditCommand(app, common[8])};
  try {
    app.parse(argumentsOf(argc, argv));
    for (const Subcommand& command : commands)
      if (command.app->parsed()) runCommand(command);
    return 0;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    return report(kBadInput, "", fmt::format("{}. See --help.", error.what()).c_str());
  } catch (const Cancelled&) {
    return report(kStopped, "stopped; nothing was written", "");
  } catch (const InvalidInput& error) {
    return report(kBadInput, "", error.what());
  } catch (const IoError& error) {
    return report(kBadInput, "", error.what());
  } catch (const std::bad_alloc&) {
    return report(kBadInput, "",
                  "not enough memory for this scan; close other programs or thin it");
  } catch (const std::exception& error) {
    return report(kBug, "this is a bug in Dapple, please report it: ", error.what());
  }
}

}  // namespace dapple
