#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/errors.h"
#include "io/ply.h"
#include "io/ply_header.h"
#include "io/text_numbers.h"

namespace dapple {
namespace {

constexpr std::size_t kBlock = 256 << 10;
constexpr std::size_t kLongestToken = 512;
constexpr const char* kExportAgain = "Export or copy the file again.";

template <class F>
decltype(auto) withType(ScalarType type, F&& call) {
  switch (type) {
    case ScalarType::Int8:
      return call(std::int8_t{});
    case ScalarType::UInt8:
      return call(std::uint8_t{});
    case ScalarType::Int16:
      return call(std::int16_t{});
    case ScalarType::UInt16:
      return call(std::uint16_t{});
    case ScalarType::Int32:
      return call(std::int32_t{});
    case ScalarType::UInt32:
      return call(std::uint32_t{});
    case ScalarType::Float32:
      return call(float{});
    case ScalarType::Float64:
      return call(double{});
  }
  throw Bug("an unknown scalar type");
}

void swapBytes(std::byte* values, std::size_t count, std::size_t size) {
  if (size == 1) return;
  for (std::size_t i = 0; i < count; ++i) std::reverse(values + i * size, values + (i + 1) * size);
}

std::size_t smallestRecord(const Element& element) {
  std::size_t bytes = 0;
  for (const Property& p : element.properties) bytes += scalarSize(p.isList ? p.countType : p.type);
  return bytes;
}

// A count is believed when its records fit into what is left of the file, and only then is
// memory taken for them.
void checkCount(const Element& element, PlyFormat format, const InputFile& file) {
  const std::size_t properties = element.properties.size();
  if (properties == 0) return;
  const std::size_t fit = format == PlyFormat::Ascii ? (file.remaining() + 1) / (2 * properties)
                                                     : file.remaining() / smallestRecord(element);
  std::string cause, remedy;
  if (element.count > fit) {
    cause = fmt::format(
        "the header declares {} records of element {}, but the {} bytes left hold at most {}",
        element.count, element.name, file.remaining(), fit);
    remedy = "The file is cut off or damaged. " + std::string(kExportAgain);
  } else if (element.count >= kNone) {
    cause = fmt::format("{} records of element {} are more than the {} that Dapple works with",
                        element.count, element.name, kNone - 1);
    remedy = "Split the scan.";
  }
  if (!cause.empty() && format == PlyFormat::Ascii) file.failAtLine(cause, remedy);
  if (!cause.empty()) file.failAtByte(cause, remedy);
}

void prepareColumns(Element& element) {
  for (Property& p : element.properties) {
    if (p.isList) {
      p.listOffsets.reserve(element.count + 1);
      p.listOffsets.push_back(0);
    } else {
      p.values.resize(element.count * scalarSize(p.type));
    }
  }
}

// ---- binary ----

template <std::size_t Size>
void scatter(const char* from, std::size_t stride, std::size_t count, std::byte* to) {
  for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * Size, from + i * stride, Size);
}

void scatterColumn(const char* from, std::size_t stride, std::size_t count, std::byte* to,
                   std::size_t size) {
  if (size == 1) return scatter<1>(from, stride, count, to);
  if (size == 2) return scatter<2>(from, stride, count, to);
  if (size == 4) return scatter<4>(from, stride, count, to);
  return scatter<8>(from, stride, count, to);
}

class BinaryBody {
 public:
  BinaryBody(InputFile& file, PlyFormat format)
      : file_(file),
        swap_((format == PlyFormat::LittleEndian) != (std::endian::native == std::endian::little)) {
  }

  void read(Element& element) {
    const bool fixed = std::none_of(element.properties.begin(), element.properties.end(),
                                    [](const Property& p) { return p.isList; });
    if (fixed)
      readFixed(element);
    else
      for (std::size_t i = 0; i < element.count; ++i) readRecord(element, i);
  }

