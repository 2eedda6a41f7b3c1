#include "io/ply_header.h"

#include <array>
#include <charconv>
#include <optional>
#include <vector>

#include "base/errors.h"
#include "io/ply.h"
#include "io/text_words.h"

namespace dapple {
namespace {

struct TypeName {
  std::string_view classic, sized;
  ScalarType type;
};

constexpr std::array kTypeNames = {
    TypeName{"char", "int8", ScalarType::Int8},
    TypeName{"uchar", "uint8", ScalarType::UInt8},
    TypeName{"short", "int16", ScalarType::Int16},
    TypeName{"ushort", "uint16", ScalarType::UInt16},
    TypeName{"int", "int32", ScalarType::Int32},
    TypeName{"uint", "uint32", ScalarType::UInt32},
    TypeName{"float", "float32", ScalarType::Float32},
    TypeName{"double", "float64", ScalarType::Float64},
};

constexpr CharSet kBlanks(" \t");
constexpr const char* kExportAgain = "Export the scan again with another program.";

std::string_view typeName(ScalarType type) {
  for (const TypeName& name : kTypeNames)
    if (name.type == type) return name.classic;  // every reader knows the classic names
  throw Bug("a scalar type without a name");
}

ScalarType typeOf(std::string_view word, const InputFile& file) {
  for (const TypeName& name : kTypeNames)
    if (word == name.classic || word == name.sized) return name.type;
  file.failAtLine(fmt::format("unknown type \"{}\"", word),
                  "PLY's types are char, uchar, short, ushort, int, uint, float and double.");
}

std::vector<std::string_view> splitWords(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::string_view word; !(word = takeWord(line, kBlanks)).empty();) words.push_back(word);
  return words;
}

std::string textAfter(std::string_view line, std::string_view keyword) {
  line.remove_prefix(line.find(keyword) + keyword.size());
  if (!line.empty()) line.remove_prefix(1);
  return std::string(line);
}

PlyFormat readFormat(const std::vector<std::string_view>& words, const InputFile& file) {
  const std::string_view name = words.size() > 1 ? words[1] : "";
  if (words.size() > 2 && !words[2].starts_with("1."))
    file.failAtLine(fmt::format("PLY version {} is unknown", words[2]),
                    "Export the scan as PLY 1.0.");
  if (name == "ascii") return PlyFormat::Ascii;
  if (name == "binary_little_endian") return PlyFormat::LittleEndian;
  if (name == "binary_big_endian") return PlyFormat::BigEndian;
  file.failAtLine(fmt::format("unknown PLY format \"{}\"", name),
                  "Known are ascii, binary_little_endian and binary_big_endian.");
}

Element readElement(const std::vector<std::string_view>& words, const InputFile& file) {
  if (words.size() < 3) file.failAtLine("an element needs a name and a count", kExportAgain);
  Element element{.name = std::string(words[1])};
  const std::string_view text = words[2];
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), element.count);
  if (error != std::errc() || stop != text.data() + text.size())
    file.failAtLine(fmt::format("\"{}\" is not a possible count of element {}", text, element.name),
                    "The file is damaged; export it again.");
  return element;
}

Property readProperty(const std::vector<std::string_view>& words, const InputFile& file) {
  const bool isList = words.size() > 1 && words[1] == "list";
  if (words.size() < (isList ? 5 : 3))
    file.failAtLine("a property needs a type and a name", kExportAgain);
  Property property{.isList = isList};
  if (isList) {
    property.countType = typeOf(words[2], file);
    if (property.countType == ScalarType::Float32 || property.countType == ScalarType::Float64)
      file.failAtLine("the length of a list cannot be a fraction", kExportAgain);
  }
  property.type = typeOf(words[isList ? 3 : 1], file);
  property.name = words[isList ? 4 : 2];
  return property;
}

// Old Macintosh files end their lines with \r alone.
char lineEnding(InputFile& file) {
  const std::string_view start = file.peek(64);
  const auto end = start.find_first_of("\r\n");
  if (end == start.npos || start[end] == '\n') return '\n';
  return end + 1 < start.size() && start[end + 1] == '\n' ? '\n' : '\r';
}

}  // namespace

bool looksLikePly(std::string_view bytes) {
  return bytes.starts_with("ply") &&
         (bytes.size() == 3 || bytes[3] == '\n' || bytes[3] == '\r' || bytes[3] == ' ');
}

PlyHeader readPlyHeader(InputFile& file) {
  if (!looksLikePly(file.peek(4)))
    file.failAtByte("this is not a PLY file: it does not begin with \"ply\"",
                    "Give the file the extension of its own format.");
  PlyHeader header;
  std::optional<PlyFormat> format;
  const char ending = lineEnding(file);
  std::string_view line;
  std::vector<Element>& elements = header.table.elements;
  file.line(line, ending);
  while (file.line(line, ending)) {
    const auto words = splitWords(line);
    const std::string_view keyword = words.empty() ? "" : words[0];
    if (keyword == "format") {
      format = readFormat(words, file);
    } else if (keyword == "comment") {
      header.table.comments.push_back(textAfter(line, keyword));
    } else if (keyword == "obj_info") {
      header.table.objInfo.push_back(textAfter(line, keyword));
    } else if (keyword == "element") {
      elements.push_back(readElement(words, file));
    } else if (keyword == "property") {
      if (elements.empty()) file.failAtLine("a property before any element", kExportAgain);
      elements.back().properties.push_back(readProperty(words, file));
    } else if (keyword == "end_header") {
      if (!format) file.failAtLine("the header names no format", kExportAgain);
      header.format = *format;
      return header;
    } else if (!keyword.empty()) {
      file.failAtLine(fmt::format("unknown keyword \"{}\" in the header", keyword.substr(0, 40)),
                      kExportAgain);
    }
  }
  file.failAtLine("the file ends before the end of its header", "Export or copy it again.");
}

std::string writePlyHeader(const RecordTable& table, PlyFormat format) {
  const auto oneLine = [](std::string text) {
    for (char& c : text)
      if (c == '\n' || c == '\r') c = ' ';
    return text;
  };
  std::string text = "ply\nformat ";
  text += format == PlyFormat::Ascii ? "ascii" : "binary_little_endian";
  text += " 1.0\n";
  for (const std::string& comment : table.comments) text += "comment " + oneLine(comment) + "\n";
  for (const std::string& info : table.objInfo) text += "obj_info " + oneLine(info) + "\n";
  for (const Element& element : table.elements) {
    text += fmt::format("element {} {}\n", element.name, element.count);
    for (const Property& property : element.properties) {
      text += "property ";
      if (property.isList) text += fmt::format("list {} ", typeName(property.countType));
      text += fmt::format("{} {}\n", typeName(property.type), property.name);
    }
  }
  return text + "end_header\n";
}

}  // namespace dapple
