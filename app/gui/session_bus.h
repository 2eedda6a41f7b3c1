// The desktop's message bus, by sd-bus of libsystemd: loaded when it is first asked for, so that
// the program runs without it too.
#pragma once

#include <cstdint>
#include <memory>

struct sd_bus;
struct sd_bus_message;
struct sd_bus_slot;

namespace dapple {

// As <systemd/sd-bus.h> has it.
struct BusError {
  const char* name = nullptr;
  const char* message = nullptr;
  int needsFree = 0;
};
using BusHandler = int (*)(sd_bus_message*, void* user, BusError*);

// The functions of the library, under its names without "sd_bus_". Negative results are -errno.
struct BusLibrary {
  int (*open_user)(sd_bus**);
  sd_bus* (*flush_close_unref)(sd_bus*);
  int (*get_unique_name)(sd_bus*, const char**);
  int (*process)(sd_bus*, sd_bus_message**);
  int (*wait)(sd_bus*, std::uint64_t microseconds);
  int (*match_signal)(sd_bus*, sd_bus_slot**, const char* sender, const char* path,
                      const char* interface, const char* member, BusHandler, void* user);
  int (*call)(sd_bus*, sd_bus_message*, std::uint64_t microseconds, BusError*, sd_bus_message**);
  void (*error_free)(BusError*);
  int (*message_new_method_call)(sd_bus*, sd_bus_message**, const char* destination,
                                 const char* path, const char* interface, const char* member);
  sd_bus_message* (*message_unref)(sd_bus_message*);
  int (*message_append)(sd_bus_message*, const char* types, ...);
  int (*message_append_array)(sd_bus_message*, char type, const void*, std::size_t bytes);
  int (*message_open_container)(sd_bus_message*, char type, const char* contents);
  int (*message_close_container)(sd_bus_message*);
  int (*message_read)(sd_bus_message*, const char* types, ...);
  int (*message_skip)(sd_bus_message*, const char* types);
  int (*message_enter_container)(sd_bus_message*, char type, const char* contents);
  int (*message_exit_container)(sd_bus_message*);

  // Null where the library is not installed. From any thread.
  static const BusLibrary* load();
};

}  // namespace dapple
