// Everything that a scan's file held, as it was: so that a textured scan keeps what we do not know.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/types.h"

namespace dapple {

enum class ScalarType { Int8, UInt8, Int16, UInt16, Int32, UInt32, Float32, Float64 };
std::size_t scalarSize(ScalarType type);

// A column of an element: `count` scalars, or `count` lists of them.
struct Property {
  std::string name;
  ScalarType type = ScalarType::Float32;
  bool isList = false;
  ScalarType countType = ScalarType::UInt8;  // of a list's length, as in the file
  std::vector<std::byte> values;             // host byte order
  std::vector<std::size_t> listOffsets;      // lists: count + 1 offsets, in scalars

  double at(std::size_t scalar) const;  // value converted; scalar counts through all lists
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;

  const Property* find(std::string_view property) const;
};

struct RecordTable {
  std::vector<std::string> comments;
  std::vector<Element> elements;

  const Element* find(std::string_view element) const;
  Element* find(std::string_view element);
};

// A new column of floats or bytes for `element`; replaces one of the same name in place.
void setColumn(Element& element, std::string name, std::span<const float> values);
void setColumn(Element& element, std::string name, std::span<const std::uint8_t> values);
void setColumn(Element& element, std::string name, std::span<const std::int32_t> values);

}  // namespace dapple
