// Prints how long a person waits for the editor's window with a scan of 1 M points, each figure
// beside what is asked for: the whole program but its GLFW window, drawn by OSMesa at 1280 x 800.
// What the engine takes alone is dapple_document_bench's.
//
// dapple_editor_bench [--points N] [--seconds N] [--scan FILE] [--only PART]...
// Parts: open frames tools field minute previews cancel memory idle sample
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <set>

#include "bench/editor_loop.h"
#include "io/ply.h"
#include "tests/fixtures.h"

namespace {

using namespace dapple;
namespace fs = std::filesystem;

constexpr int kWidth = 1280, kHeight = 800;
constexpr int kRuns = 5;

struct Request {
  std::size_t points = 1'000'000;
  double seconds = 60;
  fs::path scan;  // empty: a bumpy ball
  std::set<std::string> only;

  bool wants(const std::string& part) const { return only.empty() || only.count(part) > 0; }
};

double processSeconds() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(use.ru_utime) + seconds(use.ru_stime);
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

double median(const std::vector<double>& values) {
  return quantile(values, 0.5);
}

void print(const std::string& what, double value, const std::string& unit,
           const std::string& target = "") {
  fmt::print("{:<58} {:>9.1f} {:<5} {}\n", what, value, unit, target);
  std::fflush(stdout);
}

// ---- the scan --------------------------------------------------------------------------------

float bumpyRadius(const vec3& direction) {
  const vec3 wave = glm::sin(vec3(9, 8, 7) * direction);
  return 1 + 0.06f * wave.x * wave.y * wave.z + 0.02f * std::sin(31 * direction.x);
}

// Across the surface r(u) u: u less the slope of r along the sphere, over r.
vec3 bumpyNormal(const vec3& u) {
  constexpr float kStep = 1e-3f;
  const vec3 a =
      glm::normalize(glm::cross(u, std::abs(u.x) < 0.7f ? vec3(1, 0, 0) : vec3(0, 1, 0)));
  const vec3 b = glm::cross(u, a);
  const auto slope = [&](const vec3& d) {
    return (bumpyRadius(glm::normalize(u + kStep * d)) -
            bumpyRadius(glm::normalize(u - kStep * d))) /
           (2 * kStep);
  };
  return glm::normalize(u - (slope(a) * a + slope(b) * b) / bumpyRadius(u));
}

fs::path writeBall(std::size_t count) {
  PointSet ball = fixtures::makeSphere(count, 1);
  for (std::size_t i = 0; i < count; ++i) {
    const vec3 u = ball.positions[i];
    ball.positions[i] = bumpyRadius(u) * u;
    ball.normals[i] = bumpyNormal(u);
  }
  Element vertices{.name = "vertex", .count = count};
  std::vector<float> column(count);
  static constexpr const char* kNames[] = {"x", "y", "z", "nx", "ny", "nz"};
  for (int c = 0; c < 6; ++c) {
    for (std::size_t i = 0; i < count; ++i)
      column[i] = c < 3 ? ball.positions[i][c] : ball.normals[i][c - 3];
    setColumn(vertices, kNames[c], column);
  }
  static constexpr const char* kColours[] = {"red", "green", "blue"};
  std::vector<std::uint8_t> level(count);
  for (int c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < count; ++i)
      level[i] = static_cast<std::uint8_t>(127 + 100 * ball.positions[i][c] / 1.1f);
    setColumn(vertices, kColours[c], level);
  }
  RecordTable table;
  table.elements.push_back(std::move(vertices));
  const fs::path path = fs::temp_directory_path() / "dapple_editor_bench.ply";
  Workers workers;
  Monitor monitor(workers);
  savePly(path, table, false, monitor);
  return path;
}

// ---- one editor ------------------------------------------------------------------------------

class Bench {
 public:
  explicit Bench(const Request& request)
      : request_(request), loop_(DAPPLE_ASSETS, kWidth, kHeight) {
    loop_.rest();
    view_ = loop_.gui().at("view");
  }

