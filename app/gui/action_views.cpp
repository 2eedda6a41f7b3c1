#include "app/gui/action_views.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "app/gui/gui_context.h"
#include "app/gui/item_marks.h"
#include "app/gui/scopes.h"
#include "app/gui/theme.h"
#include "app/gui/widgets.h"

namespace dapple {
namespace {

using namespace theme;

constexpr float kSheetWidth = 880, kSheetHeight = 600, kSheetColumn = 270;
constexpr float kSearchWidth = 560, kSearchHeight = 420;

// Scores of one matching character.
constexpr int kPlain = 1, kRun = 4, kWordStart = 6, kFirst = 4;

char lower(char c) {
  return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

std::string tooltipOf(const Action& action) {
  return action.help.empty() ? action.label : action.label + "\n" + action.help;
}

std::string groupOf(const Action& action) {
  if (!action.group.empty()) return action.group;
  return action.menu.substr(0, action.menu.find('/'));
}

// The actions of one menu and its submenus, which stand where their first action stands.
void menuContent(ActionTable& table, const std::string& path) {
  std::vector<std::string> submenus;
  bool any = false;
  // By index: what an item runs may add actions.
  for (std::size_t i = 0; i < table.all().size(); ++i) {
    const std::string menu = table.all()[i].menu, id = table.all()[i].id;
    if (table.all()[i].label.empty()) continue;
    if (menu == path) {
      if (table.all()[i].separatorBefore && any) ImGui::Separator();
      any = true;
      actionMenuItem(table, id);
    } else if (menu.starts_with(path + "/")) {
      const std::string rest = menu.substr(path.size() + 1);
      const std::string name = rest.substr(0, rest.find('/'));
      if (std::find(submenus.begin(), submenus.end(), name) != submenus.end()) continue;
      submenus.push_back(name);
      if (table.all()[i].separatorBefore && any) ImGui::Separator();
      any = true;
      const scope::Menu submenu(name.c_str());
      markItem("menu." + path + "/" + name);
      if (submenu) menuContent(table, path + "/" + name);
    }
  }
}

ImVec2 centreOfDisplay() {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  return {size.x / 2, size.y / 2};
}

ImVec2 fitted(float width, float height) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const float margin = 2 * px(kGapLarge);
  return {std::min(px(width), size.x - margin), std::min(px(height), size.y - margin)};
}

bool keyHit(ImGuiKey key, bool repeat = false) {
  return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key), repeat);
}

struct SheetRow {
  std::string label;
  std::vector<std::string> keys;
};
struct SheetGroup {
  std::string name;
  std::vector<SheetRow> rows;
};

bool matches(const std::string& query, const std::string& text) {
  return query.empty() || fuzzyScore(query, text) > 0;
}

SheetGroup& groupNamed(std::vector<SheetGroup>& groups, const std::string& name) {
  for (SheetGroup& group : groups)
    if (group.name == name) return group;
  groups.push_back({name, {}});
  return groups.back();
}

std::vector<SheetGroup> sheetGroups(const ActionTable& table,
                                    const std::vector<ShortcutSheet::Extra>& extras,
                                    const std::string& query) {
  std::vector<SheetGroup> groups;
  for (const Action& action : table.all()) {
    std::vector<std::string> keys;
    for (const Shortcut& key : table.shortcutsOf(action.id)) keys.push_back(toString(key));
    if (keys.empty() || action.label.empty()) continue;
    const std::string all = action.label + " " + fmt::format("{}", fmt::join(keys, " "));
    if (matches(query, all))
      groupNamed(groups, groupOf(action)).rows.push_back({action.label, std::move(keys)});
  }
  for (const ShortcutSheet::Extra& extra : extras) {
    if (!matches(query, extra.label + " " + extra.keys)) continue;
    std::vector<SheetRow>& rows = groupNamed(groups, extra.group).rows;
    if (!rows.empty() && rows.back().label == extra.label)  // another way to the same
      rows.back().keys.push_back(extra.keys);
    else
      rows.push_back({extra.label, {extra.keys}});
  }
  return groups;
}

