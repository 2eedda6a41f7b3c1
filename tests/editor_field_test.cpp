// The directions that strokes make, and their singularities: found beside the window's thread.
#include <chrono>
#include <set>
#include <thread>

#include "tests/document_fixtures.h"
#include "tests/editor_desk.h"

using namespace dapple;
using namespace dapple::fixtures;

namespace {

constexpr std::size_t kPoints = 4000;

// Until what is found is that of the document.
void find(FieldFinder& finder, const Document& document) {
  finder.follow(document);
  for (int k = 0; k < 20000 && finder.finding(); ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    finder.follow(document);
  }
  REQUIRE_FALSE(finder.finding());
}

double sumOf(const ShownField& field) {
  double sum = 0;
  for (const FieldSingularity& s : field.singularities)
    sum += static_cast<double>(s.index) / s.folds;
  return sum;
}

std::set<std::array<float, 3>> placesOf(const ShownField& field) {
  std::set<std::array<float, 3>> places;
  for (const FieldSingularity& s : field.singularities)
    places.insert({s.position.x, s.position.y, s.position.z});
  return places;
}

Document withMeridian(const Document& document) {
  return applied(document, AddStroke{kUnassigned, meridian(document, 12)});
}

void openSphere(Desk& desk, const TestFolder& folder) {
  desk.gui.drop({writeSphere(folder, kPoints)});
  desk.rest();
  REQUIRE(desk.document().size() == kPoints);
}

void waitForField(Desk& desk) {
  REQUIRE(desk.gui.frameUntil([&] { return !desk.editor.overlays().finding(); }, kPatience));
  desk.rest();
  REQUIRE(desk.editor.overlays().field());
}

// Pixels of the picture's middle part, beside the panels, that are nearly of that colour.
std::size_t pixelsLike(const Image& picture, const vec3& colour) {
  std::size_t count = 0;
  for (int y = 130; y < picture.height - 40; ++y)
    for (int x = 60; x < picture.width - 320; ++x) {
      vec3 pixel;
      for (int c = 0; c < 3; ++c) pixel[c] = picture.at(x, y, c);
      count += glm::length(pixel - colour) < 0.08f;
    }
  return count;
}

// Of the one that is nearest to the eye.
ImVec2 placeOnScreen(Desk& desk, const std::vector<FieldSingularity>& singularities) {
  const SceneView& view = desk.editor.view();
  const PixelView pixels(view.pictureCamera(), view.picture().width, view.picture().height);
  vec3 nearest(0, 0, 1e9f);
  for (const FieldSingularity& s : singularities)
    if (const vec3 at = pixels.project(s.position); at.z < nearest.z) nearest = at;
  const ItemMark* const mark = desk.gui.gui().marks().find("view");
  return {mark->min.x + nearest.x, mark->min.y + nearest.y};
}

}  // namespace

TEST_CASE("the field of the strokes is found without a synthesis") {
  const TestFolder folder;
  const Document sphere = sphereDocument(folder, kPoints);
  FieldFinder finder({});
  CHECK_FALSE(finder.field());
  finder.follow(sphere);
  CHECK(finder.finding());
  find(finder, sphere);
  const auto upright = finder.field();
  REQUIRE(upright->up.size() == kPoints);
  CHECK(upright->singularities.size() == 2);
  CHECK(sumOf(*upright) == 2);
  const std::vector<vec3>& normals = sphere.points().normals;
  float steepest = 0, shortest = 1;
  for (std::size_t i = 0; i < kPoints; ++i) {
    steepest = std::max(steepest, std::abs(glm::dot(upright->up[i], normals[i])));
    shortest = std::min(shortest, glm::length(upright->up[i]));
  }
  CHECK(steepest < 1e-3f);
  CHECK(shortest > 0.999f);

  // Nothing that a field is made of has changed.
  SetRegion other{.region = kUnassigned, .name = "Ball", .visible = false, .borderWidth = 3};
  finder.follow(applied(sphere, other));
  CHECK_FALSE(finder.finding());
  CHECK(finder.field() == upright);

  const Document stroked = withMeridian(sphere);
  find(finder, stroked);
  CHECK(finder.field() != upright);
  CHECK(finder.field()->up != upright->up);
  CHECK(sumOf(*finder.field()) == 2);
  find(finder, sphere);
  CHECK(finder.field()->up == upright->up);
}

TEST_CASE("each region has a field of its own, and one that is as it was is not found again") {
  const TestFolder folder;
  Document document = sphereDocument(folder, kPoints);
  document = applied(document, Select{half(document, true)});
  document = applied(document, AddRegion{});
  const RegionId left = document.regions->back().id;
  FieldFinder finder({});
  find(finder, document);
  const std::vector<vec3> before = finder.field()->up;
  SetRegion turn{.region = left};
  turn.rotation = 90;
  document = applied(document, turn);
  find(finder, document);
  const std::vector<vec3>& after = finder.field()->up;
  float same = 0, turned = 0;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const float cosine = glm::dot(before[i], after[i]);
    if ((*document.labels)[i] == left)
      turned = std::max(turned, std::abs(cosine));
    else
      same = std::max(same, std::abs(cosine - 1));
  }
  CHECK(turned < 1e-3f);
  CHECK(same < 1e-5f);
  for (const FieldSingularity& s : finder.field()->singularities)
    CHECK(findRegion(document, s.region));
}