  void open(const fs::path& scan);
  void prepare() {
    submit(SetSwatch{kUnassigned, {std::string(DAPPLE_ASSETS) + "/swatches/pebbles.png", {}}});
  }
  void tools();
  void field();
  void cancel();
  void previews();
  void minute();
  void frames();
  void work(const char* what);
  void memory();
  void idle();

 private:
  Engine& engine() { return loop_.editor().engine(); }
  const Snapshot& shown() { return loop_.editor().snapshot(); }
  ImVec2 inView(float x, float y) const { return {view_.x + x, view_.y + y}; }
  void submit(Command command) {
    engine().submit(std::move(command));
    loop_.rest();
  }
  void press(Key key, unsigned modifiers = 0) {
    loop_.plan(loop_.now(), key, modifiers);
    loop_.rest();
  }
  void setMethod(Method method);
  struct Waited {
    double snapshot = 0, picture = 0;
  };
  Waited waitFor(Part part, double from);
  void gesture(const char* what, const std::function<double()>& plan);
  void preview(Method method, const char* name);
  double planScene(double at, int turn);
  void printFrames(const char* when);

  const Request request_;
  EditorLoop loop_;
  ImVec2 view_;
};

void Bench::open(const fs::path& scan) {
  std::vector<double> first, ready;
  const auto timed = [&] {
    loop_.rest();
    const double start = loop_.now();
    const auto before = shown().document.scan;
    loop_.plan(start, FilesDropped{{scan}});
    const bool wasEmpty = loop_.editor().view().empty();
    if (wasEmpty) {
      loop_.turnUntil([&] { return !loop_.editor().view().empty(); });
      first.push_back(loop_.now() - start);
    }
    loop_.turnUntil([&] { return shown().document.scan && shown().document.scan != before; });
    loop_.rest();
    ready.push_back(loop_.now() - start);
  };
  timed();
  for (int run = 1; request_.wants("open") && run < 3; ++run) {
    engine().submit(GoTo{0});
    timed();
  }
  print("drop of the file to the first picture", median(first), "ms", "<= 1000 ms");
  print("  ... to all of it, ready to work on", median(ready), "ms");
}

void Bench::setMethod(Method method) {
  TextureOptions options;
  options.method = method;
  submit(SetRegion{.region = kUnassigned, .options = options});
}

// From the event at `from` to the snapshot that has the effect, and to the picture of it.
Bench::Waited Bench::waitFor(Part part, double from) {
  Waited waited;
  const std::uint64_t before = shown().of(part);
  loop_.turnUntil([&] {
    if (waited.snapshot == 0 && engine().snapshot()->of(part) != before)
      waited.snapshot = loop_.now() - from;
    return loop_.editor().view().paintedVersion(part) != before;
  });
  waited.picture = loop_.now() - from;
  return waited;
}

// `plan` plans the gesture and returns when its last event, which selects, is made.
void Bench::gesture(const char* what, const std::function<double()>& plan) {
  std::vector<double> snapshot, picture;
  std::size_t count = 0;
  for (int run = 0; run < kRuns; ++run) {
    const double end = plan();
    const Waited waited = waitFor(Part::Selection, end);
    snapshot.push_back(waited.snapshot), picture.push_back(waited.picture);
    loop_.rest();
    count = shown().document.selection ? shown().document.selection->count() : 0;
    press(letterKey('A'), kCtrl | kShift);
  }
  print(fmt::format("{}, {} k points: in a snapshot", what, count / 1000), median(snapshot), "ms",
        "<= 100 ms");
  print("  ... to the picture of it", median(picture), "ms", "<= 100 ms");
}

