// The program's own dialog for files and folders: works on every desktop and without one.
#pragma once

#include <imgui.h>

#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/gui/folder_listing.h"

namespace dapple {

enum class BrowseFor { open, save, folder };

struct FileKind {
  std::string name;                     // "Scans"
  std::vector<std::string> extensions;  // ".ply", lower case; empty: all files
};

struct FileQuestion {
  BrowseFor purpose = BrowseFor::open;
  std::string title;             // "Open scan"
  std::string accept;            // of the button; empty: Open, Save or Choose
  std::filesystem::path folder;  // to begin in; the nearest that exists above it, else home
  std::string name;              // suggested when saving
  std::vector<FileKind> kinds;   // saving adds the first extension of the chosen kind
  std::vector<std::filesystem::path> recentFolders;
};

// A modal dialog. Marks: "files.field", "files.accept", "files.cancel", "files.up", "files.hidden",
// "files.kind", "files.replace", "files.keep", "files.new-folder", "files.sort.name" (.size,
// .date), "files.entry.NAME", "files.place.NAME".
class FileBrowser {
 public:
  // A picture for a file, or null while there is none; asked each frame for what is in sight.
  using Thumbnails = std::function<ImTextureID(const std::filesystem::path&)>;
  void setThumbnails(Thumbnails thumbnails) { thumbnails_ = std::move(thumbnails); }

  void open(FileQuestion question);
  bool isOpen() const { return open_ || opening_; }
  // A slow folder is being read: draw again soon.
  bool busy() const { return reading_.valid(); }

  // Once a frame, outside windows. The chosen path in the frame in which it was chosen; its bytes
  // are those of the file system. Saving over a file has been asked about, the extension is there.
  std::optional<std::filesystem::path> draw();

 private:
  void goTo(const std::filesystem::path& folder, bool remember = true);
  void takeListing();
  void refresh();
  FolderView view() const;
  void select(std::size_t row);
  void activate(std::size_t row);
  void accept();
  void acceptTyped(const std::filesystem::path& path);
  void makeFolder();

  void drawTop();
  void drawBreadcrumb(float width);
  void drawPlaces();
  void drawPlace(const char* label, int icon, const std::filesystem::path& folder);
  void drawEntries();
  void drawHeader();
  void drawRow(std::size_t row, float height);
  void drawField();
  void drawCompletions();
  void drawButtons();
  void drawReplaceQuestion();
  void takeKeys();

  FileQuestion question_;
  Thumbnails thumbnails_;
  bool opening_ = false, open_ = false, focusField_ = false, scroll_ = false, typed_ = false;
  bool showHidden_ = false, descending_ = false, close_ = false;
  FolderOrder order_ = FolderOrder::name;
  int kind_ = 0;

  std::filesystem::path folder_;
  std::vector<std::filesystem::path> back_;
  FolderListing listing_;
  std::future<FolderListing> reading_;
  std::vector<std::size_t> rows_;         // of listing_.entries, as shown
  std::optional<std::size_t> selected_;   // of rows_
  std::filesystem::path selectWhenRead_;  // after going up: where one came from

  std::string field_;  // the path typed, or the name of what is selected
  std::vector<std::string> completions_;
  std::string completedFor_;
  std::string error_;
  std::optional<std::filesystem::path> replacing_, result_;
  std::string jump_;  // letters typed in the list
  double jumpTime_ = 0;
};

}  // namespace dapple
