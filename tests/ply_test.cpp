#include "io/ply.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "base/hash_rng.h"
#include "scan_files.h"

using namespace dapple;
using namespace dapple::testing;

namespace {

template <class T>
Property makeColumn(const char* name, ScalarType type, const std::vector<T>& values) {
  Property p{.name = name, .type = type};
  p.values.resize(values.size() * sizeof(T));
  if (!values.empty()) std::memcpy(p.values.data(), values.data(), p.values.size());
  return p;
}

template <class T>
Property makeList(const char* name, ScalarType type, ScalarType countType,
                  const std::vector<std::vector<T>>& lists) {
  std::vector<T> flat;
  std::vector<std::size_t> offsets{0};
  for (const auto& list : lists) {
    flat.insert(flat.end(), list.begin(), list.end());
    offsets.push_back(flat.size());
  }
  Property p = makeColumn(name, type, flat);
  p.isList = true;
  p.countType = countType;
  p.listOffsets = offsets;
  return p;
}

// Every type, lists on points and on unknown elements, extreme values.
RecordTable makeRichTable() {
  using S = ScalarType;
  RecordTable table{.comments = {"first", "  second one "}, .objInfo = {"num_cols 3"}};
  Element camera{.name = "camera", .count = 2};
  camera.properties = {
      makeColumn<std::int8_t>("a", S::Int8, {-128, 127}),
      makeList<double>("view", S::Float64, S::UInt8, {{1e-300, 0.1}, {}}),
      makeColumn<std::int16_t>("b", S::Int16, {-32768, 32767}),
  };
  Element vertex{.name = "vertex", .count = 4};
  vertex.properties = {
      makeColumn<std::uint8_t>("quality", S::UInt8, {0, 255, 7, 9}),
      makeColumn<float>("z", S::Float32, {0.1f, 2e-38f, -3.4e38f, 1.0f / 3}),
      makeColumn<double>("x", S::Float64, {0.1, 1e300, -0.0, 1.0 / 3}),
      makeColumn<float>("y", S::Float32, {1, 2, 3, 4}),
      makeColumn<std::uint32_t>("id", S::UInt32, {0, 4294967295u, 5, 6}),
      makeColumn<std::int32_t>("i", S::Int32, {-2147483647 - 1, 2147483647, 5, 6}),
      makeList<std::uint16_t>("seen_by", S::UInt16, S::UInt32, {{1}, {}, {65535, 0, 3}, {4}}),
  };
  Element face{.name = "face", .count = 2};
  face.properties = {
      makeList<std::int32_t>("vertex_index", S::Int32, S::Int8, {{0, 1, 2}, {0, 1, 2, 3}}),
      makeColumn<float>("flags", S::Float32, {1, 0})};
  Element nothing{.name = "nothing", .count = 0};
  nothing.properties = {makeColumn<float>("q", S::Float32, {})};
  table.elements = {camera, vertex, face, nothing};
  return table;
}

void checkSame(const RecordTable& a, const RecordTable& b) {
  CHECK(a.comments == b.comments);
  CHECK(a.objInfo == b.objInfo);
  REQUIRE(a.elements.size() == b.elements.size());
  for (std::size_t e = 0; e < a.elements.size(); ++e) {
    CHECK(a.elements[e].name == b.elements[e].name);
    CHECK(a.elements[e].count == b.elements[e].count);
    REQUIRE(a.elements[e].properties.size() == b.elements[e].properties.size());
    for (std::size_t i = 0; i < a.elements[e].properties.size(); ++i) {
      const Property &p = a.elements[e].properties[i], &q = b.elements[e].properties[i];
      CAPTURE(p.name);
      CHECK(p.name == q.name);
      CHECK(p.type == q.type);
      CHECK(p.isList == q.isList);
      CHECK((!p.isList || p.countType == q.countType));
      CHECK(p.listOffsets == q.listOffsets);
      CHECK(p.values == q.values);  // bit by bit
    }
  }
}

RecordTable readTable(const fs::path& path) {
  Workers workers(1);
  Monitor monitor(workers);
  InputFile file(path, monitor);
  return readPly(file, monitor);
}

const std::string kTriangleHeader =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
const std::string kTriangle = kTriangleHeader + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

// Binary of either order: 2 points with a list before and after x, y and z.
std::string makeBinary(bool bigEndian) {
  std::string text = fmt::format(
      "ply\r\nformat binary_{}_endian 1.0\r\nelement vertex 2\r\nproperty list uint16 int16 "
      "before\r\nproperty float64 x\r\nproperty float32 y\r\nproperty short z\r\nproperty uint8 "
      "red\r\nproperty uint8 green\r\nproperty uint8 blue\r\nend_header\r\n",
      bigEndian ? "big" : "little");
  for (int i = 0; i < 2; ++i) {
    text += bytesOf<std::uint16_t>(2, bigEndian) + bytesOf<std::int16_t>(-300, bigEndian) +
            bytesOf<std::int16_t>(5, bigEndian);
    text += bytesOf<double>(i + 0.25, bigEndian) + bytesOf<float>(0.5f, bigEndian) +
            bytesOf<std::int16_t>(-3, bigEndian) + "\xff" + std::string(1, '\0') + "\x33";
  }
  return text;
}

}  // namespace

