// Four small hints for the first run, one at a time, each beside the thing that it is about.
#pragma once

#include <set>
#include <string>

namespace dapple {

// The next one that is not among the dismissed ones and whose thing is in sight. Marks: "hint.SEG",
// "hint.next" (dismisses it), "hint.none" (dismisses all). Once a frame, after all other windows.
// Returns true when something was dismissed.
bool drawCoachMark(std::set<std::string>& dismissed);

// All of them are dismissed.
bool coachMarksDone(const std::set<std::string>& dismissed);

}  // namespace dapple
