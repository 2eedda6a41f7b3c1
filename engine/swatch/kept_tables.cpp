#include "swatch/kept_tables.h"

#include <algorithm>

namespace dapple {

KeptTables& KeptTables::operator=(const KeptTables& other) noexcept {
  if (this == &other) return *this;
  const std::lock_guard lock(mutex_);
  tables_.clear();
  bytes_ = 0;
  return *this;
}

std::size_t KeptTables::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

KeptTables::Table KeptTables::find(const Key& key) const {
  const std::lock_guard lock(mutex_);
  return findLocked(key);
}

KeptTables::Table KeptTables::findLocked(const Key& key) const {
  const auto at = std::find_if(tables_.begin(), tables_.end(),
                               [&](const auto& table) { return table.first == key; });
  return at == tables_.end() ? nullptr : at->second;
}

KeptTables::Table KeptTables::keep(const Key& key, Table made, std::size_t bytes) const {
  const std::lock_guard lock(mutex_);
  if (Table first = findLocked(key)) return first;
  if (bytes > kMostBytes - bytes_) return made;
  tables_.emplace_back(key, made);
  bytes_ += bytes;
  return made;
}

}  // namespace dapple
