#include "io/obj.h"

#include <doctest/doctest.h>

#include "base/hash_rng.h"
#include "scan_files.h"

using namespace dapple;
using namespace dapple::testing;

namespace {

std::vector<std::array<std::size_t, 3>> trianglesOf(const Scan& scan) {
  std::vector<std::array<std::size_t, 3>> triangles;
  for (const auto& t : scan.mesh.triangles)
    triangles.push_back({scan.record[t[0]], scan.record[t[1]], scan.record[t[2]]});
  return triangles;
}

using Triangles = std::vector<std::array<std::size_t, 3>>;

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

}  // namespace

TEST_CASE("every way to write a face leads to the same triangles") {
  const Folder folder;
  const std::string normals = "vt 0 0\nvn 0 0 1\n";
  for (const char* face :
       {"f 1 2 3 4\n", "f 1/1 2/1 3/1 4/1\n", "f 1//1 2//1 3//1 4//1\n",
        "f 1/1/1 2/1/1 3/1/1 4/1/1\n", "f -4 -3 -2 -1\n", "f -4//-1 -3//-1 -2//-1 -1//-1\n",
        "f 1 2 \\\n 3 4\n", "f 1 2\\\r\n3 \\\r\n4\r\n", "\tf  1\t2 3 4 # a square"}) {
    CAPTURE(face);
    const Scan scan = load(folder.write("a.obj", "\xef\xbb\xbf# made by hand\nmtllib x.mtl\no q\n" +
                                                     kSquare + normals + "s off\n" + face));
    CHECK(scan.format == "obj");
    CHECK(trianglesOf(scan) == Triangles{{0, 1, 2}, {0, 2, 3}});
  }
}

TEST_CASE("normals are taken when each vertex has one of its own, and only then") {
  const Folder folder;
  const auto normalsOf = [&](const std::string& text) {
    return load(folder.write("a.obj", text)).points.normals;
  };
  const std::string two = "vn 0 0 2\nvn 0 3 0\n";
  // By faces: consistent, and then not.
  const auto normals = normalsOf(kSquare + two + "f 1//1 2//2 3//1\nf 1//1 3//1 4//2\n");
  REQUIRE(normals.size() == 4);
  const Scan scan =
      load(folder.write("a.obj", kSquare + two + "f 1//1 2//2 3//1\nf 1//1 3//1 4//2\n"));
  CHECK(scan.points.normals[scan.pointOf[0]] == vec3(0, 0, 1));
  CHECK(scan.points.normals[scan.pointOf[1]] == vec3(0, 1, 0));
  CHECK(normalsOf(kSquare + two + "f 1//1 2//2 3//1\nf 1//2 3//1 4//2\n").empty());
  CHECK(normalsOf(kSquare + two + "f 1//1 2//2 3//1\nf 1 3 4\n").empty());
  // By number: as many as vertices, and then one more.
  const std::string four = "vn 0 0 1\nvn 0 0 1\nvn 0 0 1\nvn 0 0 1\n";
  CHECK(normalsOf(kSquare + four).size() == 4);
  CHECK(normalsOf(kSquare + four + "f 1 2 3\n").size() == 4);
  CHECK(normalsOf(kSquare + four + "vn 0 0 1\nf 1 2 3\n").empty());
  CHECK(normalsOf(kSquare + "vn 0 0 1\n").empty());
}

TEST_CASE("vertex colours are taken when all have them, and a fourth number is a weight") {
  const Folder folder;
  const Scan scan = load(folder.write("a.obj", "v 0 0 0 1 0.5 0\nv 1 0 0 0 0 1\n"));
  REQUIRE(scan.points.colours.size() == 2);
  CHECK(scan.points.colours[scan.pointOf[0]] == vec3(1, 0.5f, 0));
  CHECK(load(folder.write("a.obj", "v 0 0 0 1 0.5 0\nv 1 0 0\n")).points.colours.empty());
  CHECK(load(folder.write("a.obj", "v 0 0 0 1.0\nv 1 0 0 1.0\n")).points.colours.empty());
}

TEST_CASE("coordinates keep all their digits and vertices without a face stay points") {
  const Folder folder;
  const Scan scan = load(folder.write("a.obj", "v -0.35444599999999998 0.1 4512345.123456789\n" +
                                                   kSquare + "f 2 3 4\nl 1 2\np 1\nf 1 2\n"));
  CHECK(scan.points.size() == 5);
  const Element& vertex = *scan.table.find("vertex");
  CHECK(vertex.find("x")->at(0) == -0.35444599999999998);
  CHECK(vertex.find("z")->at(0) == 4512345.123456789);
  CHECK(trianglesOf(scan) == Triangles{{1, 2, 3}});
  CHECK(scan.table.find("face")->count == 1);
}

TEST_CASE("a damaged OBJ is refused by its line or face") {
  const Folder folder;
  const auto check = [&](const std::string& text, const char* where, const char* cause) {
    const std::string why = whyNot(folder.write("a.obj", text));
    CHECK_MESSAGE(contains(why, where), why);
    CHECK_MESSAGE(contains(why, cause), why);
  };
  check(kSquare + "v 1 2\n", "line 5", "three coordinates");
  check(kSquare + "v 1 2 q\n", "line 5", "\"q\" is not a number");
  check(kSquare + "f 1 2 x\n", "line 5", "\"x\" is not a number");
  check(kSquare + "f 0 1 2\n", "line 5", "leads to no vertex");
  check(kSquare + "f -5 1 2\n", "line 5", "leads to no vertex");
  check(kSquare + "f 1 2 5\n", "face 1", "names vertex 5 of 4");
  check(kSquare + "f 1//1 2//1 3//1\n", "face 1", "a normal that is not there");
  check("# nothing\nf 1 2 3\n", "face 1", "of 0");
  check("# nothing\n", "", "no vertex");
  check(std::string("v 1 2\0 3\n", 9), "line 1", "no text");
}

TEST_CASE("an OBJ cut off or turned at random bytes never crashes") {
  const Folder folder;
  const std::string whole =
      kSquare + "vn 0 0 1\nvn 0 1 0\nvt 0 0\nf 1//1 2//2 \\\n 3//1\nf 1/1/1 -2/1/1 4/1/2\n";
  for (std::size_t length = 0; length < whole.size(); ++length)
    whyNot(folder.write("a.obj", whole.substr(0, length)));
  std::size_t taken = 0;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    std::string bytes = whole;
    for (std::uint64_t k = 0; k <= hashBelow(3, 6, i); ++k)
      bytes[hashBelow(bytes.size(), 7, i, k)] =
          "0123456789-+./ \\\nvfn#e\0\xff"[hashBelow(25, 8, i, k)];
    taken += whyNot(folder.write("a.obj", bytes)).empty();
  }
  CHECK(taken > 50);
  CHECK(taken < 1950);
}
