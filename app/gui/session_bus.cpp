#include "app/gui/session_bus.h"

#include <dlfcn.h>

#include <optional>

namespace dapple {
namespace {

template <class Function>
bool find(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(::dlsym(library, name));
  return function != nullptr;
}

std::optional<BusLibrary> open() {
  void* const so = ::dlopen("libsystemd.so.0", RTLD_NOW | RTLD_LOCAL);
  if (so == nullptr) return {};
  BusLibrary bus{};
  const bool all = find(so, "sd_bus_open_user", bus.open_user) &&
                   find(so, "sd_bus_flush_close_unref", bus.flush_close_unref) &&
                   find(so, "sd_bus_get_unique_name", bus.get_unique_name) &&
                   find(so, "sd_bus_process", bus.process) && find(so, "sd_bus_wait", bus.wait) &&
                   find(so, "sd_bus_match_signal", bus.match_signal) &&
                   find(so, "sd_bus_call", bus.call) &&
                   find(so, "sd_bus_error_free", bus.error_free) &&
                   find(so, "sd_bus_message_new_method_call", bus.message_new_method_call) &&
                   find(so, "sd_bus_message_unref", bus.message_unref) &&
                   find(so, "sd_bus_message_append", bus.message_append) &&
                   find(so, "sd_bus_message_append_array", bus.message_append_array) &&
                   find(so, "sd_bus_message_open_container", bus.message_open_container) &&
                   find(so, "sd_bus_message_close_container", bus.message_close_container) &&
                   find(so, "sd_bus_message_read", bus.message_read) &&
                   find(so, "sd_bus_message_skip", bus.message_skip) &&
                   find(so, "sd_bus_message_enter_container", bus.message_enter_container) &&
                   find(so, "sd_bus_message_exit_container", bus.message_exit_container);
  if (!all) return {};
  return bus;
}

}  // namespace

const BusLibrary* BusLibrary::load() {
  static const std::optional<BusLibrary> library = open();
  return library ? &*library : nullptr;
}

}  // namespace dapple