 private:
  void readFixed(Element& element) {
    const std::size_t stride = smallestRecord(element);
    if (stride == 0) return;
    const std::size_t block = std::max<std::size_t>(1, kBlock / stride);
    for (std::size_t i = 0; i < element.count; i += block) {
      const std::size_t count = std::min(block, element.count - i);
      const char* record = file_.peek(count * stride).data();
      for (Property& p : element.properties) {
        const std::size_t size = scalarSize(p.type);
        std::byte* column = p.values.data() + i * size;
        scatterColumn(record, stride, count, column, size);
        if (swap_) swapBytes(column, count, size);
        record += size;
      }
      file_.skip(count * stride);
    }
  }

  void readRecord(Element& element, std::size_t i) {
    for (Property& p : element.properties) {
      const std::size_t size = scalarSize(p.type);
      if (p.isList) {
        const std::size_t length = readLength(element, p, i);
        append(p.values, length * size);
        if (swap_) swapBytes(p.values.data() + p.listOffsets.back() * size, length, size);
        p.listOffsets.push_back(p.listOffsets.back() + length);
      } else {
        need(element, i, size);
        std::memcpy(p.values.data() + i * size, file_.peek(size).data(), size);
        if (swap_) swapBytes(p.values.data() + i * size, 1, size);
        file_.skip(size);
      }
    }
  }

  void need(const Element& element, std::size_t i, std::size_t bytes) {
    if (bytes > file_.remaining())
      file_.failAtByte(fmt::format("the file ends in record {} of {} of element {}", i + 1,
                                   element.count, element.name),
                       kExportAgain);
  }

  std::size_t readLength(const Element& element, const Property& p, std::size_t i) {
    const std::size_t size = scalarSize(p.countType);
    need(element, i, size);
    std::byte raw[8];
    std::memcpy(raw, file_.peek(size).data(), size);
    if (swap_) swapBytes(raw, 1, size);
    const std::int64_t length = withType(p.countType, [&](auto zero) {
      std::memcpy(&zero, raw, sizeof zero);
      return static_cast<std::int64_t>(zero);
    });
    const std::size_t fit = (file_.remaining() - size) / scalarSize(p.type);
    if (length < 0 || static_cast<std::size_t>(length) > fit)
      file_.failAtByte(fmt::format("list {} of record {} of element {} claims {} values, but only "
                                   "{} fit into the rest of the file",
                                   p.name, i + 1, element.name, length, fit),
                       kExportAgain);
    file_.skip(size);
    return static_cast<std::size_t>(length);
  }

  void append(std::vector<std::byte>& values, std::size_t bytes) {
    while (bytes > 0) {
      const std::string_view view = file_.peek(std::min(bytes, kBlock));
      const std::size_t part = std::min(bytes, view.size());
      const auto* data = reinterpret_cast<const std::byte*>(view.data());
      values.insert(values.end(), data, data + part);
      file_.skip(part);
      bytes -= part;
    }
  }

  InputFile& file_;
  bool swap_;
};

// ---- ascii ----

// One record a line; a record may go on in the next line (some writers wrap long lists), but the
// next record begins on a line of its own, so that a missing value cannot shift all that follow.
class AsciiBody {
 public:
  explicit AsciiBody(InputFile& file) : file_(file), line_(file.lineNumber() + 1) { refill(); }

  void read(Element& element) {
    if (element.properties.empty()) return;
    file_.skip(at_);
    refill();
    checkCount(element, PlyFormat::Ascii, file_);
    prepareColumns(element);
    for (std::size_t i = 0; i < element.count; ++i) {
      for (Property& p : element.properties) readProperty(element, p, i);
      endRecord(element, i);
    }
  }

