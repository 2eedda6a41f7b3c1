// Work that no file has yet: told in the title, asked about before it would be lost, and kept for
// the case that the program is not asked.
#include <fmt/format.h>

#include <algorithm>

#include "app/editor/editor_memory.h"
#include "io/image_io.h"

namespace dapple {
namespace {

namespace fs = std::filesystem;

const std::string& lastEdit(const Snapshot& snapshot) {
  return (*snapshot.history)[std::min(snapshot.cursor, snapshot.history->size() - 1)];
}

std::string nameOf(const std::string& project, const Document& document) {
  if (!project.empty()) return fs::path(project).stem().string();
  return document.scan ? fs::path(document.scan->path).filename().string() : std::string();
}

}  // namespace

bool Editor::Memory::unsaved() const {
  return unsavedWork(editor.snapshot_->document);
}

std::string Editor::title() const {
  const std::string name = nameOf(project_, snapshot_->document);
  std::string title;
  if (working())
    title += fmt::format("{:.0f} % - ", 100 * std::clamp(status_.progress.fraction, 0.0, 1.0));
  if (!name.empty()) title += (memory_->unsaved() ? "\u2022 " : "") + name + " - ";
  return title + "Dapple";
}

bool Editor::mayClose() {
  if (!close_ && !memory_->isAsking() && !browser_.isOpen())
    memory_->guarded([this] { close_ = true; });
  return close_;
}

bool Editor::waiting() const {
  return memory_->dialog.isOpen() || memory_->looking.valid();
}

bool Editor::Memory::isAsking() const {
  return questions.isOpen() || dialog.isOpen();
}

void Editor::Memory::guarded(std::function<void()> then) {
  // What was submitted a moment ago counts, too.
  if (!unsavedWork(editor.engine_.snapshot()->document)) return then();
  if (questions.isOpen()) return;
  const auto answered = [this, then = std::move(then)](Answer answer) {
    if (answer == Answer::no) then();
    if (answer != Answer::yes) return;
    editor.actions_.run("file.save");
    afterSave = then;
  };
  questions.ask({.title = fmt::format("Save the changes to {}?",
                                      nameOf(editor.project_, editor.snapshot_->document)),
                 .text = fmt::format("The last one was: {}. What is not saved will be lost.",
                                     lastEdit(*editor.snapshot_)),
                 .yes = "Save",
                 .no = "Don't save",
                 .answered = answered});
}

void Editor::Memory::openAll(const std::vector<fs::path>& paths, std::optional<RegionId> under) {
  std::vector<fs::path> documents, images;
  for (const fs::path& path : paths)
    (isImageFile(path) || fs::is_directory(path) ? images : documents).push_back(path);
  const auto swatches = [this, images] {
    for (const fs::path& path : images)
      fs::is_directory(path) ? editor.openFolder(path) : editor.openImage(path);
  };
  if (documents.empty()) {
    if (under) editor.choose(*under);  // an image is for what it is dropped on
    return swatches();
  }
  // What is open first, so that the swatches are for it; and one question for all.
  guarded([this, documents, swatches] {
    for (const fs::path& path : documents) editor.openDocument(path);
    swatches();
  });
}

void Editor::openSample() {
  memory_->guarded([this] { openSampleNow(); });
}

void Editor::Memory::recover(const RecoveryEntry& entry) {
  guarded([this, entry] {
    // First the mark: if opening it ends the program, it is not offered again.
    markTried(entry, true);
    recovering = entry;
    editor.engine_.submit(OpenProject{entry.file.string(), {}});
  });
}

// What the engine has opened or saved.
void Editor::Memory::followFile() {
  const bool busy = editor.engine_.status().busy;
  const bool settled = !busy && editor.engine_.snapshot() == editor.snapshot_;  // in this order
  if (editor.snapshot_->file && editor.snapshot_->file != seen) {
    seen = editor.snapshot_->file;
    const DocumentFile& file = *seen;
    if (recovering && file.project == recovering->file.string()) {
      markTried(*recovering, false);
      knownFiles.noteRecovered(file, recovering->project);
      std::erase_if(offered, [&](const auto& each) { return each.file == recovering->file; });
      recovered.push_back(*std::exchange(recovering, {}));
      editor.notices_.good("The unsaved work is back. Save it to keep it.");
    } else {
      knownFiles.note(file);
      if (!file.project.empty())
        settings.opened(fs::absolute(file.project));
      else if (file.document.sameScan(editor.snapshot_->document))
        settings.opened(editor.snapshot_->document.scan->path);
    }
  }
  if (recovering && settled) {  // it could not be opened, and that is told
    markTried(*recovering, false);
    recovering.reset();
  }
  editor.project_ = knownFiles.project(editor.snapshot_->document);
  if (!afterSave) return;
  if (!unsaved())
    std::exchange(afterSave, {})();
  else if (settled && !editor.browser_.isOpen() && !isAsking())
    afterSave = {};  // given up, or failed
}

void Editor::Memory::followRecovery() {
  const Document& document = editor.snapshot_->document;
  const auto dropRecovered = [this] {
    for (const RecoveryEntry& entry : recovered) discardRecovery(entry);
    recovered.clear();
  };
  const bool clean = !unsaved();
  if (!followed.is(document) || (clean && !followedClean)) {
    followed = DocumentIdentity(document);
    followedClean = clean;
    if (clean)
      autosave.forget();
    else
      autosave.follow({document, editor.project_, lastEdit(*editor.snapshot_)});
  }
  if (!recovered.empty() && (clean || autosave.written() > 0)) dropRecovered();
  if (const auto error = autosave.takeError()) editor.notices_.warn(*error);
}

void Editor::Memory::leave() {
  if (windowWidth > 0) {
    settings.windowWidth = windowWidth, settings.windowHeight = windowHeight;
    if (settings != saved) settingsFile.write(settings);
  }
  // Anything else than the user's own going leaves the copy for the next time.
  if (!editor.close_ && unsavedWork(editor.engine_.snapshot()->document)) return;
  autosave.forget();
  for (const RecoveryEntry& entry : recovered) discardRecovery(entry);
}

}  // namespace dapple
