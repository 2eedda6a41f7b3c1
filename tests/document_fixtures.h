// Scans on disk, swatches by name, and documents made of them.
#pragma once

#include <filesystem>

#include "document/apply.h"

namespace dapple::fixtures {

// A folder that goes with everything in it.
class TestFolder {
 public:
  TestFolder();
  ~TestFolder();
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

// A sphere of `count` points with normals, red where x < 0 and blue elsewhere, as a file.
std::string writeSphere(const TestFolder& folder, std::size_t count,
                        const std::string& name = "sphere.xyz");

// "bricks", "noise" and "stripes" are images, whatever folder they are said to be in; IoError else.
Image imageNamed(const std::filesystem::path& path);

// Reads imageNamed(), watches nothing.
CommandContext testContext();

// apply() on all cores without a way to stop it.
Document applied(const Document& document, const Command& command,
                 const CommandContext& context = testContext());

// An opened sphere, nothing else.
Document sphereDocument(const TestFolder& folder, std::size_t count);

// Points of the document with x below or above 0.
std::vector<Index> half(const Document& document, bool left);

// A stroke over `count` points along z, near x = 1.
Stroke meridian(const Document& document, int count = 8);

}  // namespace dapple::fixtures
