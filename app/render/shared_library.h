// Functions of a library that is loaded only when it is asked for.
#pragma once

#include <dlfcn.h>

namespace dapple {

// Sets `function` to the one of that name; false when `library` (of dlopen) has none.
template <class Function>
bool findFunction(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(::dlsym(library, name));
  return function != nullptr;
}

}  // namespace dapple