TEST_CASE("a table with every type, lists and unknown elements comes back bit by bit") {
  const Folder folder;
  const RecordTable table = makeRichTable();
  for (const bool ascii : {false, true}) {
    save(folder / "a.ply", table, ascii);
    checkSame(readTable(folder / "a.ply"), table);
  }
  CHECK(folder.files() == 1);
}

TEST_CASE("numbers drawn at random survive ascii bit by bit") {
  const Folder folder;
  std::vector<float> singles;
  std::vector<double> doubles;
  for (std::uint64_t i = 0; singles.size() < 20000; ++i) {
    const auto f = std::bit_cast<float>(static_cast<std::uint32_t>(hashBits(1, i)));
    const auto d = std::bit_cast<double>(hashBits(2, i));
    if (!std::isfinite(f) || !std::isfinite(d)) continue;
    singles.push_back(f);
    doubles.push_back(d);
  }
  RecordTable table;
  Element vertex{.name = "vertex", .count = singles.size()};
  setColumn(vertex, "f", std::span<const float>(singles));
  setColumn(vertex, "d", std::span<const double>(doubles));
  table.elements.push_back(vertex);
  save(folder / "a.ply", table, true);
  checkSame(readTable(folder / "a.ply"), table);
}

TEST_CASE("little and big endian with CRLF headers, sized type names and lists read the same") {
  const Folder folder;
  for (const bool bigEndian : {false, true}) {
    const Scan scan = load(folder.write("a.ply", makeBinary(bigEndian)));
    REQUIRE(scan.points.size() == 2);
    const Element& vertex = *scan.table.find("vertex");
    CHECK(vertex.find("before")->at(2) == -300);
    CHECK(vertex.find("before")->at(3) == 5);
    CHECK(vertex.find("x")->at(1) == 1.25);
    CHECK(vertex.find("z")->at(0) == -3);
    CHECK(scan.points.colours[0] == vec3(1, 0, 0.2f));
    CHECK(scan.points.origin == dvec3(0.75, 0.5, -3));
  }
}

TEST_CASE("polygons become fans and strips alternate, with restarts") {
  const Folder folder;
  const Scan scan = load(folder.write(
      "a.ply",
      "ply\nformat ascii 1.0\ncomment made by hand\nobj_info x\nelement vertex 5\nproperty int "
      "x\nproperty int y\nproperty int z\nelement face 1\nproperty list uchar uint "
      "vertex_index\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 0 0\n4 0 1 3 2\n8 0 1 2 3 -1 1 4 3\n"));
  std::vector<std::array<std::size_t, 3>> found;
  for (const auto& t : scan.mesh.triangles)
    found.push_back({scan.record[t[0]], scan.record[t[1]], scan.record[t[2]]});
  const std::vector<std::array<std::size_t, 3>> expected = {
      {0, 1, 3}, {0, 3, 2}, {0, 1, 2}, {2, 1, 3}, {1, 4, 3}};
  CHECK(found == expected);
  CHECK(scan.table.comments == std::vector<std::string>{"made by hand"});
  CHECK(scan.table.objInfo == std::vector<std::string>{"x"});
}

