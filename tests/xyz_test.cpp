#include "io/xyz.h"

#include <doctest/doctest.h>

#include "base/hash_rng.h"
#include "scan_files.h"

using namespace dapple;
using namespace dapple::testing;

namespace {

// The names of the columns that a file of these lines has.
std::string columnsOf(const Folder& folder, const std::string& text) {
  const Scan scan = load(folder.write("a.xyz", text));
  std::string names;
  for (const Property& p : scan.table.find("vertex")->properties) names += p.name + " ";
  return names;
}

}  // namespace

TEST_CASE("what the columns hold is judged by their values") {
  const Folder folder;
  CHECK(columnsOf(folder, "1 2 3\n4 5 6\n") == "x y z ");
  CHECK(columnsOf(folder, "1 2 3 0 0 1\n4 5 6 0.6 -0.8 0\n") == "x y z nx ny nz ");
  CHECK(columnsOf(folder, "1 2 3 0 0 0\n4 5 6 0.6 -0.8 0\n") == "x y z nx ny nz ");
  CHECK(columnsOf(folder, "1 2 3 255 0 1\n4 5 6 7 8 9\n") == "x y z red green blue ");
  CHECK(columnsOf(folder, "1 2 3 0.5 0 1\n4 5 6 0.1 0.2 0.3\n") == "x y z red green blue ");
  CHECK(columnsOf(folder, "1 2 3 99 255 0 1\n4 5 6 80 7 8 9\n") == "x y z column4 red green blue ");
  CHECK(columnsOf(folder, "1 2 3 -5 255 0 1\n4 5 6 80 7 8 9\n") == "x y z column4 red green blue ");
  CHECK(columnsOf(folder, "1 2 3 7 8 9 0 0 1\n4 5 6 7 8 200 0 1 0\n") ==
        "x y z red green blue nx ny nz ");
  CHECK(columnsOf(folder, "1 2 3 0 0 1 7 8 9\n4 5 6 0 1 0 7 8 200\n") ==
        "x y z nx ny nz red green blue ");
  CHECK(columnsOf(folder, "1 2 3 0.5\n4 5 6 70000\n") == "x y z column4 ");
  CHECK(columnsOf(folder, "1 2 3 0.5 -70 4\n4 5 6 70000 5 6\n") ==
        "x y z column4 column5 column6 ");
}

TEST_CASE("colours of bytes and of fractions mean the same") {
  const Folder folder;
  const Scan bytes = load(folder.write("a.xyz", "1 2 3 255 0 51\n4 5 6 7 8 9\n"));
  const Scan fractions = load(folder.write("b.xyz", "1 2 3 1 0 0.2\n4 5 6 .7 .8 .9\n"));
  CHECK(bytes.points.colours[bytes.pointOf[0]] == vec3(1, 0, 0.2f));
  CHECK(fractions.points.colours[fractions.pointOf[0]] == vec3(1, 0, 0.2f));
  CHECK(bytes.table.find("vertex")->find("red")->type == ScalarType::UInt8);
}

TEST_CASE("separators, comments, headings, counts and missing newlines are taken in stride") {
  const Folder folder;
  for (const char* text :
       {"1 2 3\n4 5 6", "1,2,3\r\n4,5,6\r\n", "1;2;3\n4; 5; 6\n", "1\t2\t3\n\n4\t5\t6\n\n",
        "# a comment\n1 2 3\n// another\n4 5 6 # the last\n", "X,Y,Z\n1,2,3\n4,5,6\n",
        "//X Y Z\n2\n1 2 3\n4 5 6\n", "2\n1 2 3\n4 5 6\n", "1\n1 2 3\n1\n4 5 6\n",
        "\xef\xbb\xbf+1 2.0 3e0\n4 5 6,\n"}) {
    CAPTURE(text);
    const Scan scan = load(folder.write("a.pts", text));
    CHECK(scan.format == "xyz");
    REQUIRE(scan.pointOf.size() == 2);
    CHECK(scan.points.origin == dvec3(2.5, 3.5, 4.5));
  }
}

TEST_CASE("an unknown extension is judged by what the file looks like") {
  const Folder folder;
  CHECK(load(folder.write("a.data", "# points\n1 2 3\n4 5 6\n")).format == "xyz");
  CHECK(load(folder.write("noextension", "1 2 3\n4 5 6\n")).format == "xyz");
  CHECK(contains(whyNot(folder.write("a.data", "hello world\n")), "PLY, OBJ and XYZ"));
  CHECK(contains(whyNot(folder.write("a.bin", std::string(5000, '\0'))), "PLY, OBJ and XYZ"));
  CHECK(contains(whyNot(folder.write("a.off", "4 0 0\n1 2 3\n")), "PLY, OBJ and XYZ"));
}

TEST_CASE("a damaged point list is refused by its line") {
  const Folder folder;
  const auto check = [&](const std::string& text, const char* where, const char* cause) {
    const std::string why = whyNot(folder.write("a.xyz", text));
    CHECK_MESSAGE(contains(why, where), why);
    CHECK_MESSAGE(contains(why, cause), why);
  };
  check("1 2 3\n4 5\n", "line 2", "three coordinates");
  check("1 2 3\n4 5 6 7\n", "line 2", "4 numbers here, 3 in the lines before");
  check("1 2 3\nfour five six\n", "line 2", "not a row of numbers");
  check("10\n1 2 3\n4 5 6\n", "line 3", "ends after 2");
  check("100\n1 2 3\n4 5 6\n", "line 1", "the whole file has");
  check("1000000000000000000\n1 2 3\n", "line 1", "the whole file has");
  check("2.5\n1 2 3\n", "line 1", "neither a point nor a number of points");
  check("words only\n", "", "no line of three numbers");
  check(std::string("1 2 3\n1\0 2 3\n", 13), "line 2", "no text");
}

TEST_CASE("a point list turned at random bytes never crashes") {
  const Folder folder;
  const std::string whole = "3\n1 2 3 0 0 1 255 3 4\n4 5 6 0 1 0 9 9 9\n1e3 -2 .5 1 0 0 0 0 0\n";
  for (std::size_t length = 0; length < whole.size(); ++length)
    whyNot(folder.write("a.pts", whole.substr(0, length)));
  std::size_t taken = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    std::string bytes = whole;
    for (std::uint64_t k = 0; k <= hashBelow(3, 9, i); ++k)
      bytes[hashBelow(bytes.size(), 10, i, k)] =
          "0123456789-+./ ,;\nnaif#e\0\xff"[hashBelow(26, 11, i, k)];
    taken += whyNot(folder.write("a.pts", bytes)).empty();
  }
  CHECK(taken > 50);
  CHECK(taken < 950);
}
