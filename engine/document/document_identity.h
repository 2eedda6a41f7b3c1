// Which document it is, without keeping its columns in memory.
#pragma once

#include <array>
#include <memory>

#include "document/document.h"

namespace dapple {

class DocumentIdentity {
 public:
  DocumentIdentity() = default;  // of the document that has no column
  explicit DocumentIdentity(const Document& document);

  // It shares every column with that document: nothing was edited, or all of it undone.
  bool is(const Document& document) const;
  bool sameScan(const Document& document) const;

 private:
  // A weak pointer keeps the address from being used again.
  std::array<std::weak_ptr<const void>, 13> columns_;
};

}  // namespace dapple
