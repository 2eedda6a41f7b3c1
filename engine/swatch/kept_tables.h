// What follows from a value alone and takes long to find: made when first asked for, and kept
// beside the value for as long as that lives.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <typeindex>
#include <utility>
#include <vector>

namespace dapple {

// May be asked by many threads at once. A copy, or what is moved to, begins with nothing: it may be
// changed, and tables of what it was would be wrong.
class KeptTables {
 public:
  // Of all tables together; further ones are made anew every time.
  static constexpr std::size_t kMostBytes = std::size_t{64} << 20;

  KeptTables() = default;
  ~KeptTables() = default;
  KeptTables(const KeptTables&) noexcept {}
  KeptTables& operator=(const KeptTables& other) noexcept;

  // The table of type T and this number that is kept, or null.
  template <class T>
  std::shared_ptr<const T> find(std::uint64_t number) const {
    return std::static_pointer_cast<const T>(find({typeid(T), number}));
  }
  // That, or what make() returns: a T with a member bytes(). What make() throws is thrown on.
  template <class T, class Make>
  std::shared_ptr<const T> get(std::uint64_t number, const Make& make) const {
    if (auto kept = find<T>(number)) return kept;
    const auto made = std::make_shared<const T>(make());
    return std::static_pointer_cast<const T>(keep({typeid(T), number}, made, made->bytes()));
  }

  std::size_t bytes() const;  // of the tables that are kept

 private:
  using Key = std::pair<std::type_index, std::uint64_t>;
  using Table = std::shared_ptr<const void>;

  Table find(const Key& key) const;
  Table findLocked(const Key& key) const;
  // Of tables that were made at the same time the first one is kept by all.
  Table keep(const Key& key, Table made, std::size_t bytes) const;

  mutable std::mutex mutex_;
  mutable std::vector<std::pair<Key, Table>> tables_;
  mutable std::size_t bytes_ = 0;
};

}  // namespace dapple
