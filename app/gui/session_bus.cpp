#include "app/gui/session_bus.h"

#include <optional>

#include "app/render/shared_library.h"

namespace dapple {
namespace {

std::optional<BusLibrary> open() {
  void* const so = ::dlopen("libsystemd.so.0", RTLD_NOW | RTLD_LOCAL);
  if (so == nullptr) return {};
  BusLibrary bus{};
  const bool all =
      findFunction(so, "sd_bus_open_user", bus.open_user) &&
      findFunction(so, "sd_bus_flush_close_unref", bus.flush_close_unref) &&
      findFunction(so, "sd_bus_get_unique_name", bus.get_unique_name) &&
      findFunction(so, "sd_bus_process", bus.process) &&
      findFunction(so, "sd_bus_wait", bus.wait) &&
      findFunction(so, "sd_bus_match_signal", bus.match_signal) &&
      findFunction(so, "sd_bus_call", bus.call) &&
      findFunction(so, "sd_bus_error_free", bus.error_free) &&
      findFunction(so, "sd_bus_message_new_method_call", bus.message_new_method_call) &&
      findFunction(so, "sd_bus_message_unref", bus.message_unref) &&
      findFunction(so, "sd_bus_message_append", bus.message_append) &&
      findFunction(so, "sd_bus_message_append_array", bus.message_append_array) &&
      findFunction(so, "sd_bus_message_open_container", bus.message_open_container) &&
      findFunction(so, "sd_bus_message_close_container", bus.message_close_container) &&
      findFunction(so, "sd_bus_message_read", bus.message_read) &&
      findFunction(so, "sd_bus_message_skip", bus.message_skip) &&
      findFunction(so, "sd_bus_message_enter_container", bus.message_enter_container) &&
      findFunction(so, "sd_bus_message_exit_container", bus.message_exit_container);
  if (!all) return {};
  return bus;
}

}  // namespace

const BusLibrary* BusLibrary::load() {
  static const std::optional<BusLibrary> library = open();
  return library ? &*library : nullptr;
}

}  // namespace dapple
