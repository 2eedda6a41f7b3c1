// What can be undone: a document after each edit. Documents share what did not change.
#pragma once

#include <deque>
#include <string>
#include <unordered_map>

#include "document/document.h"

namespace dapple {

class EditHistory {
 public:
  // Of bytes beyond the present document's; older entries go first, the present one never.
  explicit EditHistory(Document first, std::string label = "New",
                       std::size_t byteBudget = std::size_t{1} << 30);

  const Document& document() const { return entries_[cursor_].document; }
  std::size_t cursor() const { return cursor_; }
  std::size_t size() const { return entries_.size(); }
  const std::string& label(std::size_t entry) const { return entries_[entry].label; }
  std::size_t dropped() const { return dropped_; }  // entries, for want of bytes
  std::size_t bytes() const { return bytes_; }      // of all entries together

  // A new present; what was undone is gone. Edits of one gesture (not 0) right after each other are
  // one entry.
  void push(std::string label, Document document, unsigned gesture = 0);
  // Another document in the present entry: what followed from it by itself.
  void amend(Document document);

  // Throw InvalidInput when there is nothing to undo, to redo, or no such entry.
  const Document& undo();
  const Document& redo();
  const Document& goTo(std::size_t entry);

 private:
  struct Entry {
    std::string label;
    Document document;
    unsigned gesture = 0;
  };
  void hold(const Document& document);
  void release(const Document& document);
  std::size_t presentBytes() const;

  std::deque<Entry> entries_;
  std::size_t cursor_ = 0, dropped_ = 0, byteBudget_, bytes_ = 0;
  // How many entries hold each block.
  struct Held {
    std::size_t entries = 0, bytes = 0;
  };
  std::unordered_map<const void*, Held> held_;
};

}  // namespace dapple