TEST_CASE("a face of no vertices and an element face 0 do no harm") {
  const Folder folder;
  std::string text = kTriangle;
  text[text.find("face 1") + 5] = '0';
  CHECK(load(folder.write("a.ply", text)).mesh.triangles.empty());
  CHECK(load(folder.write("a.ply", kTriangleHeader + "0 0 0\n1 0 0\n0 1 0\n0\n"))
            .mesh.triangles.empty());
}

TEST_CASE(
    "ascii as programs write it: blank lines, wrapped lists, no last newline, CR, fractions") {
  const Folder folder;
  const auto triangles = [&](const std::string& text) {
    return load(folder.write("a.ply", text)).mesh.triangles.size();
  };
  CHECK(triangles(kTriangleHeader + "\n0 0 0\n\n1 0 0  \r\n+0 1e0 0\n3 0\n 1 2") == 1);
  CHECK(triangles(kTriangleHeader + "0 0 0\n1 0 0\n0 1 0\n3.0 0 1.0 2e0\n") == 1);
  std::string classic = kTriangle;
  for (char& c : classic)
    if (c == '\n') c = '\r';
  CHECK(triangles(classic) == 1);
  const Scan odd = load(
      folder.write("a.ply", kTriangleHeader + "nan inf -1.#IND\n1 0 0\n0 1e-60 1e-30\n3 0 1 2\n"));
  CHECK(odd.nonFinite == 1);
  CHECK(odd.points.size() == 2);
}

TEST_CASE("errors of ascii files and headers name the line") {
  const Folder folder;
  const auto check = [&](const std::string& text, const char* line, const char* cause) {
    const std::string why = whyNot(folder.write("a.ply", text));
    CHECK_MESSAGE(contains(why, line), why);
    CHECK_MESSAGE(contains(why, cause), why);
  };
  check(kTriangleHeader + "0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n", "line 11", "\"x\" is not a number");
  check(kTriangleHeader + "0 0 0\n1 0\n0 1 0\n3 0 1 2\n", "line 12", "more values");
  check(kTriangleHeader + "0 0 0\n1 0 0 0\n0 1 0\n3 0 1 2\n", "line 11", "more values");
  check(kTriangleHeader + "0 0 0\n1 0 0\n0 1 0\n3 0 1", "line 13", "claims 3 values");
  check(kTriangleHeader + "0 0 0\n1 0 0\n0 1                 ", "line 12", "ends in record 3 of 3");
  check(kTriangleHeader + "0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", "line 13", "does not fit");
  check(kTriangleHeader + "0 0 0\n1 0 0\n0 1 0\n300 0 1 2\n", "line 13", "does not fit");
  check(kTriangleHeader + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "face 1", "names vertex 3");
  check("ply\nformat ascii 2.0\n", "line 2", "version 2.0");
  check("ply\nformat ascii 1.0\nelement vertex -1\n", "line 3", "possible count");
  check("ply\nformat ascii 1.0\nelement vertex 99999999999999999999999\n", "line 3", "count");
  check("ply\nformat ascii 1.0\nproperty float x\nend_header\n", "line 3", "before any element");
  check("ply\nformat ascii 1.0\nelement vertex 1\nproperty word x\n", "line 4", "type \"word\"");
  check("ply\nformat ascii 1.0\nelement vertex 1\nproperty list float int x\n", "line 4",
        "fraction");
  check("ply\nelement vertex 1\nproperty int x\nend_header\n1\n", "line 4", "no format");
  check("ply\nformat ascii 1.0\n", "line 2", "end of its header");
  check("ply\nformat ascii 1.0\nend_header\n", "", "no element \"vertex\"");
  check("ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nend_header\n1\n", "", "no x, y");
}

