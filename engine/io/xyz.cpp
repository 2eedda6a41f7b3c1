#include "io/xyz.h"

#include <algorithm>
#include <cmath>

#include "base/errors.h"
#include "io/text_numbers.h"
#include "io/text_words.h"

namespace dapple {
namespace {

constexpr CharSet kSeparators(" \t,;\r\v\f");
constexpr std::size_t kMostHeadings = 20;
constexpr double kUnitTolerance = 0.01;  // of the length of a normal written with few digits
constexpr double kEnough = 0.95;         // of the rows, so that a few bad normals do no harm
constexpr const char* kShape = "Each line holds x y z and, if you like, normals and colours.";

// The numbers of a line; false when a word among them is no number.
bool splitNumbers(std::string_view line, std::vector<double>& numbers) {
  numbers.clear();
  for (;;) {
    const std::string_view word = takeWord(line, kSeparators);
    if (word.empty() || word[0] == '#' || word.starts_with("//")) return true;
    double value = 0;
    if (!parseNumber(word, value)) return false;
    numbers.push_back(value);
  }
}

struct Rows {
  std::size_t columns = 0;
  std::vector<double> values;  // rows x columns

  std::size_t count() const { return columns == 0 ? 0 : values.size() / columns; }
  double at(std::size_t row, std::size_t column) const { return values[row * columns + column]; }
};

class RowReader {
 public:
  explicit RowReader(InputFile& file) : file_(file) {}

  Rows read() {
    std::string_view line;
    while (file_.line(line)) readLine(line);
    if (rows_.count() == 0)
      throw IoError(file_.path(), "", "there is no line of three numbers in this file", kShape);
    if (rows_.count() < declared_)
      file_.failAtLine(
          fmt::format("the file declares {} points, but ends after {}", declared_, rows_.count()),
          "It is cut off or damaged. Export or copy it again.");
    return std::move(rows_);
  }

 private:
  void readLine(std::string_view line) {
    if (line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3);
    if (line.find('\0') != line.npos)
      file_.failAtLine("this is no text", "Give the file the extension of its own format.");
    if (line.starts_with('#') || line.starts_with("//")) return;
    if (!splitNumbers(line, numbers_)) {
      if (rows_.columns > 0 || ++headings_ > kMostHeadings)
        file_.failAtLine(fmt::format("\"{}\" is not a row of numbers", line.substr(0, 60)), kShape);
      return;
    }
    if (numbers_.empty()) return;
    if (numbers_.size() == 1) return readCount(numbers_[0]);
    if (numbers_.size() < 3) file_.failAtLine("a point needs three coordinates", kShape);
    if (rows_.columns == 0) rows_.columns = numbers_.size();
    if (numbers_.size() != rows_.columns)
      file_.failAtLine(
          fmt::format("{} numbers here, {} in the lines before", numbers_.size(), rows_.columns),
          kShape);
    rows_.values.insert(rows_.values.end(), numbers_.begin(), numbers_.end());
    if (rows_.count() >= kNone)
      file_.failAtLine(fmt::format("more than the {} points that Dapple works with", kNone - 1),
                       "Split the scan.");
  }

  // A .pts file has one such line before each of its scans.
  void readCount(double count) {
    if (!(count >= 0) || count != std::floor(count))
      file_.failAtLine(fmt::format("{} is neither a point nor a number of points", count), kShape);
    if (count > static_cast<double>(file_.size()))
      file_.failAtLine(
          fmt::format("declares {} points, but the whole file has {} bytes", count, file_.size()),
          "It is cut off or damaged. Export or copy it again.");
    declared_ += static_cast<std::size_t>(count);
  }

  InputFile& file_;
  Rows rows_;
  std::vector<double> numbers_;
  std::size_t headings_ = 0, declared_ = 0;
};

// What three columns beside each other hold, judged by all rows.
struct Triple {
  double smallest = 0, largest = 0;
  bool integers = true;
  bool unit = false;  // nearly all rows have the length 1