void Bench::tools() {
  const auto press0 = [&](double at, bool down) { loop_.plan(at, MouseButtonChanged{0, down}); };
  press(letterKey('B'));
  loop_.does("brush");
  loop_.forget();
  gesture("brush", [&] {
    double t = loop_.now();
    loop_.plan(t, MouseMoved{inView(-150, -100).x, inView(-150, -100).y});
    press0(t + 20, true);
    t = loop_.planMove(t + 40, inView(-150, -100), inView(150, 100), 600);
    press0(t + 8, false);
    return t + 8;
  });
  std::vector<double> echo;
  for (const FrameRecord& frame : loop_.frames())
    if (frame.oldest > 0) echo.push_back(frame.oldest);
  print("brush echo: mouse to the picture, median", median(echo), "ms", "<= 50 ms");
  print("  ... longest", quantile(echo, 1), "ms");
  press(letterKey('L'));
  gesture("lasso", [&] {
    double t = loop_.now();
    loop_.plan(t, MouseMoved{inView(-200, -200).x, inView(-200, -200).y});
    press0(t + 20, true);
    t = loop_.planMove(t + 40, inView(-200, -200), inView(200, -180), 150);
    t = loop_.planMove(t, inView(200, -180), inView(180, 200), 150);
    t = loop_.planMove(t, inView(180, 200), inView(-190, 190), 150);
    press0(t + 8, false);
    return t + 8;
  });
  press(letterKey('W'));
  for (const int by : {0, 1, 2}) {
    loop_.plan(loop_.now(), MouseMoved{view_.x, view_.y});
    const ImVec2 at = loop_.gui().at(fmt::format(
        "by.{}", std::array{"Normal", "Colour", "Distance"}[static_cast<std::size_t>(by)]));
    loop_.gui().click(at);
    loop_.rest();
    static constexpr const char* kNames[] = {"wand by normal", "wand by colour",
                                             "wand by distance"};
    gesture(kNames[by], [&] {
      const double t = loop_.now();
      loop_.plan(t, MouseMoved{view_.x, view_.y});
      press0(t + 30, true);
      press0(t + 60, false);
      return t + 30;
    });
  }
  press(letterKey('B'));
  std::vector<double> undo;
  for (int run = 0; run < kRuns; ++run) {
    submit(SelectAll{});
    const double t = loop_.now();
    loop_.plan(t, letterKey('Z'), kCtrl);
    undo.push_back(waitFor(Part::Selection, t).picture);
    loop_.rest();
  }
  print("undo of a selection of all, to the picture", median(undo), "ms", "<= 100 ms");
}

// Strokes, each with the camera turning until its directions and singularities are found.
void Bench::field() {
  const ViewOverlays& overlays = loop_.editor().overlays();
  const auto found = [&] { return overlays.field() && !overlays.finding(); };
  const auto drag = [&](int which, ImVec2 from, ImVec2 to, double duration) {
    loop_.plan(loop_.now(), MouseMoved{from.x, from.y});
    loop_.plan(loop_.now() + 20, MouseButtonChanged{which, true});
    const double end = loop_.planMove(loop_.now() + 30, from, to, duration);
    loop_.plan(end + 8, MouseButtonChanged{which, false});
    return end + 8;
  };
  press(letterKey('O'));
  loop_.turnUntil(found);
  loop_.forget();
  std::vector<double> took;
  for (int run = 0; run < kRuns; ++run) {
    const float y = 60.f * static_cast<float>(run - kRuns / 2);
    const double end = drag(0, inView(-150, y), inView(150, y + 40), 300);
    loop_.turnUntil([&] { return loop_.now() > end && overlays.finding(); }, 2000);
    loop_.does("orbit, a field being found");
    drag(1, inView(-100, 0), inView(100, 20), 600);
    loop_.turnUntil(found);
    took.push_back(loop_.now() - end);
    loop_.turnUntil([&] { return !loop_.planned(); });
    loop_.rest();
  }
  print("end of a stroke to the picture of its directions", median(took), "ms");
  printFrames("with strokes and fields being found");
  press(letterKey('B'));
}