TEST_CASE("counts that lie are refused before memory is taken") {
  const Folder folder;
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"})
    for (const char* count : {"1000000000000000000", "18446744073709551615", "4294967296", "50"}) {
      const std::string lie = fmt::format("declares {} records", count);
      const std::string points = whyNot(folder.write(
          "a.ply", fmt::format("ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty "
                               "float y\nproperty float z\nend_header\n1 2 3\n4 5 6\n",
                               format, count)));
      CHECK_MESSAGE(contains(points, lie), points);
      const std::string faces = whyNot(folder.write(
          "a.ply", fmt::format("ply\nformat {} 1.0\nelement vertex 0\nproperty float x\nelement "
                               "face {}\nproperty list uchar int v\nend_header\n3 0 1 2\n",
                               format, count)));
      CHECK_MESSAGE(contains(faces, lie), faces);
    }
  const std::string list = whyNot(folder.write(
      "a.ply",
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty list uint double "
      "x\nend_header\n\xff\xff\xff\xff 12345678"));
  CHECK_MESSAGE(contains(list, "claims 4294967295 values, but only 1 fit"), list);
  CHECK_MESSAGE(contains(list, "byte 92"), list);
  const std::string negative = whyNot(folder.write(
      "a.ply",
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty list int double "
      "x\nend_header\n\xff\xff\xff\xff 12345678"));
  CHECK_MESSAGE(contains(negative, "claims -1 values"), negative);
  const std::string ascii =
      whyNot(folder.write("a.ply",
                          "ply\nformat ascii 1.0\nelement vertex 1\nproperty list uint double "
                          "x\nend_header\n4000000000 1 2\n"));
  CHECK_MESSAGE(contains(ascii, "claims 4000000000 values"), ascii);
}

TEST_CASE("a file cut off at any byte is refused or read, and never crashes") {
  const Folder folder;
  save(folder / "ascii.ply", makeRichTable(), true);
  save(folder / "binary.ply", makeRichTable(), false);
  for (const std::string& whole :
       {readBytes(folder / "ascii.ply"), readBytes(folder / "binary.ply"), makeBinary(true)}) {
    std::size_t taken = 0;
    for (std::size_t length = 0; length < whole.size(); ++length) {
      const fs::path path = folder.write("cut.ply", whole.substr(0, length));
      try {
        readTable(path);
        ++taken;
      } catch (const IoError&) {
      }
    }
    CHECK(taken <= 2);  // ascii: the last newline, and a last number that is a shorter number
  }
}

TEST_CASE("bytes turned at random give a table or a clear error") {
  const Folder folder;
  save(folder / "ascii.ply", makeRichTable(), true);
  save(folder / "binary.ply", makeRichTable(), false);
  const std::vector<std::string> seeds = {readBytes(folder / "ascii.ply"),
                                          readBytes(folder / "binary.ply"), makeBinary(false),
                                          makeBinary(true), kTriangle};
  std::size_t taken = 0;
  for (std::uint64_t i = 0; i < 4000; ++i) {
    std::string bytes = seeds[i % seeds.size()];
    for (std::uint64_t k = 0; k <= hashBelow(4, 3, i); ++k)
      bytes[hashBelow(bytes.size(), 4, i, k)] = static_cast<char>(hashBelow(256, 5, i, k));
    taken += whyNot(folder.write("bad.ply", bytes)).empty();
  }
  CHECK(taken > 100);
  CHECK(taken < 3900);
}

TEST_CASE("a list too long for its count type is a bug that is caught, not written") {
  const Folder folder;
  RecordTable table;
  Element element{.name = "face", .count = 1};
  element.properties = {makeList<std::int32_t>("vertex_indices", ScalarType::Int32,
                                               ScalarType::Int8, {std::vector<std::int32_t>(128)})};
  table.elements.push_back(element);
  CHECK_THROWS_AS(save(folder / "a.ply", table), Bug);
  CHECK(folder.files() == 0);
}

TEST_CASE("a comment with a line break cannot break the header") {
  const Folder folder;
  RecordTable table = makeRichTable();
  table.comments = {"one\nend_header\r\ntwo"};
  save(folder / "a.ply", table);
  CHECK(readTable(folder / "a.ply").comments == std::vector<std::string>{"one end_header  two"});
}
