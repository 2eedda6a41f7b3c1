#include "swatch/material_files.h"

#include <algorithm>
#include <cctype>
#include <optional>

#include "base/errors.h"

namespace dapple {
namespace {

namespace fs = std::filesystem;

enum class Role { Bare, Colour, Map, Other };  // Other: a map that we have no use for, a preview

struct Ending {
  std::string_view text;  // words with '_' between
  Role role;
  Channel channel = Channel::Normal;
  bool greenDown = false;
};
// Of several files for one channel the one that stands first here is taken.
constexpr Ending kEndings[] = {
    {"roughness", Role::Map, Channel::Roughness},
    {"rough", Role::Map, Channel::Roughness},
    {"rgh", Role::Map, Channel::Roughness},
    {"height", Role::Map, Channel::Height},
    {"heightmap", Role::Map, Channel::Height},
    {"displacement", Role::Map, Channel::Height},
    {"disp", Role::Map, Channel::Height},
    {"bump", Role::Map, Channel::Height},
    {"metallic", Role::Map, Channel::Metallic},
    {"metalness", Role::Map, Channel::Metallic},
    {"metal", Role::Map, Channel::Metallic},
    {"occlusion", Role::Map, Channel::Occlusion},
    {"ambientocclusion", Role::Map, Channel::Occlusion},
    {"ambient_occlusion", Role::Map, Channel::Occlusion},
    {"ao", Role::Map, Channel::Occlusion},
    {"nor_gl", Role::Map, Channel::Normal},
    {"normal_gl", Role::Map, Channel::Normal},
    {"normalgl", Role::Map, Channel::Normal},
    {"normal_ogl", Role::Map, Channel::Normal},
    {"normal_opengl", Role::Map, Channel::Normal},
    {"normal", Role::Map, Channel::Normal},
    {"normals", Role::Map, Channel::Normal},
    {"nrm", Role::Map, Channel::Normal},
    {"nor", Role::Map, Channel::Normal},
    {"nor_dx", Role::Map, Channel::Normal, true},
    {"normal_dx", Role::Map, Channel::Normal, true},
    {"normaldx", Role::Map, Channel::Normal, true},
    {"normal_directx", Role::Map, Channel::Normal, true},
    {"basecolor", Role::Colour},
    {"base_color", Role::Colour},
    {"basecolour", Role::Colour},
    {"base_colour", Role::Colour},
    {"albedo", Role::Colour},
    {"diffuse", Role::Colour},
    {"diff", Role::Colour},
    {"color", Role::Colour},
    {"colour", Role::Colour},
    {"col", Role::Colour},
    {"arm", Role::Other},
    {"orm", Role::Other},
    {"gloss", Role::Other},
    {"glossiness", Role::Other},
    {"specular", Role::Other},
    {"spec", Role::Other},
    {"refl", Role::Other},
    {"reflection", Role::Other},
    {"cavity", Role::Other},
    {"opacity", Role::Other},
    {"emission", Role::Other},
    {"emissive", Role::Other},
    {"translucency", Role::Other},
    {"preview", Role::Other},
    {"thumb", Role::Other},
};
constexpr std::string_view kImages[] = {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".exr", ".hdr",
                                        ".tga", ".bmp", ".webp", ".gif", ".ppm",  ".jp2"};
constexpr std::string_view kPackings[] = {"jpg", "png", "exr", "tif"};  // after a resolution
constexpr std::size_t kMostListed = 12;

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// The last word, after the last '_'.
std::string_view lastWord(std::string_view text) {
  const std::size_t before = text.rfind('_');
  return before == text.npos ? text : text.substr(before + 1);
}

bool isResolution(std::string_view word) {
  return word.size() >= 2 && word.back() == 'k' &&
         std::all_of(word.begin(), word.end() - 1, [](unsigned char c) { return std::isdigit(c); });
}

// Takes "_2k" or "_2k_jpg" off the end; what was taken.
std::string takeResolution(std::string& text) {
  std::string_view rest = text;
  const std::string_view packing = lastWord(rest);
  const bool packed =
      std::find(std::begin(kPackings), std::end(kPackings), packing) != std::end(kPackings);
  if (packed && packing.size() < rest.size()) rest.remove_suffix(packing.size() + 1);
  const std::string word(lastWord(rest));
  if (!isResolution(word) || word.size() == rest.size()) return {};
  text.resize(rest.size() - word.size() - 1);
  return word;
}

// What a file's name says.
struct MaterialName {
  fs::path path;
  std::string whole;       // the stem, but for the resolution; lower case, '_' between words
  std::string base;        // of it, without the ending
  std::string resolution;  // "2k"; empty: not said
  const Ending* ending = nullptr;