void Bench::cancel() {
  for (const auto& [method, name] :
       {std::pair(Method::Patches, "patches"), std::pair(Method::Match, "match"),
        std::pair(Method::Hybrid, "hybrid")}) {
    setMethod(method);
    const double begin = loop_.now();
    submit(Synthesize{});
    const double total = loop_.now() - begin;
    submit(Undo{});
    std::vector<double> took;
    for (int run = 0; run < 2 * kRuns; ++run) {
      const double t = loop_.now() + total * (run + 0.5) / (2 * kRuns);
      engine().submit(Synthesize{});
      loop_.plan(t, Key::escape, 0);
      loop_.turnUntil([&] { return loop_.now() >= t; });
      if (!engine().status().busy) {  // done before
        submit(Undo{});
        continue;
      }
      loop_.turnUntil([&] {
        const auto now = engine().snapshot();
        return now->previewColour == nullptr &&
               loop_.editor().view().paintedVersion(Part::Preview) == now->of(Part::Preview);
      });
      took.push_back(loop_.now() - t);
      loop_.rest();
    }
    print(fmt::format("Esc to the picture as before, {}: longest of {}", name, took.size()),
          quantile(took, 1), "ms", "<= 100 ms");
  }
}

void Bench::preview(Method method, const char* name) {
  setMethod(method);
  const double begin = loop_.now();
  engine().submit(Synthesize{});
  loop_.turnUntil([&] { return shown().previewColour != nullptr; });
  const double start = loop_.now();
  double last = start, longest = 0, longestAt = 0;
  std::size_t pictures = 0;
  const auto painted = [&] { return loop_.editor().view().paintedVersion(Part::Preview); };
  std::uint64_t seen = painted();
  loop_.turnUntil([&] {
    if (const std::uint64_t now = painted(); now != seen) {
      seen = now;
      ++pictures;
      const double t = loop_.now();
      if (t - last > longest) longest = t - last, longestAt = last - start;
      last = t;
    }
    return !engine().status().busy;
  });
  const double total = loop_.now() - start;
  print(fmt::format("live preview, {}: pictures a second", name),
        1e3 * static_cast<double>(pictures) / total, "Hz", ">= 5 Hz");
  print(fmt::format("  ... longest gap, {:.1f} s into {:.1f} s", longestAt / 1e3, total / 1e3),
        longest, "ms", "<= 200 ms");
  print("  ... the first after", start - begin, "ms");
  loop_.rest();
  const double t = loop_.now();
  loop_.plan(t, letterKey('Z'), kCtrl);
  print("  ... undo of all of it, to the picture", waitFor(Part::Colour, t).picture, "ms",
        "<= 100 ms");
  loop_.rest();
}

void Bench::previews() {
  preview(Method::Patches, "patches");
  preview(Method::Match, "match");
  preview(Method::Hybrid, "hybrid");
}