  Triple(const Rows& rows, std::size_t first) {
    std::size_t units = 0, counted = 0;
    smallest = largest = rows.at(0, first);
    for (std::size_t r = 0; r < rows.count(); ++r) {
      const dvec3 v(rows.at(r, first), rows.at(r, first + 1), rows.at(r, first + 2));
      for (int c = 0; c < 3; ++c) {
        smallest = std::fmin(smallest, v[c]);
        largest = std::fmax(largest, v[c]);
        integers = integers && v[c] == std::floor(v[c]);
      }
      if (v == dvec3(0)) continue;  // a normal that was not known
      ++counted;
      units += std::abs(glm::length(v) - 1) <= kUnitTolerance;
    }
    unit = counted > 0 && static_cast<double>(units) >= kEnough * static_cast<double>(counted);
  }

  bool isColour() const { return smallest >= 0 && (largest <= 1 || (largest <= 255 && integers)); }
};

template <class T>
void addColumn(Element& element, std::string name, const Rows& rows, std::size_t column) {
  std::vector<T> values(rows.count());
  for (std::size_t r = 0; r < values.size(); ++r) values[r] = static_cast<T>(rows.at(r, column));
  setColumn(element, std::move(name), std::span<const T>(values));
}

class ColumnNamer {
 public:
  ColumnNamer(const Rows& rows, Element& element) : rows_(rows), element_(element) {}

  void run(Monitor& monitor) {
    for (std::size_t c = 0; c < 3; ++c) addColumn<double>(element_, kPosition[c], rows_, c);
    for (std::size_t c = 3; c < rows_.columns;) {
      monitor.checkpoint();
      // x y z intensity r g b: an intensity must not be taken for a red.
      const bool single = (rows_.columns - c) % 3 == 1 && c == 3;
      const bool triple = c + 3 <= rows_.columns && !(single && takeTriple(c + 1, false));
      if (triple && takeTriple(c, true)) {
        c += 3;
      } else {
        addColumn<double>(element_, "column" + std::to_string(c + 1), rows_, c);
        ++c;
      }
    }
  }

 private:
  static constexpr const char* kPosition[] = {"x", "y", "z"};
  static constexpr const char* kNormal[] = {"nx", "ny", "nz"};
  static constexpr const char* kColour[] = {"red", "green", "blue"};

  // True when the columns hold normals or colours, and adds them if asked to.
  bool takeTriple(std::size_t first, bool add) {
    if (first + 3 > rows_.columns) return false;
    const Triple triple(rows_, first);
    const bool isNormal = triple.unit && !element_.find("nx");
    const bool isColour = !isNormal && triple.isColour() && !element_.find("red");
    for (std::size_t c = 0; add && c < 3; ++c) {
      if (isNormal) addColumn<float>(element_, kNormal[c], rows_, first + c);
      if (isColour && triple.largest <= 1)
        addColumn<float>(element_, kColour[c], rows_, first + c);
      else if (isColour)
        addColumn<std::uint8_t>(element_, kColour[c], rows_, first + c);
    }
    return isNormal || isColour;
  }

  const Rows& rows_;
  Element& element_;
};

}  // namespace

bool looksLikeXyz(std::string_view bytes) {
  std::vector<double> numbers;
  for (std::size_t lines = 0; lines < kMostHeadings && !bytes.empty(); ++lines) {
    const auto end = bytes.find('\n');
    const std::string_view line = bytes.substr(0, end);
    if (line.find('\0') != line.npos) return false;
    bytes.remove_prefix(end == bytes.npos ? bytes.size() : end + 1);
    if (line.starts_with('#') || line.starts_with("//")) continue;
    if (splitNumbers(line, numbers) && numbers.size() >= 3) return true;
  }
  return false;
}

RecordTable readXyz(InputFile& file, Monitor& monitor) {
  const Rows rows = RowReader(file).read();
  monitor.checkpoint();
  RecordTable table;
  table.elements.push_back({.name = "vertex", .count = rows.count()});
  ColumnNamer(rows, table.elements.back()).run(monitor);
  return table;
}

}  // namespace dapple
