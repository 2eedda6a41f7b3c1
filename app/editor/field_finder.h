// The directions that the swatches follow as the strokes leave them, before and without any
// synthesis, and their singularities. Of a million points that takes about a second: it is found on
// a thread of its own that gives way to all others. The window's thread only exchanges it.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <vector>

#include "document/document.h"

namespace dapple {

struct FieldSingularity {
  vec3 position;  // on the surface, local units
  RegionId region = kUnassigned;
  int index = 0;  // turns of the direction round it, in `folds`-ths
  int folds = 1;
};

struct ShownField {
  std::shared_ptr<const OpenedScan> scan;
  std::vector<vec3> up;  // n, of the swatches, unit length; zero: not known. Empty: none is
  std::vector<FieldSingularity> singularities;
};

// What a region's field is made of, besides its points.
struct FieldInputs {
  RegionId region = kUnassigned;
  Column<Stroke> strokes;
  FieldOptions options;
  int neighbours = 0;
  double rotation = 0;  // degrees
  bool operator==(const FieldInputs&) const = default;
};

class FieldFinder {
 public:
  // `ready`, if any, is called from the finder's thread when there is something new to follow().
  explicit FieldFinder(std::function<void()> ready);
  ~FieldFinder();

  // Takes what has been found, and has the fields of this document's regions found if they are
  // others than those of the last call: what was being found is given up. Returns at once.
  void follow(const Document& document);
  // Keeps no scan but this any more, without finding anything.
  void rest(const Document& document);

  // The last that has been found; null: none yet.
  const std::shared_ptr<const ShownField>& field() const { return field_; }
  // It is not that of the document yet.
  bool finding() const { return found_ != asked_; }
  // Nobody will tell when it is found.
  bool due() const { return !ready_ && finding(); }

 private:
  class Studio;
  struct Wish {
    std::uint64_t number = 0;
    Document document;  // no more of it than a field is made of
    std::vector<FieldInputs> inputs;
  };
  void ask(const Document& document, std::vector<FieldInputs> inputs);
  void serve();

  const std::function<void()> ready_;
  // Of the window's thread.
  Document followed_;
  const void* source_ = nullptr;  // the last result then: it may know what Auto stands for
  std::vector<FieldInputs> inputs_;
  std::uint64_t asked_ = 0, found_ = 0;  // wishes
  std::shared_ptr<const ShownField> field_;

  std::mutex mutex_;
  std::condition_variable wake_;
  bool quit_ = false;
  std::optional<Wish> wish_;
  std::stop_source stop_;  // of what is being found
  std::uint64_t doneNumber_ = 0;
  std::shared_ptr<const ShownField> done_;
  std::vector<Document> passedOver_;  // to be let go by the finder's thread
  std::thread thread_;
};

}  // namespace dapple
