#include "io/obj.h"

#include <algorithm>
#include <charconv>
#include <cstring>

#include "base/errors.h"
#include "io/text_numbers.h"
#include "io/text_words.h"

namespace dapple {
namespace {

constexpr CharSet kBlanks(" \t\v\f\r");
constexpr const char* kExportAgain = "Export the scan again, if possible as PLY.";

// What the lines say; indices from 0.
struct ObjData {
  std::vector<double> positions;             // 3 v
  std::vector<float> colours;                // 3 per vertex that has one
  std::vector<float> normals;                // 3 vn
  std::vector<std::uint32_t> corners;        // vertex ids of all faces
  std::vector<std::uint32_t> cornerNormals;  // of each corner; kNone without
  std::vector<std::size_t> faceOffsets{0};

  std::size_t vertices() const { return positions.size() / 3; }
  std::size_t faces() const { return faceOffsets.size() - 1; }
};

class ObjReader {
 public:
  explicit ObjReader(InputFile& file) : file_(file) {}

  ObjData read() {
    std::string_view line;
    std::string joined;
    while (file_.line(line)) {
      if (line.find('\0') != line.npos)
        file_.failAtLine("this is no text", "Give the file the extension of its own format.");
      if (!line.empty() && line.back() == '\\') {
        joined.assign(line.substr(0, line.size() - 1));
        while (file_.line(line)) {
          const bool more = !line.empty() && line.back() == '\\';
          joined.append(" ").append(line.substr(0, line.size() - (more ? 1 : 0)));
          if (!more) break;
        }
        line = joined;
      }
      readLine(line);
    }
    checkCorners();
    return std::move(data_);
  }

 private:
  void readLine(std::string_view rest) {
    if (rest.starts_with("\xef\xbb\xbf")) rest.remove_prefix(3);
    const std::string_view keyword = takeWord(rest, kBlanks);
    if (keyword == "v") readVertex(rest);
    if (keyword == "vn") readNormal(rest);
    if (keyword == "f") readFace(rest);
  }

  void readVertex(std::string_view rest) {
    double values[7];
    std::size_t count = 0;
    for (; count < 7; ++count) {
      const std::string_view word = takeWord(rest, kBlanks);
      if (word.empty() || word[0] == '#') break;
      if (!parseNumber(word, values[count])) failNumber(word);
    }
    if (count < 3) file_.failAtLine("a vertex needs three coordinates", kExportAgain);
    data_.positions.insert(data_.positions.end(), values, values + 3);
    if (count >= 6) data_.colours.insert(data_.colours.end(), values + 3, values + 6);
    if (data_.vertices() >= kNone)
      file_.failAtLine(fmt::format("more than the {} vertices that Dapple works with", kNone - 1),
                       "Split the scan.");
  }

  void readNormal(std::string_view rest) {
    for (int i = 0; i < 3; ++i) {
      const std::string_view word = takeWord(rest, kBlanks);
      float value = 0;
      if (!parseNumber(word, value)) failNumber(word);
      data_.normals.push_back(value);
    }
  }

  void readFace(std::string_view rest) {
    for (;;) {
      const std::string_view word = takeWord(rest, kBlanks);
      if (word.empty() || word[0] == '#') break;
      readCorner(word);
    }
    if (data_.corners.size() - data_.faceOffsets.back() < 3) {  // a point or an edge
      data_.corners.resize(data_.faceOffsets.back());
      data_.cornerNormals.resize(data_.faceOffsets.back());
      return;
    }
    data_.faceOffsets.push_back(data_.corners.size());
    data_.cornerNormals.resize(data_.corners.size(), kNone);
  }

  // "v", "v/t", "v//n" or "v/t/n".
  void readCorner(std::string_view word) {
    const auto slash = std::min(word.find('/'), word.size());
    data_.corners.push_back(readIndex(word.substr(0, slash), data_.vertices(), word));
    const auto second = word.find('/', slash + 1);
    std::uint32_t normal = kNone;
    if (slash < word.size() && second != word.npos && second + 1 < word.size())
      normal = readIndex(word.substr(second + 1), data_.normals.size() / 3, word);
    data_.cornerNormals.push_back(normal);
  }

  // Counts from 1, or backwards from the last one read so far.
  std::uint32_t readIndex(std::string_view text, std::size_t soFar, std::string_view word) {
    std::int64_t index = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), index);
    if (error != std::errc() || stop != text.data() + text.size()) failNumber(word);
    const std::int64_t id = index < 0 ? static_cast<std::int64_t>(soFar) + index : index - 1;
    if (id < 0 || id >= kNone)
      file_.failAtLine(fmt::format("\"{}\" leads to no vertex", word.substr(0, 40)), kExportAgain);
    return static_cast<std::uint32_t>(id);
  }

