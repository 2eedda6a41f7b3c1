#include "document/edit_history.h"

#include "base/errors.h"

namespace dapple {

EditHistory::EditHistory(Document first, std::string label, std::size_t byteBudget)
    : byteBudget_(byteBudget) {
  hold(first);
  entries_.push_back({std::move(label), std::move(first)});
}

void EditHistory::hold(const Document& document) {
  for (const MemoryBlock& block : memoryBlocks(document)) {
    Held& held = held_[block.address];
    if (held.entries++ == 0) held.bytes = block.bytes, bytes_ += block.bytes;
  }
}

void EditHistory::release(const Document& document) {
  for (const MemoryBlock& block : memoryBlocks(document)) {
    const auto at = held_.find(block.address);
    if (--at->second.entries > 0) continue;
    bytes_ -= at->second.bytes;
    held_.erase(at);
  }
}

std::size_t EditHistory::presentBytes() const {
  std::size_t sum = 0;
  std::unordered_map<const void*, bool> seen;
  for (const MemoryBlock& block : memoryBlocks(document()))
    if (seen.emplace(block.address, true).second) sum += block.bytes;
  return sum;
}

void EditHistory::amend(Document document) {
  hold(document);
  release(entries_[cursor_].document);
  entries_[cursor_].document = std::move(document);
}

void EditHistory::push(std::string label, Document document, unsigned gesture) {
  while (entries_.size() > cursor_ + 1) {
    release(entries_.back().document);
    entries_.pop_back();
  }
  if (gesture != 0 && entries_.back().gesture == gesture) {
    entries_.back().label = std::move(label);
    return amend(std::move(document));
  }
  hold(document);
  entries_.push_back({std::move(label), std::move(document), gesture});
  ++cursor_;
  const std::size_t allowed = byteBudget_ + presentBytes();
  while (cursor_ > 0 && bytes_ > allowed) {
    release(entries_.front().document);
    entries_.pop_front();
    --cursor_;
    ++dropped_;
  }
}

const Document& EditHistory::undo() {
  if (cursor_ == 0)
    throw InvalidInput(dropped_ > 0 ? "there is nothing more to undo: older steps were dropped to "
                                      "stay within the memory for undo"
                                    : "there is nothing to undo");
  return goTo(cursor_ - 1);
}

const Document& EditHistory::redo() {
  if (cursor_ + 1 == entries_.size()) throw InvalidInput("there is nothing to redo");
  return goTo(cursor_ + 1);
}

const Document& EditHistory::goTo(std::size_t entry) {
  if (entry >= entries_.size())
    throw InvalidInput(
        fmt::format("there is no step {} in a history of {}", entry + 1, entries_.size()));
  cursor_ = entry;
  return document();
}

}  // namespace dapple