// Some ten seconds of a person's work; returns when they end.
double Bench::planScene(double t, int turn) {
  const auto button = [&](double at, int which, bool down) {
    loop_.plan(at, MouseButtonChanged{which, down});
  };
  const float side = turn % 2 == 0 ? 1.f : -1.f;
  const auto drag = [&](int which, ImVec2 from, ImVec2 to, double duration) {
    t = loop_.planMove(t, from, from, 16);
    button(t, which, true);
    t = loop_.planMove(t, from, to, duration);
    button(t, which, false);
    t += 150;
  };
  drag(1, inView(-200, 30 * side), inView(250, -40 * side), 1500);  // orbit
  drag(0, inView(-150, -100), inView(150, 100 * side), 1200);       // brush
  drag(0, inView(100, -150), inView(-60, 50 * side), 700);
  for (int notch = 0; notch < 6; ++notch) loop_.plan(t += 60, WheelTurned{0, side});
  t += 200;
  drag(1, inView(150, 30), inView(-250, 60 * side), 1200);
  loop_.plan(t, letterKey('A'), kCtrl | kShift);
  t += 250;
  loop_.plan(t, letterKey('K'), kCtrl);  // the search, over the picture
  for (const char c : {'b', 'r', 'u', 's', 'h'})
    loop_.plan(t += 90, CharacterTyped{static_cast<unsigned>(c)});
  loop_.plan(t += 300, Key::escape, 0);
  t += 200;
  t = loop_.planMove(t, inView(0, 0), {kWidth - 60, 120}, 300);  // over the panels
  t = loop_.planMove(t, {kWidth - 60, 120}, {kWidth - 200, 700}, 900);
  for (int notch = 0; notch < 8; ++notch)
    loop_.plan(t += 50, WheelTurned{0, notch < 4 ? -1.f : 1.f});
  loop_.plan(t += 200, letterKey('Z'), kCtrl);
  loop_.plan(t += 400, letterKey('Z'), kCtrl);
  return t + 600;
}

void Bench::printFrames(const char* when) {
  std::vector<double> wall, cpu;
  const FrameRecord* longest = nullptr;
  for (const FrameRecord& frame : loop_.frames()) {
    wall.push_back(frame.wall), cpu.push_back(frame.cpu);

    if (!longest || frame.wall > longest->wall) longest = &frame;
  }
  if (!longest) return;
  const auto over = std::count_if(wall.begin(), wall.end(), [](double w) { return w > 33; });
  print(fmt::format("longest of {} frames {}", wall.size(), when), longest->wall, "ms", "<= 33 ms");
  fmt::print("  (during {}; new: {}; {:.1f} ms of it at work in this thread)\n", longest->activity,
             longest->news.empty() ? "nothing" : longest->news, longest->cpu);
  print("  ... 99 % are below", quantile(wall, 0.99), "ms");
  print("  ... half are below", median(wall), "ms");
  print("  ... longer than 33 ms", static_cast<double>(over), "");
  print("  ... longest work of this thread in a frame", quantile(cpu, 1), "ms");
}

// What no other program on the machine changes much.
void Bench::work(const char* what) {
  std::vector<double> all, paint;
  for (const FrameRecord& frame : loop_.frames())
    all.push_back(frame.process), paint.push_back(frame.paint);
  print(fmt::format("processor time of a frame {}, all threads", what), median(all), "ms");
  print("  ... of that OpenGL in software", median(paint), "ms");
}

void Bench::frames() {
  loop_.forget();
  loop_.plan(loop_.now(), MouseMoved{view_.x - 200, view_.y});
  loop_.plan(loop_.now() + 16, MouseButtonChanged{1, true});
  double t = loop_.planMove(loop_.now() + 30, inView(-200, 0), inView(200, 50), 2000);
  loop_.plan(t, MouseButtonChanged{1, false});
  loop_.turnUntil([&] { return !loop_.planned(); });
  work("while the camera turns");
  loop_.rest();
  loop_.forget();
  press(letterKey('B'));
  t = loop_.now();
  loop_.plan(t, MouseMoved{view_.x - 150, view_.y - 100});
  loop_.plan(t + 20, MouseButtonChanged{0, true});
  t = loop_.planMove(t + 40, inView(-150, -100), inView(150, 100), 2000);
  loop_.turnUntil([&] { return !loop_.planned(); });
  work("of brushing");
  loop_.plan(t, MouseButtonChanged{0, false});
  loop_.rest();
}

