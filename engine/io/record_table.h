// Everything that a scan's file held, as it was: so that a textured scan keeps what we do not know.
#pragma once

#include <span>
#include <string>
#include <string_view>
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
  std::vector<std::string> comments;  // one line each, without the keyword
  std::vector<std::string> objInfo;   // PLY's obj_info lines, likewise
  std::vector<Element> elements;

  const Element* find(std::string_view element) const;
  Element* find(std::string_view element);
};

// The values [begin, begin + out.size()) of a column, converted.
void readValues(const Property& property, std::size_t begin, std::span<double> out);

// A new column of element.count values; replaces one of the same name in place.
void setColumn(Element& element, std::string name, std::span<const float> values);
void setColumn(Element& element, std::string name, std::span<const double> values);
void setColumn(Element& element, std::string name, std::span<const std::uint8_t> values);
void setColumn(Element& element, std::string name, std::span<const std::int32_t> values);

}  // namespace dapple
