#include <bit>
#include <charconv>
#include <cstring>
#include <limits>

#include "base/errors.h"
#include "io/ply.h"
#include "io/ply_header.h"

namespace dapple {
namespace {

static_assert(std::endian::native == std::endian::little, "the writer copies host bytes");

constexpr std::size_t kBlock = 256 << 10;

void checkColumns(const Element& element) {
  for (const Property& p : element.properties) {
    const std::size_t size = scalarSize(p.type);
    if (p.isList) {
      DAPPLE_CHECK(p.listOffsets.size(), ==, element.count + 1);
      DAPPLE_CHECK(p.values.size(), ==, p.listOffsets.back() * size);
    } else {
      DAPPLE_CHECK(p.values.size(), ==, element.count * size);
    }
  }
}

std::uint64_t longestList(ScalarType countType) {
  const std::size_t bits = 8 * scalarSize(countType);
  const bool isSigned = countType == ScalarType::Int8 || countType == ScalarType::Int16 ||
                        countType == ScalarType::Int32;
  return (std::uint64_t{1} << (isSigned ? bits - 1 : bits)) - 1;
}

std::size_t listLength(const Property& p, std::size_t record) {
  const std::size_t length = p.listOffsets[record + 1] - p.listOffsets[record];
  DAPPLE_CHECK(length, <=, longestList(p.countType));
  return length;
}

void putBytes(std::string& out, const void* bytes, std::size_t count) {
  out.append(static_cast<const char*>(bytes), count);
}

void putBinary(std::string& out, const Property& p, std::size_t record) {
  const std::size_t size = scalarSize(p.type);
  if (!p.isList) return putBytes(out, p.values.data() + record * size, size);
  const std::uint64_t length = listLength(p, record);
  putBytes(out, &length, scalarSize(p.countType));
  putBytes(out, p.values.data() + p.listOffsets[record] * size, length * size);
}

template <class T>
void putNumber(std::string& out, const Property& p, std::size_t scalar) {
  T value;
  std::memcpy(&value, p.values.data() + scalar * sizeof(T), sizeof(T));
  char text[64];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value);
  DAPPLE_CHECK(error == std::errc(), ==, true);
  out.append(text, end);
  out += ' ';
}

void putScalar(std::string& out, const Property& p, std::size_t scalar) {
  switch (p.type) {
    case ScalarType::Int8:
      return putNumber<std::int8_t>(out, p, scalar);
    case ScalarType::UInt8:
      return putNumber<std::uint8_t>(out, p, scalar);
    case ScalarType::Int16:
      return putNumber<std::int16_t>(out, p, scalar);
    case ScalarType::UInt16:
      return putNumber<std::uint16_t>(out, p, scalar);
    case ScalarType::Int32:
      return putNumber<std::int32_t>(out, p, scalar);
    case ScalarType::UInt32:
      return putNumber<std::uint32_t>(out, p, scalar);
    case ScalarType::Float32:
      return putNumber<float>(out, p, scalar);
    case ScalarType::Float64:
      return putNumber<double>(out, p, scalar);
  }
}

void putAscii(std::string& out, const Property& p, std::size_t record) {
  if (!p.isList) return putScalar(out, p, record);
  out += std::to_string(listLength(p, record)) + " ";
  for (std::size_t k = p.listOffsets[record]; k < p.listOffsets[record + 1]; ++k)
    putScalar(out, p, k);
}

void writeElement(OutputFile& file, const Element& element, bool ascii, Monitor& monitor) {
  std::string block;
  std::size_t counted = 0;
  const auto flush = [&](std::size_t records) {
    file.write(block.data(), block.size());
    monitor.advance(records - counted);
    counted = records;
    block.clear();
  };
  for (std::size_t r = 0; r < element.count; ++r) {
    for (const Property& p : element.properties)
      ascii ? putAscii(block, p, r) : putBinary(block, p, r);
    if (ascii) block.back() = '\n';
    if (block.size() >= kBlock) flush(r + 1);
  }
  flush(element.count);
}

}  // namespace

void writePly(OutputFile& file, const RecordTable& table, bool ascii, Monitor& monitor) {
  const std::string header =
      writePlyHeader(table, ascii ? PlyFormat::Ascii : PlyFormat::LittleEndian);
  file.write(header.data(), header.size());
  for (const Element& element : table.elements) {
    checkColumns(element);
    if (!element.properties.empty()) writeElement(file, element, ascii, monitor);
  }
}

}  // namespace dapple
