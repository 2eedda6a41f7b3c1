#include "app/editor/known_files.h"

namespace dapple {
namespace {

constexpr std::size_t kMost = 64;

}  // namespace

void KnownFiles::add(Entry entry) {
  if (entries_.size() == kMost) entries_.erase(entries_.begin());
  entries_.push_back(std::move(entry));
}

const KnownFiles::Entry* KnownFiles::find(const Document& document) const {
  for (auto entry = entries_.rbegin(); entry != entries_.rend(); ++entry)
    if (entry->document.sameScan(document)) return &*entry;
  return nullptr;
}

bool KnownFiles::unsaved(const Document& document) const {
  if (!document.scan) return false;
  const Entry* entry = find(document);
  return !entry || entry->recovered || !entry->document.is(document);
}

std::string KnownFiles::project(const Document& document) const {
  const Entry* entry = document.scan ? find(document) : nullptr;
  return entry ? entry->project : std::string();
}

}  // namespace dapple
