// The panels: what they show, and what comes of using them.
#include "tests/document_fixtures.h"
#include "tests/editor_desk.h"
#include "tests/fixtures.h"

using namespace dapple;

namespace {

void textured(Desk& desk, const std::string& swatch = "swatch.bricks") {
  desk.openScan();
  desk.gui.click(swatch);
  desk.rest();
}

// The brushed part as a region.
RegionId bodyRegion(Desk& desk) {
  desk.brushBody();
  desk.gui.key(letterKey('G'), kCtrl);
  desk.rest();
  desk.gui.key(letterKey('A'), kCtrl | kShift);
  desk.rest();
  return desk.document().regions->back().id;
}

const Region& first(Desk& desk) {
  return desk.document().regions->front();
}

}  // namespace

TEST_CASE("a new region is the chosen one, and what is dropped on a part is for that part") {
  Desk desk;
  textured(desk);
  const RegionId body = bodyRegion(desk);
  desk.gui.click("swatch.pebbles");
  desk.rest();
  CHECK(findRegion(desk.document(), body)->reference.path == asset("swatches/pebbles.png"));
  CHECK(first(desk).reference.path == asset("swatches/bricks.png"));
  // Beside the brushed band, on the rest.
  const ImVec2 view = desk.gui.at("view");
  desk.gui.moveMouse({view.x, view.y + 75});
  desk.gui.drop({asset("swatches/wood.png")});
  desk.rest();
  CHECK(first(desk).reference.path == asset("swatches/wood.png"));
  desk.gui.moveMouse({view.x, view.y - 10});
  desk.gui.drop({asset("swatches/scales.png")});
  desk.rest();
  CHECK(findRegion(desk.document(), body)->reference.path == asset("swatches/scales.png"));
  desk.save("regions");
}

TEST_CASE("a folder that is dropped is the region's swatch with its channels") {
  const fixtures::TestFolder folder;
  const std::filesystem::path stone = folder / "stone";
  std::filesystem::create_directory(stone);
  for (const char* ending : {"diff", "nor_gl", "rough"})
    writeImage(stone / fmt::format("stone_{}_1k.png", ending), fixtures::noise(48));
  Desk desk;
  desk.openScan();
  desk.gui.drop({stone});
  desk.rest();
  const SwatchReference& swatch = first(desk).reference;
  CHECK(swatch.path == stone / "stone_diff_1k.png");
  CHECK(swatch.channels[Channel::Normal] == stone / "stone_nor_gl_1k.png");
  CHECK(swatch.channels[Channel::Roughness] == stone / "stone_rough_1k.png");
  CHECK(swatch.channels[Channel::Height].empty());
  CHECK(!swatch.channels.greenDown);
  REQUIRE(first(desk).maps);
  CHECK(first(desk).swatch->pixels() == 48 * 48);
}

TEST_CASE("a region is renamed where its name stands, and shown alone") {
  Desk desk;
  desk.openScan();
  const RegionId body = bodyRegion(desk);
  desk.gui.doubleClick(desk.gui.at(fmt::format("region.row.{}", body)));
  desk.gui.settle();
  REQUIRE(desk.gui.has("region.name"));
  desk.gui.type("Belly");
  desk.gui.key(Key::enter);
  desk.rest();
  CHECK(findRegion(desk.document(), body)->name == "Belly");
  CHECK_FALSE(desk.gui.has("region.name"));
  desk.gui.key(Key::f2);
  desk.gui.type("Nothing");
  desk.gui.key(Key::escape);
  desk.rest();
  CHECK(findRegion(desk.document(), body)->name == "Belly");
  desk.gui.key(Key::slash);
  desk.rest();
  CHECK_FALSE(first(desk).visible);
  CHECK(findRegion(desk.document(), body)->visible);
  desk.save("isolated");
  desk.gui.key(Key::slash);
  desk.rest();
  CHECK(first(desk).visible);
  desk.gui.click(fmt::format("region.row.{}", body), 1);
  desk.gui.settle();
  desk.save("region_menu");
  desk.gui.click("region.menu.Remove");
  desk.rest();
  CHECK(desk.document().regions->size() == 1);
}

