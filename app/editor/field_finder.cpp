#include "app/editor/field_finder.h"

#include <algorithm>
#include <unordered_map>

#include "base/errors.h"
#include "document/automatic_options.h"
#include "document/region_points.h"
#include "regions/singularities.h"

namespace dapple {
namespace {

std::vector<FieldInputs> inputsOf(const Document& document) {
  std::vector<FieldInputs> inputs;
  for (const Region& region : *document.regions)
    inputs.push_back({.region = region.id,
                      .strokes = region.strokes,
                      .options = fieldOptionsOf(knownOptions(document, region)),
                      .neighbours = region.options.neighbours,
                      .rotation = region.rotation});
  return inputs;
}

Document fieldsPart(const Document& document) {
  Document out;
  out.scan = document.scan, out.labels = document.labels, out.regions = document.regions;
  return out;
}

// A region's field.
struct Found {
  FieldInputs inputs;
  std::vector<Index> points;  // ascending
  std::vector<vec3> up;       // of these
  std::vector<FieldSingularity> singularities;
};

Found find(const Document& document, const FieldInputs& inputs, std::vector<Index> points,
           Monitor& monitor) {
  Found out{.inputs = inputs, .points = std::move(points)};
  Region region = *findRegion(document, inputs.region);
  region.options.symmetry = inputs.options.symmetry;  // Auto's choice, where there is one
  const RegionPoints part(document, region, monitor);
  const std::vector<TangentFrame> frames =
      std::move(fieldOf(part, region, part.strokes(region), monitor).frames);
  for (const TangentFrame& frame : frames) out.up.push_back(frame.t);
  if (inputs.options.method == FieldMethod::Random) return out;  // it is nowhere smooth
  const FieldSymmetry symmetry = inputs.options.symmetry;
  for (const Singularity& s :
       singularities(part.points(), part.neighborhoods(), frames, symmetry, monitor))
    out.singularities.push_back({.position = part.points().positions[s.point],
                                 .region = inputs.region,
                                 .index = s.index,
                                 .folds = foldsOf(symmetry)});
  return out;
}

}  // namespace

// What the finder's thread keeps from one document to the next: a region that is as it was is not
// found again.
class FieldFinder::Studio {
 public:
  std::shared_ptr<const ShownField> make(const Wish& wish, const std::stop_token& stop) {
    const Document& document = wish.document;
    if (document.scan != scan_) known_.clear();
    scan_ = document.scan;
    if (!scan_) return nullptr;
    Monitor monitor(workers_, stop);
    auto out = std::make_shared<ShownField>();
    out->scan = scan_;
    out->up.assign(document.size(), vec3(0));
    std::unordered_map<RegionId, bool> present;
    for (const FieldInputs& inputs : wish.inputs) {
      present[inputs.region] = true;
      add(regionField(document, inputs, monitor), *out);
    }
    std::erase_if(known_, [&](const auto& entry) { return !present.contains(entry.first); });
    return out;
  }

 private:
  const Found& regionField(const Document& document, const FieldInputs& inputs, Monitor& monitor) {
    monitor.checkpoint();
    std::vector<Index> points = pointsOf(document, inputs.region);
    Found& known = known_[inputs.region];
    if (known.inputs == inputs && known.points == points) return known;
    known = {};
    if (points.empty()) return known;
    try {
      known = find(document, inputs, std::move(points), monitor);
    } catch (const InvalidInput&) {  // a synthesis will say why; there is nothing to show
    }
    return known;
  }

  static void add(const Found& found, ShownField& out) {
    for (std::size_t r = 0; r < found.up.size(); ++r) out.up[found.points[r]] = found.up[r];
    out.singularities.insert(out.singularities.end(), found.singularities.begin(),
                             found.singularities.end());
  }

  Workers workers_{0, Priority::Background};
  std::shared_ptr<const OpenedScan> scan_;
  std::unordered_map<RegionId, Found> known_;
};

FieldFinder::FieldFinder(std::function<void()> ready)
    : ready_(std::move(ready)), thread_([this] { serve(); }) {}

FieldFinder::~FieldFinder() {
  {
    const std::lock_guard lock(mutex_);
    quit_ = true;
    stop_.request_stop();
  }
  wake_.notify_all();
  thread_.join();
}

void FieldFinder::follow(const Document& document) {
  {
    const std::lock_guard lock(mutex_);
    if (doneNumber_ != found_) found_ = doneNumber_, field_.swap(done_);
  }
  const auto& sources = document.results.sources;
  const void* source = sources.empty() ? nullptr : sources.back().get();
  if (document.scan == followed_.scan && document.labels == followed_.labels &&
      document.regions == followed_.regions && source == source_)
    return;
  source_ = source;
  std::vector<FieldInputs> inputs = inputsOf(document);
  const bool same =
      document.scan == followed_.scan && document.labels == followed_.labels && inputs == inputs_;
  followed_ = fieldsPart(document);
  if (!same) ask(followed_, std::move(inputs));
}

void FieldFinder::rest(const Document& document) {
  if (!followed_.scan || document.scan == followed_.scan) return;
  followed_ = {};
  field_ = nullptr;
  ask(followed_, {});
}

void FieldFinder::ask(const Document& document, std::vector<FieldInputs> inputs) {
  inputs_ = inputs;
  {
    const std::lock_guard lock(mutex_);
    if (wish_) passedOver_.push_back(std::move(wish_->document));
    wish_ = Wish{++asked_, document, std::move(inputs)};
    stop_.request_stop();
  }
  wake_.notify_all();
}

void FieldFinder::serve() {
  setPriority(Priority::Background);
  Studio studio;
  for (;;) {
    Wish wish;
    std::stop_token stop;
    std::vector<Document> passedOver;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [&] { return quit_ || wish_; });
      if (quit_) return;
      wish = std::move(*wish_);
      wish_.reset();
      passedOver.swap(passedOver_);
      stop_ = std::stop_source();
      stop = stop_.get_token();
    }
    std::shared_ptr<const ShownField> made;
    try {
      made = studio.make(wish, stop);
    } catch (const Cancelled&) {
      continue;
    } catch (const std::exception&) {  // such as too little memory: then nothing is shown
    }
    {
      const std::lock_guard lock(mutex_);
      done_.swap(made);
      doneNumber_ = wish.number;
    }
    if (ready_) ready_();
  }
}

}  // namespace dapple
