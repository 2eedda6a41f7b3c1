#include "app/assets_path.h"

#include <doctest/doctest.h>

#include <cstdlib>

#include "cli_program.h"

namespace dapple {
namespace {

using namespace testing;

// An installation under a folder of its own; returns where its program would be.
fs::path install(const fs::path& prefix) {
  fs::create_directories(prefix / "share/dapple/swatches");
  fs::create_directories(prefix / "bin");
  return prefix / "bin/dapple";
}

TEST_CASE("an installed program finds its assets wherever the installation was moved to") {
  const TemporaryFolder folder;
  for (const char* name : {"usr", "opt/with blanks"}) {
    const fs::path prefix = folder / name;
    CHECK(assetsFolderOf(install(prefix), nullptr) == prefix / "share/dapple");
  }
}

TEST_CASE("a program finds the assets beside it, but those of its installation first") {
  const TemporaryFolder folder;
  const fs::path program = folder / "bin/dapple", beside = folder / "bin/assets";
  fs::create_directories(beside / "swatches");
  CHECK(assetsFolderOf(program, nullptr) == beside);
  CHECK(assetsFolderOf(program, "") == beside);
  install(folder / ".");
  CHECK(assetsFolderOf(program, nullptr) == folder / "share/dapple");
}

TEST_CASE("the folder that DAPPLE_ASSETS names is taken even when it does not exist") {
  const TemporaryFolder folder;
  const std::string chosen = folder / "nothing here";
  CHECK(assetsFolderOf(install(folder / "usr"), chosen.c_str()) == chosen);
}

TEST_CASE("a program without assets says so with an empty path") {
  const TemporaryFolder folder;
  fs::create_directories(folder / "share/dapple");  // without swatches: somebody else's
  CHECK(assetsFolderOf(folder / "bin/dapple", nullptr).empty());
  CHECK(assetsFolderOf("", nullptr).empty());
}

TEST_CASE("a program in the build tree finds the swatches and the scan of the sources") {
  REQUIRE_MESSAGE(std::getenv("DAPPLE_ASSETS") == nullptr, "unset DAPPLE_ASSETS for this test");
  for (const char* name : {"swatches/pebbles.png", "scans/creature.ply"}) {
    REQUIRE(fs::exists(assetsFolder() / name));
    CHECK(fs::equivalent(assetsFolder() / name, asset(name)));
  }
}

}  // namespace
}  // namespace dapple