TEST_CASE("a part of the picture is taken as the swatch, moved, and given back") {
  Desk desk;
  textured(desk);
  const ItemMark* mark = desk.gui.gui().marks().find("swatch.crop");
  REQUIRE(mark);
  const ImVec2 min = mark->min, size(mark->max.x - min.x, mark->max.y - min.y);
  const auto at = [&](float x, float y) { return ImVec2(min.x + x * size.x, min.y + y * size.y); };
  const Image& whole = *first(desk).image;
  desk.gui.drag(0, at(0.25f, 0.25f), at(0.75f, 0.5f));
  desk.rest();
  REQUIRE(first(desk).reference.crop);
  const PixelRect crop = *first(desk).reference.crop;
  const auto w = static_cast<float>(whole.width), h = static_cast<float>(whole.height);
  CHECK(static_cast<float>(crop.x) == doctest::Approx(w / 4).epsilon(0.05));
  CHECK(static_cast<float>(crop.width) == doctest::Approx(w / 2).epsilon(0.05));
  CHECK(static_cast<float>(crop.height) == doctest::Approx(h / 4).epsilon(0.05));
  CHECK(first(desk).image->width == crop.width);
  desk.save("crop");
  desk.gui.drag(0, at(0.5f, 0.375f), at(0.5f, 0.625f));  // inside: moved
  desk.rest();
  const PixelRect moved = *first(desk).reference.crop;
  CHECK(moved.width == crop.width);
  CHECK(moved.height == crop.height);
  CHECK(moved.x == crop.x);
  CHECK(static_cast<float>(moved.y - crop.y) == doctest::Approx(h / 4).epsilon(0.05));
  desk.gui.doubleClick(at(0.5f, 0.5f));
  desk.rest();
  CHECK_FALSE(first(desk).reference.crop);
  CHECK(first(desk).image->width == whole.width);
  desk.gui.key(letterKey('Z'), kCtrl);
  desk.rest();
  CHECK(first(desk).reference.crop == moved);
}

TEST_CASE("live, the scale acts while it is dragged and is one step of the history") {
  Desk desk(1, kWidth, kHeight, true);
  textured(desk);
  REQUIRE(desk.document().results.colour);
  const Document before = desk.document();
  const std::size_t steps = desk.editor.snapshot().history->size();
  const ItemMark* mark = desk.gui.gui().marks().find("swatch.scale");
  REQUIRE(mark);
  const float y = 0.5f * (mark->min.y + mark->max.y), middle = 0.5f * (mark->min.x + mark->max.x);
  desk.gui.moveMouse({middle, y});
  desk.gui.press(0);
  desk.gui.moveMouse({middle + 30, y});
  CHECK(desk.gui.frameUntil([&] {
    return desk.document().results.colour != before.results.colour ||
           desk.editor.snapshot().previewColour;
  }));
  desk.save("live_scale");
  desk.gui.moveMouse({middle + 50, y});
  desk.gui.release(0);
  desk.rest();
  CHECK(first(desk).options.scale > 2);
  CHECK(desk.document().results.sources.front()->options.scale == first(desk).options.scale);
  CHECK(desk.editor.snapshot().history->size() == steps + 1);
  desk.save("live");
  desk.gui.key(letterKey('Z'), kCtrl);
  desk.rest();
  CHECK(sameContent(desk.document(), before));
}

TEST_CASE("live, the kind of a border is chosen and its width acts while it is dragged") {
  Desk desk(1, kWidth, kHeight, true);
  textured(desk);
  Engine& engine = desk.editor.engine();
  std::vector<Index> left;
  for (Index i = 0; i < desk.document().size(); ++i)
    if (desk.document().points().positions[i].x < 0) left.push_back(i);
  engine.submit(Select{.points = left});
  engine.submit(AddRegion{});
  engine.submit(SetSwatch{.region = 1, .reference = first(desk).reference});
  engine.finish();
  desk.rest();
  const auto chosen = [&]() -> const Region& { return *findRegion(desk.document(), RegionId{1}); };
  REQUIRE(desk.document().results.border);
  CHECK(chosen().borderKind == BorderKind::Cut);
  desk.gui.click("border.Hard");
  desk.rest();
  CHECK(chosen().borderKind == BorderKind::Hard);
  CHECK_FALSE(desk.document().results.border);
  CHECK_FALSE(desk.gui.has("swatch.border"));
  desk.gui.click("border.Blend");
  desk.rest();
  CHECK(chosen().borderKind == BorderKind::Blend);
  REQUIRE(desk.document().results.border);
  const std::size_t wide = desk.document().results.border->points.size();
  const std::size_t steps = desk.editor.snapshot().history->size();
  const ItemMark* mark = desk.gui.gui().marks().find("swatch.border");
  REQUIRE(mark);
  const float y = 0.5f * (mark->min.y + mark->max.y);
  desk.gui.drag(0, {mark->min.x + 60, y}, {mark->min.x + 20, y});
  desk.rest();
  CHECK(chosen().borderWidth < 16);
  CHECK(desk.editor.snapshot().history->size() == steps + 1);
  CHECK(desk.document().results.border->points.size() < wide);
  desk.gui.moveMouse(desk.gui.at("view"));
  desk.gui.frames(2);
  desk.save("border");
  desk.gui.key(letterKey('Z'), kCtrl);
  desk.gui.key(letterKey('Z'), kCtrl);
  desk.rest();
  CHECK(chosen().borderKind == BorderKind::Hard);
}

