# The headers that almost every source includes, compiled once for all targets of the same flags.
# Never needed: each source includes what it uses, which the Release build of ./check shows.
set(DAPPLE_COMMON_HEADERS <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <memory>
    <optional> <span> <string> <string_view> <utility> <variant> <vector> <fmt/format.h>
    <glm/glm.hpp>)
target_precompile_headers(dapple_engine PRIVATE ${DAPPLE_COMMON_HEADERS})
foreach(target dapple_render dapple_tests dapple_render_tests)
  target_precompile_headers(${target} REUSE_FROM dapple_engine)
endforeach()
# These are compiled with -O1.
target_precompile_headers(dapple_gui PRIVATE ${DAPPLE_COMMON_HEADERS})
foreach(target dapple_editor dapple_gui_tests dapple_editor_tests)
  target_precompile_headers(${target} REUSE_FROM dapple_gui)
endforeach()
