// The command line: one function a subcommand, one place that turns errors into exit codes.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "base/monitor.h"
#include "document/commands.h"
#include "document/options_table.h"

namespace dapple {

enum class ProgressStyle { Auto, Bar, Lines, Json, Quiet };

// What every subcommand that works on a scan can be told.
struct CommonOptions {
  TextureOptions table;            // threads; a command adds the rows that it needs
  std::vector<std::string> given;  // names of its rows that were typed
  bool quiet = false;
  std::string progress = "auto";
};

// A subcommand registers itself and its options, and returns what to run when it was chosen.
struct Subcommand {
  CLI::App* app = nullptr;
  const CommonOptions* common = nullptr;
  std::function<void(Monitor&)> run;
  // It works until it is stopped, and never looks at the monitor: signals end it at once.
  bool staysOpen = false;
};
Subcommand addTextureCommand(CLI::App& app, CommonOptions& common);
Subcommand addInfoCommand(CLI::App& app, CommonOptions& common);
Subcommand addRenderCommand(CLI::App& app, CommonOptions& common);
Subcommand addScoreCommand(CLI::App& app, CommonOptions& common);
Subcommand addFieldCommand(CLI::App& app, CommonOptions& common);
Subcommand addSynth2dCommand(CLI::App& app, CommonOptions& common);
Subcommand addTileCommand(CLI::App& app, CommonOptions& common);
Subcommand addBakeCommand(CLI::App& app, CommonOptions& common);
Subcommand addEditCommand(CLI::App& app, CommonOptions& common);

// An option, or a flag, of the options table: help, default, range and behaviour cannot differ.
void addTableOption(CLI::App& app, std::string_view name, CommonOptions& common);

// How a picture is drawn, as it was typed.
struct DrawingArguments {
  std::string renderer = "auto", texels = "auto", shading, background = "white";
};
void addDrawingOptions(CLI::App& app, DrawingArguments& arguments);

// -o and what goes into the scan that is written.
void addExportOptions(CLI::App& app, ExportScan& command);

// --strokes FILE.
void addStrokesOption(CLI::App& app, std::string& path);

// The swatch of an image, or of the folder of one material. Throws InvalidInput, IoError.
Swatch readSwatch(const std::string& path, Tileable tileable, int levels);

// --threads, --quiet and --progress.
void addCommonOptions(CLI::App& app, CommonOptions& common);

// Exit code: 0 done; 1 a bug in Dapple; 2 bad input or a file that cannot be read or written;
// 130 stopped by Ctrl-C.
int runCommandLine(int argc, char** argv);

}  // namespace dapple