TEST_CASE("a stroke is drawn, chosen by a click, turned round and removed") {
  Desk desk(1, kWidth, kHeight, true);
  textured(desk, "swatch.scales");
  const ImVec2 view = desk.gui.at("view");
  desk.gui.key(letterKey('O'));
  desk.gui.drag(0, {view.x - 100, view.y}, {view.x + 60, view.y - 20});
  desk.rest();
  REQUIRE(first(desk).strokes);
  const Stroke drawn = first(desk).strokes->front();
  desk.gui.click(ImVec2(view.x - 20, view.y - 10));
  desk.rest();
  CHECK(first(desk).strokes->size() == 1);
  REQUIRE(desk.gui.has("stroke.remove"));
  desk.save("stroke");
  desk.gui.click("stroke.reverse");
  desk.rest();
  CHECK(first(desk).strokes->front().positions.front() == drawn.positions.back());
  desk.gui.key(Key::del);
  desk.rest();
  CHECK_FALSE(first(desk).strokes);
  CHECK_FALSE(desk.gui.has("stroke.remove"));
  desk.gui.key(letterKey('Z'), kCtrl);
  desk.gui.key(letterKey('Z'), kCtrl);
  desk.rest();
  CHECK(first(desk).strokes->front() == drawn);
  desk.gui.click(ImVec2(view.x - 20, view.y + 200));  // beside it
  CHECK_FALSE(desk.gui.has("stroke.remove"));
}

TEST_CASE("a stroke's scale is dragged, typed and reset, each in one step of the history") {
  Desk desk;
  desk.openScan();
  const ImVec2 view = desk.gui.at("view");
  desk.gui.key(letterKey('O'));
  desk.gui.drag(0, {view.x - 100, view.y}, {view.x + 60, view.y - 20});
  desk.rest();
  desk.gui.click(ImVec2(view.x - 20, view.y - 10));
  desk.rest();
  const Stroke drawn = first(desk).strokes->front();
  const std::size_t steps = desk.editor.snapshot().history->size();
  const auto resets = [&] { return desk.gui.gui().marks().find("stroke.reset-scale")->enabled; };
  CHECK_FALSE(resets());
  const ImVec2 knob = desk.gui.at("stroke.scale");
  desk.gui.drag(0, knob, {knob.x + 40, knob.y});
  desk.rest();
  const std::optional<float> scale = first(desk).strokes->front().scale;
  REQUIRE(scale);
  CHECK(*scale > 1.5f);
  CHECK(*scale < 4);
  CHECK(first(desk).strokes->front().weight == drawn.weight);
  CHECK(desk.editor.snapshot().history->size() == steps + 1);
  CHECK(desk.gui.has("stroke.label.0"));
  CHECK(resets());
  desk.save("stroke_scale");
  desk.gui.drag(0, {knob.x + 40, knob.y}, {knob.x, knob.y});  // to the middle it is the region's
  desk.rest();
  CHECK(first(desk).strokes->front() == drawn);
  CHECK_FALSE(desk.gui.has("stroke.label.0"));
  desk.gui.key(letterKey('Z'), kCtrl);
  desk.rest();
  CHECK(first(desk).strokes->front().scale == scale);
  desk.gui.click("stroke.reset-scale");
  desk.rest();
  CHECK(first(desk).strokes->front() == drawn);
  desk.gui.key(letterKey('Z'), kCtrl);
  desk.gui.key(letterKey('Z'), kCtrl);
  desk.rest();
  CHECK(first(desk).strokes->front() == drawn);
  desk.gui.key(letterKey('Z'), kCtrl | kShift);
  desk.rest();
  CHECK(first(desk).strokes->front().scale == scale);
}

TEST_CASE("the wand takes a whole part, and a selection is given back to the first region") {
  Desk desk;
  desk.openScan();
  const RegionId body = bodyRegion(desk);
  const std::size_t points = pointsOf(desk.document(), body).size();
  desk.gui.key(letterKey('W'));
  desk.gui.click("by.Part");
  desk.gui.click(desk.gui.at("view"));
  desk.rest();
  CHECK(desk.selected() == 29945);  // the creature is one part
  CHECK(points > 0);
  desk.gui.key(letterKey('A'), kCtrl);
  desk.rest();
  desk.gui.key(letterKey('E'));
  desk.rest();
  CHECK(pointsOf(desk.document(), body).empty());
}

