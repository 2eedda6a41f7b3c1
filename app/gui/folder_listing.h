// What is in a folder, for people: filtered, sorted, completed. Names keep their bytes, whatever
// they are.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace dapple {

struct FolderEntry {
  std::filesystem::path path;
  std::string shown;  // the name as valid UTF-8
  bool folder = false;
  bool hidden = false;
  std::uint64_t bytes = 0;
  std::filesystem::file_time_type changed{};
};

struct FolderListing {
  std::filesystem::path folder;
  std::vector<FolderEntry> entries;
  std::string error;  // why there are none, with a remedy; empty when it was read
};

enum class FolderOrder { name, size, date };

// Never throws; entries that cannot be looked at count as files of 0 bytes.
FolderListing readFolder(const std::filesystem::path& folder);

struct FolderView {
  std::vector<std::string> extensions;  // ".ply", lower case; empty: all files
  bool hidden = false;
  bool foldersOnly = false;
  FolderOrder order = FolderOrder::name;
  bool descending = false;
};
// Indices of the entries to show, folders first. Numbers in names count as numbers: 2 before 10.
std::vector<std::size_t> shownEntries(const FolderListing& listing, const FolderView& view);

// "~/x" and relative paths from `base`, made absolute and tidy.
std::filesystem::path resolvedPath(std::string_view typed, const std::filesystem::path& base);
// What the last part of the typed path can become, as typed paths, folders with a slash; at most
// `limit`, sorted. Hidden names only behind a typed dot.
std::vector<std::string> completions(std::string_view typed, const std::filesystem::path& base,
                                     const FolderView& view, std::size_t limit = 64);
// Their longest common beginning.
std::string commonPrefix(const std::vector<std::string>& texts);

// Valid UTF-8: each byte that is none becomes U+FFFD.
std::string shownText(std::string_view bytes);
// "1.2 MB"; "2026-03-01 14:05" in local time.
std::string shownSize(std::uint64_t bytes);
std::string shownDate(std::filesystem::file_time_type time);
// The extension in lower case.
std::string lowerExtension(const std::filesystem::path& path);

}  // namespace dapple
