// Scans as text for programs that do not read PLY: what OBJ and XYZ can hold of them.
#include <array>
#include <cstring>

#include "base/errors.h"
#include "io/obj.h"
#include "io/xyz.h"

namespace dapple {
namespace {

constexpr std::size_t kBlock = 256 << 10;
constexpr std::array<const char*, 3> kPosition{"x", "y", "z"}, kNormal{"nx", "ny", "nz"},
    kColour{"red", "green", "blue"};

using Columns = std::vector<const Property*>;

// All of these columns, or none.
Columns columnsOf(const Element& vertices, std::span<const char* const> names) {
  Columns columns;
  for (const char* name : names) {
    const Property* property = vertices.find(name);
    if (!property || property->isList) return {};
    columns.push_back(property);
  }
  return columns;
}

const Element& verticesOf(const RecordTable& table) {
  const Element* vertices = table.find("vertex");
  DAPPLE_CHECK(vertices != nullptr && vertices->find("z") != nullptr, ==, true);
  return *vertices;
}

// The shortest text that reads back as the same number.
void put(std::string& out, const Property& column, std::size_t record) {
  if (column.type == ScalarType::Float32)
    fmt::format_to(std::back_inserter(out), " {}", static_cast<float>(column.at(record)));
  else
    fmt::format_to(std::back_inserter(out), " {}", column.at(record));
}

class Lines {
 public:
  Lines(OutputFile& file, Monitor& monitor) : file_(file), monitor_(monitor) {}

  std::string& text() { return text_; }
  void endLine() {
    text_ += '\n';
    ++lines_;
    if (text_.size() >= kBlock) flush();
  }
  void flush() {
    file_.write(text_.data(), text_.size());
    monitor_.advance(lines_);
    text_.clear(), lines_ = 0;
  }

 private:
  OutputFile& file_;
  Monitor& monitor_;
  std::string text_;
  std::size_t lines_ = 0;
};

// OBJ's colours go from 0 to 1.
void putUnit(std::string& out, const Property& column, std::size_t record) {
  const bool bytes = column.type == ScalarType::UInt8;
  fmt::format_to(std::back_inserter(out), " {:.5g}",
                 bytes ? column.at(record) / 255 : column.at(record));
}

// The columns of the faces; null: there is none.
struct FaceColumns {
  const Property* corners = nullptr;
  const Property* coordinates = nullptr;  // two for each corner
  const Property* texture = nullptr;      // below 0: the face has none; null: all have the first

  explicit FaceColumns(const RecordTable& table) {
    const Element* faces = table.find("face");
    if (!faces) return;
    corners = faces->find("vertex_indices");
    if (!corners) corners = faces->find("vertex_index");
    if (corners && !corners->isList) corners = nullptr;
    const Property* pairs = faces->find("texcoord");
    if (!corners || !pairs || !pairs->isList) return;
    for (std::size_t f = 0; f < corners->listOffsets.size(); ++f)
      if (pairs->listOffsets[f] != 2 * corners->listOffsets[f]) return;
    coordinates = pairs;
    texture = faces->find("texnumber");
    if (texture && texture->isList) texture = nullptr;
  }

  int textureOf(std::size_t face) const {
    if (!coordinates) return -1;
    return texture ? static_cast<int>(texture->at(face)) : 0;
  }
};

std::string materialName(int texture) {
  return texture < 0 ? "bare" : fmt::format("swatch{}", texture);
}

void putCoordinates(Lines& lines, const FaceColumns& columns) {
  for (std::size_t k = 0; k < columns.corners->listOffsets.back(); ++k) {
    lines.text() += "vt";
    for (const std::size_t number : {2 * k, 2 * k + 1})
      put(lines.text(), *columns.coordinates, number);
    lines.endLine();
  }
}

void putFaces(Lines& lines, const FaceColumns& columns, bool normals, bool materials) {
  const Property& corners = *columns.corners;
  std::string current;
  for (std::size_t f = 0; f + 1 < corners.listOffsets.size(); ++f) {
    const int texture = columns.textureOf(f);
    if (materials && materialName(texture) != current) {
      current = materialName(texture);
      lines.text() += "usemtl " + current;
      lines.endLine();
    }
    lines.text() += 'f';
    for (std::size_t k = corners.listOffsets[f]; k < corners.listOffsets[f + 1]; ++k) {
      const auto vertex = static_cast<std::uint64_t>(corners.at(k)) + 1;
      fmt::format_to(std::back_inserter(lines.text()), " {}", vertex);
      if (texture >= 0)
        fmt::format_to(std::back_inserter(lines.text()), "/{}", k + 1);
      else if (normals)
        lines.text() += '/';
      if (normals) fmt::format_to(std::back_inserter(lines.text()), "/{}", vertex);
    }
    lines.endLine();
  }
}

}  // namespace

std::string objMaterials(const RecordTable& table) {
  const FaceColumns columns(table);
  std::string text;
  int texture = 0;
  for (const std::string& line : table.comments)
    if (columns.coordinates && line.starts_with(kTextureComment))
      text += fmt::format("newmtl {}\nKd 1 1 1\nmap_Kd {}\n\n", materialName(texture++),
                          line.substr(kTextureComment.size()));
  if (!text.empty()) text += fmt::format("newmtl {}\nKd 0.72 0.72 0.72\n", materialName(-1));
  return text;
}

void writeObj(OutputFile& file, const RecordTable& table, const std::string& materials,
              Monitor& monitor) {
  const Element& vertices = verticesOf(table);
  const Columns position = columnsOf(vertices, kPosition), normal = columnsOf(vertices, kNormal),
                colour = columnsOf(vertices, kColour);
  const FaceColumns faces(table);
  Lines lines(file, monitor);
  if (!materials.empty()) {
    lines.text() += "mtllib " + materials;
    lines.endLine();
  }
  for (std::size_t r = 0; r < vertices.count; ++r) {
    lines.text() += 'v';
    for (const Property* column : position) put(lines.text(), *column, r);
    for (const Property* column : colour) putUnit(lines.text(), *column, r);
    lines.endLine();
  }
  for (std::size_t r = 0; r < vertices.count && !normal.empty(); ++r) {
    lines.text() += "vn";
    for (const Property* column : normal) put(lines.text(), *column, r);
    lines.endLine();
  }
  if (faces.coordinates) putCoordinates(lines, faces);
  if (faces.corners) putFaces(lines, faces, !normal.empty(), !materials.empty());
  lines.flush();
}

void writeXyz(OutputFile& file, const RecordTable& table, Monitor& monitor) {
  const Element& vertices = verticesOf(table);
  Lines lines(file, monitor);
  Columns all;
  lines.text() = "#";
  for (const auto& names : {kPosition, kNormal, kColour})
    for (const Property* column : columnsOf(vertices, names)) {
      all.push_back(column);
      lines.text() += " " + column->name;
    }
  lines.endLine();
  for (std::size_t r = 0; r < vertices.count; ++r) {
    const std::size_t start = lines.text().size();
    for (const Property* column : all) put(lines.text(), *column, r);
    lines.text().erase(start, 1);
    lines.endLine();
  }
  lines.flush();
}

}  // namespace dapple