void sheetRow(const SheetRow& row, float width) {
  const ImVec2 from = ImGui::GetCursorPos();
  float keysWidth = -px(kGap);
  for (const std::string& keys : row.keys) keysWidth += keyCapsWidth(keys) + px(kGap);
  clippedText(row.label, width - keysWidth - px(kGap));
  float x = from.x + width - keysWidth;
  for (const std::string& keys : row.keys) {
    ImGui::SetCursorPos({x, from.y - px(1)});
    keyCaps(keys);
    x += keyCapsWidth(keys) + px(kGap);
  }
  ImGui::SetCursorPos({from.x, from.y + px(26)});
}

// Columns of about the same height, groups whole.
void sheetColumns(const std::vector<SheetGroup>& groups) {
  const float available = ImGui::GetContentRegionAvail().x, gap = px(kGapHuge);
  const int columns = std::max(1, static_cast<int>((available + gap) / (px(kSheetColumn) + gap)));
  const float width =
      (available - gap * static_cast<float>(columns - 1)) / static_cast<float>(columns);
  const ImVec2 start = ImGui::GetCursorPos();
  std::vector<float> bottoms(static_cast<std::size_t>(columns), start.y);
  for (const SheetGroup& group : groups) {
    const auto column = std::min_element(bottoms.begin(), bottoms.end());
    const float x = start.x + (width + gap) * static_cast<float>(column - bottoms.begin());
    ImGui::SetCursorPos({x, *column});
    const scope::Group whole;
    {
      const scope::Colour accent(ImGuiCol_Text, kAccent);
      heading(group.name.c_str());
    }
    for (const SheetRow& row : group.rows) {
      ImGui::SetCursorPosX(x);
      sheetRow(row, width);
    }
    *column = ImGui::GetCursorPosY() + px(kGapLarge);
  }
  ImGui::SetCursorPos({start.x, *std::max_element(bottoms.begin(), bottoms.end())});
  ImGui::Dummy({1, 1});
}

// A dialog in the middle that Escape and a click beside it close.
constexpr ImGuiWindowFlags kOverlay =
    ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove;

bool clickedBeside() {
  return ImGui::IsMouseClicked(0) && !ImGui::IsWindowAppearing() &&
         !ImGui::IsWindowHovered(ImGuiHoveredFlags_RootAndChildWindows |
                                 ImGuiHoveredFlags_AllowWhenBlockedByActiveItem);
}

}  // namespace

bool actionMenuItem(ActionTable& table, std::string_view id) {
  const Action* action = table.find(id);
  if (action == nullptr) return false;
  const std::string keys = table.keysOf(id), help = action->help;
  const bool chosen = ImGui::MenuItem(action->label.c_str(), keys.c_str(), table.isChecked(id),
                                      table.isEnabled(id));
  markItem("menu-item." + std::string(id));
  tooltip(help);
  return chosen && table.run(id);
}

void actionMenus(ActionTable& table) {
  std::vector<std::string> menus;
  for (const Action& action : table.all()) {
    const std::string name = action.menu.substr(0, action.menu.find('/'));
    if (!name.empty() && std::find(menus.begin(), menus.end(), name) == menus.end())
      menus.push_back(name);
  }
  for (const std::string& name : menus) {
    const scope::Menu menu(name.c_str());
    markItem("menu." + name);
    if (menu) menuContent(table, name);
  }
}

bool actionButton(ActionTable& table, std::string_view id, float size) {
  const Action* action = table.find(id);
  if (action == nullptr) return false;
  const bool clicked = iconButton({.icon = action->icon,
                                   .id = action->id.c_str(),
                                   .tooltip = tooltipOf(*action),
                                   .keys = table.keysOf(id),
                                   .selected = table.isChecked(id),
                                   .enabled = table.isEnabled(id),
                                   .size = size});
  return clicked && table.run(id);
}

bool actionTextButton(ActionTable& table, std::string_view id, bool primary, float width) {
  const Action* action = table.find(id);
  if (action == nullptr) return false;
  bool clicked = false;
  {
    const scope::Disabled disabled(!table.isEnabled(id));
    clicked = textButton(action->label.c_str(), primary ? ButtonKind::primary : ButtonKind::normal,
                         action->icon, width, id);
    tooltip(tooltipOf(*action), table.keysOf(id));
  }
  return clicked && table.run(id);
}

