// Columns of values to and from the elements of a project file.
#pragma once

#include <cstring>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#include "base/errors.h"
#include "io/record_table.h"

namespace dapple::project {

template <class T>
constexpr ScalarType scalarOf() {
  if constexpr (std::is_same_v<T, float>) return ScalarType::Float32;
  if constexpr (std::is_same_v<T, std::uint8_t>) return ScalarType::UInt8;
  if constexpr (std::is_same_v<T, std::uint16_t>) return ScalarType::UInt16;
  if constexpr (std::is_same_v<T, std::uint32_t>) return ScalarType::UInt32;
}

template <class T>
std::vector<std::byte> asBytes(const std::vector<T>& values) {
  std::vector<std::byte> bytes(values.size() * sizeof(T));
  if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

// Columns of the scalars T that make up each element of a structure column.
template <class T, class Value>
void add(Element& element, std::initializer_list<const char*> names,
         const std::vector<Value>& column) {
  static_assert(sizeof(Value) % sizeof(T) == 0 && std::is_trivially_copyable_v<Value>);
  const std::size_t width = sizeof(Value) / sizeof(T);
  DAPPLE_CHECK(names.size(), ==, width);
  std::size_t c = 0;
  for (const char* name : names) {
    Property property{.name = name, .type = scalarOf<T>()};
    property.values.resize(column.size() * sizeof(T));
    const auto* from = reinterpret_cast<const std::byte*>(column.data()) + c * sizeof(T);
    for (std::size_t i = 0; i < column.size(); ++i)
      std::memcpy(property.values.data() + i * sizeof(T), from + i * sizeof(Value), sizeof(T));
    element.properties.push_back(std::move(property));
    ++c;
  }
  element.count = column.size();
}

template <class T>
void addLists(Element& element, const char* name, const std::vector<std::vector<T>>& lists) {
  Property property{.name = name,
                    .type = scalarOf<T>(),
                    .isList = true,
                    .countType = ScalarType::UInt32,
                    .listOffsets = {0}};
  for (const std::vector<T>& list : lists) {
    const std::vector<std::byte> bytes = asBytes(list);
    property.values.insert(property.values.end(), bytes.begin(), bytes.end());
    property.listOffsets.push_back(property.listOffsets.back() + list.size());
  }
  element.properties.push_back(std::move(property));
  element.count = lists.size();
}

[[noreturn]] inline void refuse(const std::string& file, const std::string& what) {
  throw InvalidInput(fmt::format(
      "{}: {}. The project is damaged or not Dapple's; take an older copy of it.", file, what));
}

// Reads what add() and addLists() wrote.
class Columns {
 public:
  Columns(const std::string& file, const RecordTable& table, const char* element)
      : file_(file), name_(element), element_(table.find(element)) {}

  bool exists() const { return element_ != nullptr; }
  std::size_t count() const { return element_ ? element_->count : 0; }

  bool has(const char* column) const { return element_ && element_->find(column); }

  template <class T, class Value>
  std::shared_ptr<const std::vector<Value>> read(std::initializer_list<const char*> names) const {
    std::vector<Value> out(count());
    std::size_t c = 0;
    for (const char* name : names) {
      const Property& property = find(name, scalarOf<T>(), false);
      auto* to = reinterpret_cast<std::byte*>(out.data()) + c++ * sizeof(T);
      for (std::size_t i = 0; i < out.size(); ++i)
        std::memcpy(to + i * sizeof(Value), property.values.data() + i * sizeof(T), sizeof(T));
    }
    return std::make_shared<const std::vector<Value>>(std::move(out));
  }

  template <class T, class Value>
  std::vector<std::vector<Value>> lists(const char* name) const {
    const Property& property = find(name, scalarOf<T>(), true);
    const std::size_t width = sizeof(Value) / sizeof(T);
    std::vector<std::vector<Value>> out(count());
    for (std::size_t i = 0; i < out.size(); ++i) {
      const std::size_t begin = property.listOffsets[i], end = property.listOffsets[i + 1];
      if ((end - begin) % width != 0)
        refuse(file_,
               fmt::format("{} {} has a list '{}' of {} numbers", name_, i, name, end - begin));
      out[i].resize((end - begin) / width);
      if (end > begin)
        std::memcpy(out[i].data(), property.values.data() + begin * sizeof(T),
                    (end - begin) * sizeof(T));
    }
    return out;
  }

 private:
  const Property& find(const char* name, ScalarType type, bool isList) const {
    const Property* property = element_ ? element_->find(name) : nullptr;
    if (!property || property->type != type || property->isList != isList)
      refuse(file_, fmt::format("element '{}' has no column '{}' of the right type", name_, name));
    return *property;
  }

  const std::string& file_;
  const char* name_;
  const Element* element_;
};

}  // namespace dapple::project
