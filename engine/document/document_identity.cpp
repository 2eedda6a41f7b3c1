#include "document/document_identity.h"

namespace dapple {
namespace {

std::array<std::shared_ptr<const void>, 13> columnsOf(const Document& document) {
  const Results& r = document.results;
  return {document.scan, document.labels, document.regions, document.selection,
          r.source,      r.texel,         r.frame,          r.colour,
          r.state,       r.patch,         r.error,          r.order,
          r.border};
}

bool same(const std::weak_ptr<const void>& a, const std::shared_ptr<const void>& b) {
  return !a.owner_before(b) && !b.owner_before(a);
}

}  // namespace

DocumentIdentity::DocumentIdentity(const Document& document) {
  const auto columns = columnsOf(document);
  for (std::size_t k = 0; k < columns.size(); ++k) columns_[k] = columns[k];
}

bool DocumentIdentity::is(const Document& document) const {
  const auto columns = columnsOf(document);
  for (std::size_t k = 0; k < columns.size(); ++k)
    if (!same(columns_[k], columns[k])) return false;
  return true;
}

bool DocumentIdentity::sameScan(const Document& document) const {
  return same(columns_[0], document.scan);
}

}  // namespace dapple