int fuzzyScore(std::string_view query, std::string_view text) {
  int score = 0;
  std::size_t at = 0, last = std::string_view::npos;
  for (char raw : query) {
    if (raw == ' ') continue;
    const char wanted = lower(raw);
    const auto startsWord = [&](std::size_t i) {
      return i == 0 || !std::isalnum(static_cast<unsigned char>(text[i - 1]));
    };
    std::size_t found = std::string_view::npos;
    // The next letter of a run, else the beginning of a word, else the next anywhere.
    if (last != std::string_view::npos && at < text.size() && lower(text[at]) == wanted) found = at;
    for (std::size_t i = at; found == std::string_view::npos && i < text.size(); ++i)
      if (lower(text[i]) == wanted && startsWord(i)) found = i;
    for (std::size_t i = at; found == std::string_view::npos && i < text.size(); ++i)
      if (lower(text[i]) == wanted) found = i;
    if (found == std::string_view::npos) return 0;
    score += kPlain + (startsWord(found) ? kWordStart : 0) + (found == 0 ? kFirst : 0) +
             (last != std::string_view::npos && found == last + 1 ? kRun : 0);
    last = found;
    at = found + 1;
  }
  return score;
}

std::vector<std::string> searchActions(const ActionTable& table, std::string_view query) {
  struct Hit {
    int score;
    std::size_t recent, index;
  };
  std::vector<Hit> hits;
  for (std::size_t i = 0; i < table.all().size(); ++i) {
    const Action& action = table.all()[i];
    if (action.label.empty()) continue;
    int score = 0;
    if (!query.empty()) {
      // The label counts double; its menu and the id find what it is about.
      score = std::max(2 * fuzzyScore(query, action.label),
                       fuzzyScore(query, action.menu + " " + action.label));
      score = std::max(score, fuzzyScore(query, action.id));
      if (score == 0) continue;
    }
    const auto& recent = table.recent();
    const auto used = std::find(recent.begin(), recent.end(), action.id) - recent.begin();
    hits.push_back({score, static_cast<std::size_t>(used), i});
  }
  std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) {
    if (a.score != b.score) return a.score > b.score;
    return a.recent != b.recent ? a.recent < b.recent : a.index < b.index;
  });
  std::vector<std::string> ids;
  for (const Hit& hit : hits) ids.push_back(table.all()[hit.index].id);
  return ids;
}

