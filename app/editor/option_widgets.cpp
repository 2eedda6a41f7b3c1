#include "app/editor/option_widgets.h"

#include <imgui.h>

#include <string>
#include <vector>

#include "app/gui/item_marks.h"
#include "app/gui/scopes.h"
#include "app/gui/theme.h"
#include "app/gui/widgets.h"
#include "base/errors.h"

namespace dapple {
namespace {

constexpr float kLabelWidth = 112;  // logical pixels

std::vector<std::string> choicesOf(const OptionRow& row) {
  std::vector<std::string> names{""};
  for (const char c : row.choices)
    if (c == '|')
      names.emplace_back();
    else
      names.back() += c;
  return names;
}

// What a widget of the option's kind makes of it.
struct Widget {
  TextureOptions& options;
  const OptionRow& row;
  const char* id;

  bool operator()(bool TextureOptions::*field) { return ImGui::Checkbox(id, &(options.*field)); }
  bool operator()(int TextureOptions::*field) {
    const int low = static_cast<int>(row.low), high = static_cast<int>(row.high);
    return ImGui::SliderInt(id, &(options.*field), low, high, "%d", ImGuiSliderFlags_AlwaysClamp);
  }
  bool operator()(double TextureOptions::*field) {
    return ImGui::SliderScalar(
        id, ImGuiDataType_Double, &(options.*field), &row.low, &row.high, "%.3g",
        ImGuiSliderFlags_AlwaysClamp |
            (row.low > 0 && row.high > 20 * row.low ? ImGuiSliderFlags_Logarithmic : 0));
  }
  bool operator()(std::uint64_t TextureOptions::*field) {
    return ImGui::InputScalar(id, ImGuiDataType_U64, &(options.*field), nullptr, nullptr, nullptr,
                              kTextFlags);
  }
  bool operator()(vec3 TextureOptions::*field) {
    return ImGui::InputFloat3(id, &(options.*field).x, "%.2g", kTextFlags);
  }
  template <class Enum>
  bool operator()(Enum TextureOptions::*field) {
    const std::vector<std::string> names = choicesOf(row);
    const auto current = static_cast<std::size_t>(options.*field);
    if (!ImGui::BeginCombo(id, names[current].c_str())) return false;
    bool changed = false;
    for (std::size_t k = 0; k < names.size(); ++k)
      if (ImGui::Selectable(names[k].c_str(), k == current)) {
        options.*field = static_cast<Enum>(k);
        changed = k != current;
      }
    ImGui::EndCombo();
    return changed;
  }
};

bool optionWidget(TextureOptions& options, const OptionRow& row) {
  const std::string name(row.name), id = "##" + name;
  ImGui::AlignTextToFramePadding();
  clippedText(name, theme::px(kLabelWidth - theme::kGapLarge));
  tooltip(std::string(row.help) + "\n" + optionRange(row));
  ImGui::SameLine(theme::px(kLabelWidth));
  ImGui::SetNextItemWidth(-1);
  const bool changed = std::visit(Widget{options, row, id.c_str()}, row.field);
  markItem("option." + name);
  const std::string standard = optionText(TextureOptions{}, row);
  if (const scope::ContextPopup popup(("reset " + name).c_str()); popup)
    if (ImGui::MenuItem(("Reset to " + standard).c_str())) {
      setOption(options, row, standard);
      return true;
    }
  return changed;
}

void choiceLine(const ChoiceShown& chosen) {
  ImGui::SetCursorPosX(ImGui::GetCursorPosX() + theme::px(kLabelWidth));
  mutedTextWrapped(chosen.text.empty() ? "chosen by the swatch at the next synthesis"
                                       : chosen.text);
  markItem("option.method.chosen");
  if (!chosen.reasons.empty()) tooltip(chosen.reasons);
}

}  // namespace

bool optionWidgets(TextureOptions& options, const ChoiceShown& chosen) {
  TextureOptions edited = options;
  bool changed = false;
  for (const OptionRow& row : optionsTable()) {
    if (row.name == "threads" || !row.countsIn(options)) continue;  // threads: the engine's
    changed |= optionWidget(edited, row);
    if (row.name == "method" && options.method == Method::Auto) choiceLine(chosen);
  }
  if (!changed) return false;
  try {
    validate(edited);
  } catch (const InvalidInput&) {
    return false;  // half typed
  }
  options = edited;
  return true;
}

}  // namespace dapple