TEST_CASE("singularities of symmetric fields count in parts of a turn, random fields have none") {
  const TestFolder folder;
  Document document = sphereDocument(folder, kPoints);
  FieldFinder finder({});
  SetRegion set{.region = kUnassigned, .options = TextureOptions{}};
  set.options->symmetry = FieldSymmetry::Quarter;
  document = applied(withMeridian(document), set);
  find(finder, document);
  CHECK(finder.field()->singularities.size() == 8);
  for (const FieldSingularity& s : finder.field()->singularities) CHECK(s.folds == 4);
  CHECK(sumOf(*finder.field()) == 2);
  set.options->field = FieldMethod::Random;
  find(finder, applied(document, set));
  CHECK(finder.field()->singularities.empty());
  CHECK(glm::length(finder.field()->up.front()) > 0.999f);
}

TEST_CASE("what changes while a field is found is followed, and a closed scan is let go") {
  const TestFolder folder;
  Document sphere = sphereDocument(folder, kPoints);
  Document stroked = withMeridian(sphere);
  FieldFinder finder({});
  for (int k = 0; k < 20; ++k) finder.follow(k % 2 == 0 ? sphere : stroked);
  find(finder, stroked);
  FieldFinder fresh({});
  find(fresh, stroked);
  CHECK(finder.field()->up == fresh.field()->up);

  const std::weak_ptr<const OpenedScan> scan = sphere.scan;
  sphere = stroked = {};
  fresh.rest({}), finder.rest({});
  for (int k = 0; k < 20000 && !scan.expired(); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  CHECK(scan.expired());
}

TEST_CASE("singularities are shown while strokes are drawn, and move with a stroke") {
  constexpr vec3 kPositive{1.0f, 0.47f, 0.66f};
  const TestFolder folder;
  Desk desk;
  openSphere(desk, folder);
  const ViewOverlays& overlays = desk.editor.overlays();
  desk.gui.key(Key::numpad7);  // a pole is in sight
  desk.rest();
  CHECK_FALSE(overlays.field());
  CHECK(pixelsLike(desk.gui.picture(), kPositive) == 0);
  desk.gui.key(letterKey('O'));
  waitForField(desk);
  CHECK(overlays.field()->singularities.size() == 2);
  CHECK(overlays.note() == "2 singularities, their indices sum to 2");
  CHECK(pixelsLike(desk.save("singularities"), kPositive) > 30);
  const auto upright = placesOf(*overlays.field());
  const ImVec2 pole = placeOnScreen(desk, overlays.field()->singularities);
  desk.gui.moveMouse(pole);
  desk.gui.frames(2);
  CHECK(desk.gui.has("singularity.label"));
  desk.gui.moveMouse({pole.x + 40, pole.y});
  desk.gui.frames(2);
  CHECK_FALSE(desk.gui.has("singularity.label"));

  const ImVec2 view = desk.gui.at("view");
  desk.gui.drag(0, {view.x - 120, view.y - 30}, {view.x + 120, view.y - 30});
  desk.rest();
  waitForField(desk);
  CHECK(placesOf(*overlays.field()) != upright);
  CHECK(sumOf(*overlays.field()) == 2);
  desk.save("singularities_stroke");
  desk.gui.key(letterKey('Z'), kCtrl);
  desk.rest();
  waitForField(desk);
  CHECK(placesOf(*overlays.field()) == upright);

  desk.gui.click("stroke.field");
  desk.rest();
  CHECK_FALSE(overlays.field());
  CHECK(overlays.note().empty());
  desk.gui.key(letterKey('O'), kShift);  // the view's own switch, whatever the tool
  desk.gui.key(letterKey('B'));
  waitForField(desk);
  CHECK(overlays.note() == "2 singularities, their indices sum to 2");
  desk.gui.key(letterKey('H'));  // what is hidden has none
  desk.rest();
  CHECK(overlays.note() == "No singularities");
}

TEST_CASE("frames go on while a field is found") {
  Desk desk;
  desk.openScan();
  desk.gui.key(letterKey('O'));
  waitForField(desk);
  const ViewOverlays& overlays = desk.editor.overlays();
  const ShownField* const upright = overlays.field();
  const std::vector<vec3> before = upright->up;
  const PointSet& points = desk.document().points();
  Stroke stroke;
  for (const Index i : {Index{100}, desk.document().scan->prepared.neighborhoods.of(100)[20]})
    stroke.points.push_back(i), stroke.positions.push_back(points.positions[i]);
  desk.editor.engine().submit(AddStroke{kUnassigned, stroke});
  desk.editor.engine().finish();
  // The frame that has the stroke does not wait for its field: the old one is shown meanwhile.
  desk.gui.frame();
  CHECK(desk.document().regions->front().strokes);
  CHECK(overlays.finding());
  CHECK(overlays.field() == upright);
  CHECK(overlays.note() == "Finding the directions...");
  waitForField(desk);
  CHECK(overlays.field()->up != before);
  desk.gui.key(letterKey('D'), kShift);
  desk.rest();
  desk.save("directions");
}