void ShortcutSheet::draw(const ActionTable& table, const std::vector<Extra>& extras) {
  constexpr const char* kName = "##shortcuts";
  if (wanted_) {
    ImGui::OpenPopup(kName);
    query_.clear();
  }
  ImGui::SetNextWindowPos(centreOfDisplay(), ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSize(fitted(kSheetWidth, kSheetHeight));
  const scope::Style padding(ImGuiStyleVar_WindowPadding, px(20, 16));
  const scope::Modal modal(kName, nullptr, kOverlay);
  open_ = modal.open;
  const bool focus = wanted_;
  wanted_ = false;
  if (!modal) return;
  {
    const scope::Font title(GuiContext::current().fonts().title);
    ImGui::TextUnformatted("Shortcuts");
  }
  ImGui::SameLine();
  alignRight(px(260 + kIconButtonSize + kGap));
  searchField("shortcuts.search", "Search keys and actions", query_, px(260), focus);
  ImGui::SameLine();
  const bool closed = iconButton({.icon = Icon::close, .id = "shortcuts.close"});
  ImGui::Dummy({0, px(kGapSmall)});
  {
    const scope::Child list("##list", {0, 0});
    const std::vector<SheetGroup> groups = sheetGroups(table, extras, query_);
    if (groups.empty()) mutedText("No action or key matches.");
    sheetColumns(groups);
  }
  if (closed || keyHit(ImGuiKey_Escape) || clickedBeside() ||
      (!focus && ImGui::IsKeyPressed(static_cast<int>(Key::f1), false)))
    ImGui::CloseCurrentPopup();
}

void CommandSearch::drawRow(const ActionTable& table, const Action& action, int index) {
  const bool enabled = table.isEnabled(action.id);
  const float height = px(34), inset = px(kGap);
  const ImVec2 min = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x;
  const scope::Id id(index);
  const scope::Disabled disabled(!enabled);
  if (ImGui::InvisibleButton("##row", {width, height})) run_ = action.id;
  markItem("command." + action.id);
  if (ImGui::IsItemHovered() &&
      (ImGui::GetIO().MouseDelta.x != 0 || ImGui::GetIO().MouseDelta.y != 0))
    chosen_ = index;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  if (chosen_ == index) {
    list.AddRectFilled(min, {min.x + width, min.y + height}, ImGui::GetColorU32(kAccentSoft),
                       px(kRadius));
    if (scroll_) ImGui::SetScrollHereY(0.5f);
  }
  const float icon = px(16), line = ImGui::GetFontSize();
  const float textY = min.y + std::round((height - line) / 2);
  drawIcon(list, action.icon, {min.x + inset, min.y + std::round((height - icon) / 2)}, icon,
           ImGui::GetColorU32(chosen_ == index ? kAccentHovered : kTextMuted));
  float x = min.x + icon + 2 * inset;
  list.AddText({x, textY}, ImGui::GetColorU32(kText), action.label.c_str());
  x += ImGui::CalcTextSize(action.label.c_str()).x + px(12);
  if (!action.menu.empty())
    list.AddText({x, textY}, ImGui::GetColorU32(kTextFaint), action.menu.c_str());
  const std::string keys = table.keysOf(action.id);
  const ImVec2 after = ImGui::GetCursorPos();
  ImGui::SetCursorScreenPos(
      {min.x + width - keyCapsWidth(keys) - inset, min.y + std::round((height - px(19)) / 2)});
  if (!keys.empty()) keyCaps(keys);
  ImGui::SetCursorPos(after);
}

void CommandSearch::draw(ActionTable& table) {
  constexpr const char* kName = "##commands";
  if (wanted_) {
    ImGui::OpenPopup(kName);
    query_.clear();
    chosen_ = 0;
  }
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({size.x / 2, size.y * 0.16f}, ImGuiCond_Always, {0.5f, 0});
  const auto hits =
      static_cast<float>(std::max<std::size_t>(1, searchActions(table, query_).size()));
  const float height = std::min(kSearchHeight, 70 + 36 * hits);
  ImGui::SetNextWindowSize(fitted(kSearchWidth, height));
  {
    const scope::Modal modal(kName, nullptr, kOverlay);
    open_ = modal.open;
    const bool focus = wanted_;
    wanted_ = false;
    if (!modal) return;
    if (searchField("commands.search", "What do you want to do?", query_, -1, focus)) chosen_ = 0;
    const std::vector<std::string> ids = searchActions(table, query_);
    const int count = static_cast<int>(ids.size());
    const int before = chosen_;
    if (keyHit(ImGuiKey_DownArrow, true)) ++chosen_;
    if (keyHit(ImGuiKey_UpArrow, true)) --chosen_;
    if (count > 0) chosen_ = (chosen_ + count) % count;
    scroll_ = chosen_ != before || focus;
    if ((keyHit(ImGuiKey_Enter) || keyHit(ImGuiKey_KeyPadEnter)) && count > 0 &&
        table.isEnabled(ids[static_cast<std::size_t>(chosen_)]))
      run_ = ids[static_cast<std::size_t>(chosen_)];
    {
      const scope::Child rows("##list", {0, 0});
      const scope::Style spacing(ImGuiStyleVar_ItemSpacing, px(0, 2));
      if (count == 0) mutedText("Nothing of this name. Try other letters.");
      for (int i = 0; i < count; ++i)
        drawRow(table, *table.find(ids[static_cast<std::size_t>(i)]), i);
    }
    if (!run_.empty() || keyHit(ImGuiKey_Escape) || clickedBeside()) ImGui::CloseCurrentPopup();
  }
  // Outside the popup: what it runs may open its own.
  if (!run_.empty()) table.run(std::exchange(run_, {}));
}

}  // namespace dapple
