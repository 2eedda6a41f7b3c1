#include "app/gui/folder_listing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <ctime>
#include <system_error>

namespace dapple {
namespace {

namespace fs = std::filesystem;

bool isDigit(char c) {
  return c >= '0' && c <= '9';
}

char lower(char c) {
  return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

// -1, 0, 1; case aside, runs of digits by value.
int compareNames(std::string_view a, std::string_view b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (isDigit(a[i]) && isDigit(b[j])) {
      while (i + 1 < a.size() && a[i] == '0' && isDigit(a[i + 1])) ++i;
      while (j + 1 < b.size() && b[j] == '0' && isDigit(b[j + 1])) ++j;
      std::size_t m = i, n = j;
      while (m < a.size() && isDigit(a[m])) ++m;
      while (n < b.size() && isDigit(b[n])) ++n;
      if (m - i != n - j) return m - i < n - j ? -1 : 1;
      if (const int order = a.substr(i, m - i).compare(b.substr(j, n - j)); order != 0)
        return order < 0 ? -1 : 1;
      i = m;
      j = n;
      continue;
    }
    const auto x = static_cast<unsigned char>(lower(a[i++]));
    const auto y = static_cast<unsigned char>(lower(b[j++]));
    if (x != y) return x < y ? -1 : 1;
  }
  if (i < a.size()) return 1;
  return j < b.size() ? -1 : 0;
}

// The bytes of the valid UTF-8 character at `at`, 0 when there is none.
std::size_t characterBytes(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(at);
  if (first < 0x80) return 1;
  const std::size_t count = first >= 0xf5   ? 0
                            : first >= 0xf0 ? 4
                            : first >= 0xe0 ? 3
                            : first >= 0xc2 ? 2
                                            : 0;
  if (count == 0 || at + count > text.size()) return 0;
  for (std::size_t i = 1; i < count; ++i)
    if ((byte(at + i) & 0xc0) != 0x80) return 0;
  const unsigned char second = byte(at + 1);
  const bool overlong = (first == 0xe0 && second < 0xa0) || (first == 0xf0 && second < 0x90);
  const bool surrogate = first == 0xed && second >= 0xa0;
  const bool beyond = first == 0xf4 && second >= 0x90;
  return overlong || surrogate || beyond ? 0 : count;
}

FolderEntry entryOf(const fs::directory_entry& item) {
  std::error_code error;
  FolderEntry entry;
  entry.path = item.path();
  const std::string name = item.path().filename().native();
  entry.shown = shownText(name);
  entry.hidden = !name.empty() && name[0] == '.';
  entry.folder = item.is_directory(error);
  if (!entry.folder && item.is_regular_file(error)) {
    entry.bytes = item.file_size(error);
    if (error) entry.bytes = 0;
  }
  entry.changed = item.last_write_time(error);
  if (error) entry.changed = {};
  return entry;
}

std::string whyUnreadable(const fs::path& folder, const std::error_code& error) {
  const std::string name = shownText(folder.native());
  if (error == std::errc::permission_denied)
    return fmt::format("{} may not be read by you. Ask its owner for the right to read it.", name);
  if (error == std::errc::no_such_file_or_directory)
    return fmt::format("{} is not there. It was moved, or its disk is not connected.", name);
  if (error == std::errc::not_a_directory) return fmt::format("{} is no folder.", name);
  return fmt::format("{} cannot be read: {}.", name, error.message());
}

bool shows(const FolderEntry& entry, const FolderView& view) {
  if (entry.hidden && !view.hidden) return false;
  if (entry.folder) return true;
  if (view.foldersOnly) return false;
  if (view.extensions.empty()) return true;
  const std::string extension = lowerExtension(entry.path);
  return std::find(view.extensions.begin(), view.extensions.end(), extension) !=
         view.extensions.end();
}

}  // namespace

std::string lowerExtension(const fs::path& path) {
  std::string extension = path.extension().native();
  std::transform(extension.begin(), extension.end(), extension.begin(), lower);
  return extension;
}

std::string shownText(std::string_view bytes) {
  std::string text;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t count = characterBytes(bytes, at);
    const bool control = count == 1 && static_cast<unsigned char>(bytes[at]) < 0x20;
    text += count == 0 || control ? std::string_view("\xef\xbf\xbd") : bytes.substr(at, count);
    at += std::max<std::size_t>(count, 1);
  }
  return text;
}