 private:
  void readProperty(const Element& element, Property& p, std::size_t i) {
    if (!p.isList)
      return withType(p.type, [&](auto value) {
        readScalar(p, token(element, i), value);
        std::memcpy(p.values.data() + i * sizeof value, &value, sizeof value);
      });
    const std::size_t length = withType(p.countType, [&](auto value) {
      readScalar(p, token(element, i), value);
      if (value < decltype(value){0}) fail(fmt::format("list {} has a negative length", p.name));
      return static_cast<std::size_t>(value);
    });
    file_.skip(at_);
    refill();
    if (length > (file_.remaining() + 1) / 2)
      fail(fmt::format("list {} claims {} values, but only {} bytes are left", p.name, length,
                       file_.remaining()));
    withType(p.type, [&](auto value) {
      const auto* bytes = reinterpret_cast<const std::byte*>(&value);
      for (std::size_t k = 0; k < length; ++k) {
        readScalar(p, token(element, i), value);
        p.values.insert(p.values.end(), bytes, bytes + sizeof value);
      }
    });
    p.listOffsets.push_back(p.listOffsets.back() + length);
  }

  template <class T>
  void readScalar(const Property& p, std::string_view text, T& value) {
    if constexpr (std::is_floating_point_v<T>) {
      if (!parseNumber(text, value)) failNumber(p, text);
    } else {
      const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
      if (error == std::errc() && stop == text.data() + text.size()) return;
      double real = 0;  // "255.0", "1e3" and "+1" are integers too
      if (!parseNumber(text, real)) failNumber(p, text);
      const bool fits = real >= static_cast<double>(std::numeric_limits<T>::min()) &&
                        real <= static_cast<double>(std::numeric_limits<T>::max());
      if (!fits || real != std::floor(real))
        fail(fmt::format("{} does not fit the integer type of property {}", text, p.name));
      value = static_cast<T>(real);
    }
  }

  // The next number of the record.
  std::string_view token(const Element& element, std::size_t i) {
    for (;;) {
      if (view_.size() - at_ < kLongestToken && view_.size() < file_.remaining()) {
        file_.skip(at_);
        refill();
      }
      while (at_ < view_.size() && isBlank(view_[at_])) {
        line_ += view_[at_] == '\n';
        ++at_;
      }
      if (at_ == view_.size() && at_ == file_.remaining())
        fail(fmt::format("the file ends in record {} of {} of element {}", i + 1, element.count,
                         element.name));
      std::size_t end = at_;
      while (end < view_.size() && !isBlank(view_[end])) ++end;
      if (end < view_.size() || end == file_.remaining()) {
        const std::string_view text = view_.substr(at_, end - at_);
        at_ = end;
        return text;
      }
      if (end - at_ >= kLongestToken) fail("a word of more than 512 characters is no number");
    }
  }

  void endRecord(const Element& element, std::size_t i) {
    for (;;) {
      while (at_ < view_.size() && (view_[at_] == ' ' || view_[at_] == '\t')) ++at_;
      if (at_ < view_.size()) break;
      file_.skip(at_);
      refill();
      if (view_.empty()) return;
    }
    if (view_[at_] != '\n' && view_[at_] != '\r')
      fail(fmt::format("record {} of element {} has more values than its properties", i + 1,
                       element.name));
  }

  static bool isBlank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

  void refill() {
    at_ = 0;
    view_ = file_.peek(std::min(2 * kLongestToken, file_.remaining()));
  }

  [[noreturn]] void failNumber(const Property& p, std::string_view text) const {
    fail(fmt::format("\"{}\" is not a number (property {})", text.substr(0, 40), p.name));
  }

  [[noreturn]] void fail(const std::string& cause) const {
    throw IoError(file_.path(), "line " + std::to_string(line_), cause, kExportAgain);
  }

  InputFile& file_;
  std::string_view view_;  // what is read of the file's rest
  std::size_t at_ = 0;     // in view_
  std::size_t line_;
};

}  // namespace

RecordTable readPly(InputFile& file, Monitor& monitor) {
  monitor.checkpoint();
  PlyHeader header = readPlyHeader(file);
  if (header.format == PlyFormat::Ascii) {
    for (const Element& e : header.table.elements) checkCount(e, header.format, file);
    AsciiBody body(file);
    for (Element& e : header.table.elements) body.read(e);
    return std::move(header.table);
  }
  BinaryBody body(file, header.format);
  for (Element& e : header.table.elements) {
    checkCount(e, header.format, file);
    prepareColumns(e);
    body.read(e);
  }
  return std::move(header.table);
}

}  // namespace dapple