void Bench::minute() {
  prepare();  // whatever was undone before
  press(letterKey('B'));
  loop_.forget();
  const double end = loop_.now() + 1e3 * request_.seconds;
  std::size_t syntheses = 0;
  for (int turn = 0; loop_.now() < end; ++turn) {
    TextureOptions options;
    options.method = std::array{Method::Hybrid, Method::Match, Method::Patches}[turn % 3];
    engine().submit(SetRegion{.region = kUnassigned, .options = options});
    const double done = planScene(loop_.now() + 100, turn);
    loop_.turnUntil(
        [&] {
          if (!engine().status().busy) engine().submit(Synthesize{}), ++syntheses;
          return loop_.now() > done;
        },
        1e6);
  }
  printFrames(fmt::format("of {:.0f} s, {} syntheses", request_.seconds, syntheses).c_str());
  engine().cancel();
  loop_.rest();
}

// A region of the half that is seen, textured: the scan, what it shows and what can be undone.
void Bench::memory() {
  submit(GoTo{1});
  std::vector<Index> half;
  const auto& positions = shown().document.points().positions;
  for (Index i = 0; i < positions.size(); ++i)
    if (positions[i].z > 0) half.push_back(i);
  submit(Select{std::move(half)});
  submit(AddRegion{});
  submit(SetSwatch{1, {std::string(DAPPLE_ASSETS) + "/swatches/pebbles.png", {}}});
  submit(Synthesize{RegionId{1}});
  const double points = static_cast<double>(shown().document.size());
  print("memory with results and history of one region, a point",
        static_cast<double>(engine().status().historyBytes) / points, "bytes", "<= 250");
  print("  ... of that the scan",
        static_cast<double>(
            ownBytes(Document{.scan = shown().document.scan, .regions = emptyDocument().regions},
                     emptyDocument())) /
            points,
        "bytes");
  submit(GoTo{1});
}

void Bench::idle() {
  loop_.rest();
  loop_.turnUntil([] { return false; }, 6000);  // notices fade
  loop_.forget();
  const double cpu = processSeconds();
  loop_.turnUntil([] { return false; }, 5000);
  print("frames in 5 s without input", static_cast<double>(loop_.frames().size()), "", "0");
  print("  ... processor time", 1e3 * (processSeconds() - cpu), "ms", "~0");
}

// From a fresh start: the window is there, the sample is clicked on.
void sample() {
  EditorLoop loop(DAPPLE_ASSETS, kWidth, kHeight);
  loop.rest();
  const ImVec2 at = loop.gui().at("start.open-sample");
  const double t = loop.now() + 50;
  loop.plan(t - 30, MouseMoved{at.x, at.y});
  loop.plan(t, MouseButtonChanged{0, true});
  loop.plan(t + 20, MouseButtonChanged{0, false});
  loop.turnUntil([&] { return loop.editor().snapshot().document.results.colour != nullptr; });
  loop.rest();
  print("click on the sample to the textured result", loop.now() - t, "ms", "<= 10000 ms");
}

Request parsed(int argc, char** argv) {
  Request request;
  for (int a = 1; a + 1 < argc; a += 2) {
    const std::string name = argv[a], value = argv[a + 1];
    if (name == "--points") request.points = std::stoul(value);
    if (name == "--seconds") request.seconds = std::stod(value);
    if (name == "--scan") request.scan = value;
    if (name == "--only") request.only.insert(value);
  }
  return request;
}

}  // namespace

int main(int argc, char** argv) {
  const Request request = parsed(argc, argv);
  if (request.wants("sample")) sample();
  const fs::path scan = request.scan.empty() ? writeBall(request.points) : request.scan;
  {
    Bench bench(request);
    bench.open(scan);
    // First: the minute's syntheses push the scan as it was opened out of the history.
    if (request.wants("memory")) bench.memory();
    bench.prepare();
    if (request.wants("frames")) bench.frames();
    if (request.wants("tools")) bench.tools();
    if (request.wants("field")) bench.field();
    if (request.wants("previews")) bench.previews();
    if (request.wants("cancel")) bench.cancel();
    if (request.wants("minute")) bench.minute();
    if (request.wants("idle")) bench.idle();
  }
  if (request.scan.empty()) fs::remove(scan);
}
