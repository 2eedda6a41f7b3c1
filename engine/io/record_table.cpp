#include "io/record_table.h"

#include <algorithm>
#include <cstring>

#include "base/errors.h"

namespace dapple {
namespace {

template <class T>
T load(const Property& property, std::size_t scalar) {
  T value;
  std::memcpy(&value, property.values.data() + scalar * sizeof(T), sizeof(T));
  return value;
}

template <class T>
void convert(const Property& property, std::size_t begin, std::span<double> out) {
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = static_cast<double>(load<T>(property, begin + i));
}

template <class T>
void putColumn(Element& element, std::string name, ScalarType type, std::span<const T> values) {
  DAPPLE_CHECK(values.size(), ==, element.count);
  Property column{.name = std::move(name), .type = type};
  column.values.resize(values.size_bytes());
  if (!values.empty()) std::memcpy(column.values.data(), values.data(), values.size_bytes());
  const auto old = std::find_if(element.properties.begin(), element.properties.end(),
                                [&](const Property& p) { return p.name == column.name; });
  if (old != element.properties.end())
    *old = std::move(column);
  else
    element.properties.push_back(std::move(column));
}

}  // namespace

std::size_t scalarSize(ScalarType type) {
  switch (type) {
    case ScalarType::Int8:
    case ScalarType::UInt8:
      return 1;
    case ScalarType::Int16:
    case ScalarType::UInt16:
      return 2;
    case ScalarType::Int32:
    case ScalarType::UInt32:
    case ScalarType::Float32:
      return 4;
    case ScalarType::Float64:
      return 8;
  }
  throw Bug("a scalar type without a size");
}

void readValues(const Property& property, std::size_t begin, std::span<double> out) {
  DAPPLE_CHECK((begin + out.size()) * scalarSize(property.type), <=, property.values.size());
  switch (property.type) {
    case ScalarType::Int8:
      return convert<std::int8_t>(property, begin, out);
    case ScalarType::UInt8:
      return convert<std::uint8_t>(property, begin, out);
    case ScalarType::Int16:
      return convert<std::int16_t>(property, begin, out);
    case ScalarType::UInt16:
      return convert<std::uint16_t>(property, begin, out);
    case ScalarType::Int32:
      return convert<std::int32_t>(property, begin, out);
    case ScalarType::UInt32:
      return convert<std::uint32_t>(property, begin, out);
    case ScalarType::Float32:
      return convert<float>(property, begin, out);
    case ScalarType::Float64:
      return convert<double>(property, begin, out);
  }
}

double Property::at(std::size_t scalar) const {
  double value = 0;
  readValues(*this, scalar, {&value, 1});
  return value;
}

const Property* Element::find(std::string_view property) const {
  for (const Property& p : properties)
    if (p.name == property) return &p;
  return nullptr;
}

const Element* RecordTable::find(std::string_view element) const {
  for (const Element& e : elements)
    if (e.name == element) return &e;
  return nullptr;
}

Element* RecordTable::find(std::string_view element) {
  for (Element& e : elements)
    if (e.name == element) return &e;
  return nullptr;
}

void setColumn(Element& element, std::string name, std::span<const float> values) {
  putColumn(element, std::move(name), ScalarType::Float32, values);
}

void setColumn(Element& element, std::string name, std::span<const double> values) {
  putColumn(element, std::move(name), ScalarType::Float64, values);
}

void setColumn(Element& element, std::string name, std::span<const std::uint8_t> values) {
  putColumn(element, std::move(name), ScalarType::UInt8, values);
}

void setColumn(Element& element, std::string name, std::span<const std::int32_t> values) {
  putColumn(element, std::move(name), ScalarType::Int32, values);
}

}  // namespace dapple