  Role role() const { return ending ? ending->role : Role::Bare; }
};

MaterialName nameOf(const fs::path& path) {
  MaterialName name{.path = path, .whole = lower(path.stem().string())};
  for (char& c : name.whole)
    if (c == '-' || c == ' ' || c == '.') c = '_';
  name.resolution = takeResolution(name.whole);
  for (const Ending& ending : kEndings) {
    if (name.ending && name.ending->text.size() >= ending.text.size()) continue;
    if (!name.whole.ends_with(ending.text)) continue;
    const std::size_t before = name.whole.size() - ending.text.size();
    if (before == 0 || name.whole[before - 1] == '_') name.ending = &ending;
  }
  name.base = name.whole;
  if (!name.ending) return name;
  name.base.resize(name.base.size() - name.ending->text.size());
  if (!name.base.empty()) name.base.pop_back();
  if (const std::string found = takeResolution(name.base); !found.empty()) name.resolution = found;
  return name;
}

// A swatch may itself be called as a map is: what belongs to it then begins with its whole name.
bool isCalledAs(const MaterialName& other, const MaterialName& swatch) {
  const bool colour = swatch.role() == Role::Colour;
  return other.base == swatch.whole || (colour && other.base == swatch.base);
}

bool belongsTo(const MaterialName& other, const MaterialName& swatch) {
  if (other.path == swatch.path || other.role() == Role::Colour) return false;
  if (other.role() == Role::Bare && swatch.role() != Role::Colour) return false;
  return isCalledAs(other, swatch);
}

// In the order of their names: a folder is read in any order. `folder` may be empty: the current.
std::vector<MaterialName> imagesOf(const fs::path& folder) {
  std::vector<MaterialName> names;
  std::error_code error;
  const fs::path place = folder.empty() ? fs::path(".") : folder;
  for (fs::directory_iterator at(place, error), end; !error && at != end; at.increment(error)) {
    const std::string extension = lower(at->path().extension().string());
    std::error_code ignored;
    if (std::find(std::begin(kImages), std::end(kImages), extension) != std::end(kImages) &&
        !at->is_directory(ignored))
      names.push_back(nameOf(folder / at->path().filename()));
  }
  std::sort(names.begin(), names.end(),
            [](const MaterialName& a, const MaterialName& b) { return a.path < b.path; });
  return names;
}

// As Poly Haven packs them, beside the scene that uses them.
std::vector<MaterialName> imagesUnder(const fs::path& folder) {
  std::vector<MaterialName> names = imagesOf(folder);
  return names.empty() ? imagesOf(folder / "textures") : names;
}

std::vector<MaterialName> headsOf(const std::vector<MaterialName>& images) {
  std::vector<MaterialName> heads;
  for (const MaterialName& image : images)
    if (std::none_of(images.begin(), images.end(),
                     [&](const MaterialName& other) { return belongsTo(image, other); }))
      heads.push_back(image);
  return heads;
}

std::vector<fs::path> pathsOf(const std::vector<MaterialName>& names) {
  std::vector<fs::path> paths;
  for (const MaterialName& name : names) paths.push_back(name.path);
  return paths;
}

std::string listed(const std::vector<fs::path>& paths) {
  std::string text;
  for (std::size_t i = 0; i < std::min(paths.size(), kMostListed); ++i)
    text += (i == 0 ? "" : ", ") + paths[i].filename().string();
  if (paths.size() > kMostListed) text += fmt::format(", and {} more", paths.size() - kMostListed);
  return text;
}

}  // namespace

ChannelPaths findChannels(const fs::path& swatch) {
  ChannelPaths out;
  const MaterialName own = nameOf(swatch);
  std::array<const Ending*, kChannels> best{};
  for (const MaterialName& image : imagesOf(swatch.parent_path())) {
    if (image.role() != Role::Map || image.resolution != own.resolution ||
        !isCalledAs(image, own) || image.path == swatch)
      continue;
    const Channel channel = image.ending->channel;
    const Ending*& found = best[static_cast<std::size_t>(channel)];
    if (found && found <= image.ending) continue;
    found = image.ending;
    out[channel] = image.path.string();
    if (channel == Channel::Normal) out.greenDown = image.ending->greenDown;
  }
  return out;
}

std::vector<fs::path> swatchesIn(const fs::path& folder) {
  return pathsOf(headsOf(imagesUnder(folder)));
}

std::vector<fs::path> colourImagesIn(const fs::path& folder) {
  std::vector<MaterialName> heads = headsOf(imagesUnder(folder));
  std::erase_if(heads, [](const MaterialName& name) {
    return name.role() == Role::Map || name.role() == Role::Other;
  });
  return pathsOf(heads);
}

fs::path swatchFile(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return path;
  const std::vector<fs::path> colours = colourImagesIn(path);
  if (colours.size() == 1) return colours.front();
  if (colours.size() > 1)
    throw InvalidInput(
        fmt::format("{}: the folder holds {} colour images ({}), but one material has one; name "
                    "the image in place of the folder",
                    path.string(), colours.size(), listed(colours)));
  const std::vector<fs::path> all = pathsOf(imagesUnder(path));
  throw InvalidInput(fmt::format(
      "{}: the folder holds no colour image ({}); its name would end in _color, _albedo, "
      "_basecolor or _diff, or be that of the maps without their endings",
      path.string(), all.empty() ? "nor any other" : "only " + listed(all)));
}

}  // namespace dapple
