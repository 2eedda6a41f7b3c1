// Which documents are as a file has them: what is unsaved, and where it is saved.
#pragma once

#include <string>
#include <vector>

#include "document/engine.h"

namespace dapple {

// Also for documents that undo brings back from before another scan was opened.
class KnownFiles {
 public:
  // The document was opened or saved.
  void note(const DocumentFile& file) { add({file.document, file.project}); }
  // It was opened from a copy of unsaved work, which was saved as `project` before.
  void noteRecovered(const DocumentFile& file, const std::string& project) {
    add({file.document, project, true});
  }

  bool unsaved(const Document& document) const;
  // Empty: never saved.
  std::string project(const Document& document) const;

 private:
  struct Entry {
    DocumentIdentity document;
    std::string project;
    bool recovered = false;
  };
  void add(Entry entry);
  const Entry* find(const Document& document) const;

  std::vector<Entry> entries_;  // of one scan the last counts
};

}  // namespace dapple