  void checkCorners() {
    const std::size_t vertices = data_.vertices(), normals = data_.normals.size() / 3;
    for (std::size_t f = 0; f < data_.faces(); ++f)
      for (std::size_t c = data_.faceOffsets[f]; c < data_.faceOffsets[f + 1]; ++c) {
        const std::uint32_t n = data_.cornerNormals[c];
        if (data_.corners[c] >= vertices || (n != kNone && n >= normals))
          throw IoError(file_.path(), "face " + std::to_string(f + 1),
                        fmt::format("names vertex {} of {}, or a normal that is not there",
                                    std::uint64_t{data_.corners[c]} + 1, vertices),
                        kExportAgain);
      }
  }

  [[noreturn]] void failNumber(std::string_view word) {
    file_.failAtLine(fmt::format("\"{}\" is not a number", word.substr(0, 40)), kExportAgain);
  }

  InputFile& file_;
  ObjData data_;
};

// One normal for each vertex, or nothing when the faces disagree about it.
std::vector<float> normalOfEachVertex(const ObjData& data) {
  const std::size_t n = data.vertices(), given = data.normals.size() / 3;
  if (given == 0) return {};
  const bool named = std::any_of(data.cornerNormals.begin(), data.cornerNormals.end(),
                                 [](std::uint32_t id) { return id != kNone; });
  if (!named) return given == n ? data.normals : std::vector<float>{};
  std::vector<std::uint32_t> idOf(n, kNone);
  for (std::size_t c = 0; c < data.corners.size(); ++c) {
    std::uint32_t& id = idOf[data.corners[c]];
    const std::uint32_t other = data.cornerNormals[c];
    if (other == kNone) return {};
    if (id == kNone) id = other;
    if (!std::equal(&data.normals[3 * std::size_t{id}], &data.normals[3 * std::size_t{id}] + 3,
                    &data.normals[3 * std::size_t{other}]))
      return {};
  }
  std::vector<float> normals(3 * n, 0.0f);
  for (std::size_t v = 0; v < n; ++v)
    if (idOf[v] != kNone) std::copy_n(&data.normals[3 * std::size_t{idOf[v]}], 3, &normals[3 * v]);
  return normals;
}

template <class T>
void setTriple(Element& element, const char* const (&names)[3], const std::vector<T>& values) {
  std::vector<T> column(element.count);
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < column.size(); ++i) column[i] = values[3 * i + c];
    setColumn(element, names[c], std::span<const T>(column));
  }
}

Element faceElement(const ObjData& data) {
  Element element{.name = "face", .count = data.faces()};
  std::size_t longest = 0;
  for (std::size_t f = 0; f < data.faces(); ++f)
    longest = std::max(longest, data.faceOffsets[f + 1] - data.faceOffsets[f]);
  Property indices{.name = "vertex_indices", .type = ScalarType::Int32, .isList = true};
  if (data.vertices() > (std::size_t{1} << 31)) indices.type = ScalarType::UInt32;
  indices.countType = longest < 256 ? ScalarType::UInt8 : ScalarType::UInt32;
  indices.listOffsets = data.faceOffsets;
  indices.values.resize(data.corners.size() * sizeof(std::uint32_t));
  std::memcpy(indices.values.data(), data.corners.data(), indices.values.size());
  element.properties.push_back(std::move(indices));
  return element;
}

}  // namespace

RecordTable readObj(InputFile& file, Monitor& monitor) {
  const ObjData data = ObjReader(file).read();
  monitor.checkpoint();
  if (data.vertices() == 0)
    throw IoError(file.path(), "", "there is no vertex (a line \"v x y z\") in this OBJ file",
                  kExportAgain);
  RecordTable table;
  Element vertex{.name = "vertex", .count = data.vertices()};
  setTriple(vertex, {"x", "y", "z"}, data.positions);
  const std::vector<float> normals = normalOfEachVertex(data);
  if (!normals.empty()) setTriple(vertex, {"nx", "ny", "nz"}, normals);
  if (data.colours.size() == data.positions.size())
    setTriple(vertex, {"red", "green", "blue"}, data.colours);
  table.elements.push_back(std::move(vertex));
  if (data.faces() > 0) table.elements.push_back(faceElement(data));
  return table;
}

}  // namespace dapple