std::string shownSize(std::uint64_t bytes) {
  if (bytes < 1000) return fmt::format("{} B", bytes);
  constexpr std::array<const char*, 5> kUnits{"kB", "MB", "GB", "TB", "PB"};
  double value = static_cast<double>(bytes) / 1000;
  std::size_t unit = 0;
  // 999.95 would be printed as 1000.
  while (value >= 999.5 && unit + 1 < kUnits.size()) {
    value /= 1000;
    ++unit;
  }
  return fmt::format("{:.{}f} {}", value, value < 9.95 ? 1 : 0, kUnits[unit]);
}

std::string shownDate(fs::file_time_type time) {
  if (time == fs::file_time_type{}) return {};
  const auto system = std::chrono::file_clock::to_sys(time);
  const std::time_t seconds = std::chrono::system_clock::to_time_t(
      std::chrono::time_point_cast<std::chrono::system_clock::duration>(system));
  std::tm local{};
  localtime_r(&seconds, &local);
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02}", local.tm_year + 1900, local.tm_mon + 1,
                     local.tm_mday, local.tm_hour, local.tm_min);
}

FolderListing readFolder(const fs::path& folder) {
  FolderListing listing{folder, {}, {}};
  std::error_code error;
  fs::directory_iterator at(folder, error);
  for (; !error && at != fs::directory_iterator(); at.increment(error))
    listing.entries.push_back(entryOf(*at));
  if (error) listing.error = whyUnreadable(folder, error);
  return listing;
}

std::vector<std::size_t> shownEntries(const FolderListing& listing, const FolderView& view) {
  std::vector<std::size_t> shown;
  for (std::size_t i = 0; i < listing.entries.size(); ++i)
    if (shows(listing.entries[i], view)) shown.push_back(i);
  std::sort(shown.begin(), shown.end(), [&](std::size_t i, std::size_t j) {
    const FolderEntry& a = listing.entries[i];
    const FolderEntry& b = listing.entries[j];
    if (a.folder != b.folder) return a.folder;
    int order = 0;
    if (view.order == FolderOrder::size && a.bytes != b.bytes) order = a.bytes < b.bytes ? -1 : 1;
    if (view.order == FolderOrder::date && a.changed != b.changed)
      order = a.changed < b.changed ? -1 : 1;
    if (order == 0) order = compareNames(a.path.filename().native(), b.path.filename().native());
    if (order == 0) return a.path.native() < b.path.native();
    return view.descending ? order > 0 : order < 0;
  });
  return shown;
}

fs::path resolvedPath(std::string_view typed, const fs::path& base) {
  if (typed.starts_with("~") && (typed.size() == 1 || typed[1] == '/')) {
    if (const char* home = std::getenv("HOME"))
      return (fs::path(home) / typed.substr(std::min<std::size_t>(2, typed.size())))
          .lexically_normal();
  }
  return (base / fs::path(typed)).lexically_normal();
}

std::vector<std::string> completions(std::string_view typed, const fs::path& base,
                                     const FolderView& view, std::size_t limit) {
  const std::size_t slash = typed.rfind('/');
  const std::string_view head = typed.substr(0, slash == std::string_view::npos ? 0 : slash + 1);
  const std::string_view tail = typed.substr(head.size());
  const FolderListing listing = readFolder(head.empty() ? base : resolvedPath(head, base));
  FolderView wanted = view;
  wanted.hidden = tail.starts_with(".");
  std::vector<std::string> result;
  for (std::size_t i : shownEntries(listing, wanted)) {
    const std::string name = listing.entries[i].path.filename().native();
    if (!name.starts_with(tail)) continue;
    if (result.size() == limit) break;
    result.push_back(std::string(head) + name + (listing.entries[i].folder ? "/" : ""));
  }
  return result;
}

std::string commonPrefix(const std::vector<std::string>& texts) {
  if (texts.empty()) return {};
  std::string prefix = texts.front();
  for (const std::string& text : texts) {
    const auto end = std::mismatch(prefix.begin(), prefix.end(), text.begin(), text.end()).first;
    prefix.erase(end, prefix.end());
  }
  return prefix;
}

}  // namespace dapple