TEST_CASE("views whose colours need a key have one") {
  Desk desk(1, kWidth, kHeight, true);
  textured(desk);
  CHECK_FALSE(desk.gui.has("legend"));
  desk.gui.key(letterKey('D'));
  desk.rest();
  CHECK(desk.gui.has("legend"));
  desk.save("legend_state");
  desk.gui.key(letterKey('S'));
  desk.rest();
  CHECK(desk.gui.has("legend"));
  desk.gui.key(letterKey('K'), kCtrl);
  desk.gui.type("Show distortion");
  desk.gui.key(Key::enter);
  desk.rest();
  CHECK(desk.gui.has("legend"));
  desk.save("legend_distortion");
  desk.gui.key(letterKey('C'));
  desk.rest();
  CHECK_FALSE(desk.gui.has("legend"));
}

TEST_CASE("an export tells what its format cannot hold before it is written") {
  Desk desk(1, kWidth, kHeight, true);
  textured(desk);
  desk.gui.key(letterKey('E'), kCtrl);
  desk.gui.settle();
  desk.save("export");
  desk.gui.click("export.format.obj");
  desk.save("export_obj");
  desk.gui.click("export.accept");
  desk.gui.settle();
  REQUIRE(desk.gui.has("files.field"));
  const auto file = std::filesystem::temp_directory_path() / "dapple_editor_export.obj";
  std::filesystem::remove(file);
  desk.gui.fill("files.field", (file.parent_path() / file.stem()).string());
  desk.gui.click("files.accept");
  desk.rest();
  CHECK(desk.editor.engine().status().errors == 0);
  CHECK(std::filesystem::file_size(file) > 29945 * 20);
  std::filesystem::remove(file);
}

TEST_CASE("a scan is segmented into as many parts as asked for") {
  Desk desk;
  desk.openScan();
  desk.gui.click("region.segment");
  desk.gui.settle();
  REQUIRE(desk.gui.has("segment.parts"));
  const ImVec2 at = desk.gui.at("segment.parts");
  desk.gui.click(ImVec2(at.x - 150, at.y));
  desk.save("segment");
  desk.gui.key(Key::enter);
  desk.rest();
  const std::size_t parts = desk.document().regions->size() - 1;
  CHECK(parts > 2);
  CHECK(parts < 8);
  desk.gui.key(letterKey('S'));
  desk.rest();
  desk.save("segmented");
}

TEST_CASE("a material map is chosen for the swatch, shown, exported and taken off") {
  Desk desk(1, kWidth, kHeight, true);
  textured(desk);
  const Document plain = desk.document();
  const auto folder = std::filesystem::temp_directory_path() / "dapple_maps_test";
  std::filesystem::create_directories(folder);
  Image rough{144, 128, 1, std::vector<float>(144 * 128, 0.25f)};
  for (int y = 0; y < 128; ++y) rough.at(7, y, 0) = 0.75f;
  writeImage(folder / "rough.png", rough);
  desk.gui.click("swatch.maps");
  desk.gui.settle();
  desk.gui.click("map.roughness");
  desk.gui.settle();
  REQUIRE(desk.gui.has("files.field"));
  desk.gui.fill("files.field", (folder / "rough.png").string());
  desk.gui.click("files.accept");
  desk.rest();
  REQUIRE(first(desk).maps);
  // Nothing was synthesized again for it.
  CHECK(desk.document().results.texel == plain.results.texel);
  desk.gui.key(letterKey('K'), kCtrl);
  desk.gui.type("Show roughness");
  desk.gui.key(Key::enter);
  desk.rest();
  CHECK(desk.editor.view().missing().empty());
  desk.save("roughness");
  desk.gui.key(letterKey('E'), kCtrl);
  desk.gui.settle();
  CHECK(desk.gui.has("export.channels"));
  desk.gui.click("export.cancel");
  desk.gui.settle();
  desk.gui.click("map.roughness.remove");
  desk.rest();
  CHECK_FALSE(first(desk).maps);
  std::filesystem::remove_all(folder);
}

TEST_CASE("what auto has chosen stands under the method, and not under a named one") {
  Desk desk;
  textured(desk);
  desk.gui.key(Key::enter, kCtrl);
  desk.rest();
  CHECK(first(desk).options.method == Method::Auto);
  CHECK(desk.document().results.sources.front()->options.method == Method::Coordinates);
  desk.gui.click("panel.swatch");  // folded: the options come into sight
  desk.gui.frames(3);
  REQUIRE(desk.gui.has("option.method.chosen"));
  desk.gui.moveMouse(desk.gui.at("option.method.chosen"));
  desk.gui.frames(40);
  desk.save("auto");
  TextureOptions named = first(desk).options;
  named.method = Method::Patches;
  desk.editor.engine().submit(SetRegion{.region = kUnassigned, .options = named});
  desk.rest();
  CHECK_FALSE(desk.gui.has("option.method.chosen"));
}
