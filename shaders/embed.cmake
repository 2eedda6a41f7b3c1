# Writes the files of the list FILES as string literals into the source OUT:
#   cmake -DOUT=... -DFILES=a;b -P embed.cmake
set(text "// Made from shaders/ at build; see app/render/shader_sources.h.\n")
string(APPEND text "#include \"app/render/shader_sources.h\"\n\n#include \"base/errors.h\"\n\n")
string(APPEND text "namespace dapple {\n\nstd::string_view shaderSource(std::string_view name) {\n")
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME)
  file(READ ${file} source)
  string(APPEND text "  if (name == \"${name}\") return R\"glsl(${source})glsl\";\n")
endforeach()
string(APPEND text "  throw Bug(\"no shader named \" + std::string(name));\n}\n\n}  // namespace dapple\n")
file(WRITE ${OUT} "${text}")
