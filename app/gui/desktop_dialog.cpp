#include "app/gui/desktop_dialog.h"

#include <fmt/format.h>

#include <atomic>
#include <cctype>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include "app/gui/session_bus.h"

namespace dapple {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPortal = "org.freedesktop.portal.Desktop";
constexpr const char* kPath = "/org/freedesktop/portal/desktop";
constexpr const char* kChooser = "org.freedesktop.portal.FileChooser";
constexpr const char* kRequest = "org.freedesktop.portal.Request";
constexpr std::uint64_t kLook = 100'000;  // microseconds between looks at the stop token

class BusFailure : public std::runtime_error {
 public:
  BusFailure(std::string errorName, const std::string& what)
      : std::runtime_error(what), name(std::move(errorName)) {}
  std::string name;  // "org.freedesktop.DBus.Error.NoReply", or empty
};

void check(int result, const char* what) {
  if (result < 0) throw BusFailure({}, fmt::format("{}: {}", what, std::strerror(-result)));
}

struct Connection {
  const BusLibrary& lib;
  sd_bus* bus = nullptr;

  explicit Connection(const BusLibrary& library) : lib(library) {
    check(lib.open_user(&bus), "the session's bus");
  }
  ~Connection() { lib.flush_close_unref(bus); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
};

struct Message {
  const BusLibrary& lib;
  sd_bus_message* message = nullptr;

  explicit Message(const BusLibrary& library) : lib(library) {}
  ~Message() {
    if (message) lib.message_unref(message);
  }
  Message(const Message&) = delete;
  Message& operator=(const Message&) = delete;
};

// The dictionary of options at the end of both calls.
class OptionWriter {
 public:
  OptionWriter(const BusLibrary& lib, sd_bus_message* message) : lib_(lib), to_(message) {
    check(lib_.message_open_container(to_, 'a', "{sv}"), "options");
  }
  void end() { check(lib_.message_close_container(to_), "options"); }
  void text(const char* key, const std::string& value) {
    check(lib_.message_append(to_, "{sv}", key, "s", value.c_str()), key);
  }
  void flag(const char* key, bool value) {
    check(lib_.message_append(to_, "{sv}", key, "b", static_cast<int>(value)), key);
  }
  // Paths are bytes that end with 0.
  void path(const char* key, const fs::path& value) {
    begin(key, "ay");
    check(lib_.message_append_array(to_, 'y', value.c_str(), value.string().size() + 1), key);
    finish(key);
  }
  void filters(const std::vector<FileKind>& kinds) {
    begin("filters", "a(sa(us))");
    check(lib_.message_open_container(to_, 'a', "(sa(us))"), "filters");
    for (const FileKind& kind : kinds) {
      check(lib_.message_open_container(to_, 'r', "sa(us)"), "filters");
      check(lib_.message_append(to_, "s", kind.name.c_str()), "filters");
      check(lib_.message_open_container(to_, 'a', "(us)"), "filters");
      std::vector<std::string> globs;
      for (const std::string& extension : kind.extensions) globs.push_back(globOf(extension));
      if (globs.empty()) globs.emplace_back("*");
      for (const std::string& glob : globs)
        check(lib_.message_append(to_, "(us)", 0u, glob.c_str()), "filters");
      check(lib_.message_close_container(to_), "filters");
      check(lib_.message_close_container(to_), "filters");
    }
    check(lib_.message_close_container(to_), "filters");
    finish("filters");
  }

 private:
  void begin(const char* key, const char* type) {
    check(lib_.message_open_container(to_, 'e', "sv"), key);
    check(lib_.message_append(to_, "s", key), key);
    check(lib_.message_open_container(to_, 'v', type), key);
  }
  void finish(const char* key) {
    check(lib_.message_close_container(to_), key);
    check(lib_.message_close_container(to_), key);
  }

  const BusLibrary& lib_;
  sd_bus_message* to_;
};

// What the portal's Response brings, taken in the handler.
struct Response {
  const BusLibrary* lib = nullptr;
  bool came = false;
  std::uint32_t code = 2;  // 0 chosen, 1 cancelled, 2 ended otherwise
  std::string uri;

  static int take(sd_bus_message* message, void* user, BusError*) {
    static_cast<Response*>(user)->read(message);
    return 0;
  }
  void read(sd_bus_message* message) {
    came = true;
    if (lib->message_read(message, "u", &code) < 0) return;
    if (lib->message_enter_container(message, 'a', "{sv}") < 0) return;
    while (lib->message_enter_container(message, 'e', "sv") > 0) {
      const char* key = nullptr;
      if (lib->message_read(message, "s", &key) < 0) return;
      if (std::string_view(key) == "uris")
        readUris(message);
      else if (lib->message_skip(message, "v") < 0)
        return;
      if (lib->message_exit_container(message) < 0) return;
    }
  }
  void readUris(sd_bus_message* message) {
    const char* text = nullptr;
    if (lib->message_enter_container(message, 'v', "as") < 0) return;
    if (lib->message_enter_container(message, 'a', "s") < 0) return;
    while (lib->message_read(message, "s", &text) > 0)
      if (uri.empty()) uri = text;
    lib->message_exit_container(message);
    lib->message_exit_container(message);
  }
};

// The path of the request's object, by which its Response comes: known before the call, so that no
// answer is missed.
std::string requestPath(const Connection& connection, const std::string& token) {
  const char* unique = nullptr;
  check(connection.lib.get_unique_name(connection.bus, &unique), "the name on the bus");
  std::string sender(unique + (unique[0] == ':' ? 1 : 0));
  for (char& c : sender)
    if (c == '.') c = '_';
  return fmt::format("{}/request/{}/{}", kPath, sender, token);
}

void listen(Connection& connection, const std::string& request, Response& response) {
  check(connection.lib.match_signal(connection.bus, nullptr, kPortal, request.c_str(), kRequest,
                                    "Response", Response::take, &response),
        "the portal's answer");
}

void writeCall(Message& call, const FileQuestion& question, const std::string& parent,
               const std::string& token) {
  const BusLibrary& lib = call.lib;
  check(lib.message_append(call.message, "ss", parent.c_str(), question.title.c_str()), "title");
  OptionWriter options(lib, call.message);
  options.text("handle_token", token);
  options.flag("modal", true);
  if (!question.accept.empty()) options.text("accept_label", question.accept);
  if (question.purpose == BrowseFor::folder) options.flag("directory", true);
  if (!question.kinds.empty()) options.filters(question.kinds);
  std::error_code error;
  if (!question.folder.empty() && fs::is_directory(question.folder, error))
    options.path("current_folder", question.folder);
  if (question.purpose == BrowseFor::save && !question.name.empty()) {
    const std::string extension = question.kinds.empty() || question.kinds[0].extensions.empty()
                                      ? ""
                                      : question.kinds[0].extensions[0];
    options.text("current_name",
                 question.name.ends_with(extension) ? question.name : question.name + extension);
  }
  options.end();
}

// Sends, and gives the path of the request's object. An error's name tells whether there is a
// portal at all.
std::string send(Connection& connection, Message& call, std::chrono::milliseconds starting) {
  const BusLibrary& lib = connection.lib;
  Message reply(lib);
  BusError error;
  const auto limit = static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(starting).count());
  const int result = lib.call(connection.bus, call.message, limit, &error, &reply.message);
  if (result < 0) {
    const std::string name = error.name ? error.name : "",
                      text = error.message ? error.message : "";
    lib.error_free(&error);
    if (result == -ETIMEDOUT) throw BusFailure(name, "it did not come in time");
    throw BusFailure(name, text.empty() ? std::strerror(-result) : text);
  }
  const char* path = nullptr;
  check(lib.message_read(reply.message, "o", &path), "the portal's answer");
  return path;
}

void closeRequest(Connection& connection, const std::string& path) {
  const BusLibrary& lib = connection.lib;
  Message call(lib);
  if (lib.message_new_method_call(connection.bus, &call.message, kPortal, path.c_str(), kRequest,
                                  "Close") < 0)
    return;
  Message reply(lib);
  BusError error;
  lib.call(connection.bus, call.message, 500'000, &error, &reply.message);
  lib.error_free(&error);
}

bool meansAbsent(const BusFailure& failure) {
  for (const char* name : {"ServiceUnknown", "NameHasNoOwner", "UnknownMethod", "UnknownInterface",
                           "UnknownObject", "Spawn"})
    if (failure.name.find(name) != std::string::npos) return true;
  return false;
}

DialogAnswer answerOf(const Response& response) {
  using Kind = DialogAnswer::Kind;
  if (response.code == 1) return {Kind::Cancelled, {}, {}};
  if (response.code != 0) return {Kind::Failed, {}, "The desktop's dialog ended by itself."};
  if (const auto path = pathOfUri(response.uri)) return {Kind::Chosen, *path, {}};
  return {Kind::Failed, {}, fmt::format("\"{}\" is no file on this computer.", response.uri)};
}

}  // namespace

std::optional<fs::path> pathOfUri(const std::string& uri) {
  constexpr std::string_view kScheme = "file://";
  if (!uri.starts_with(kScheme)) return {};
  std::string_view rest = std::string_view(uri).substr(kScheme.size());
  if (rest.starts_with("localhost/")) rest.remove_prefix(9);
  if (!rest.starts_with('/')) return {};
  std::string path;
  for (std::size_t k = 0; k < rest.size(); ++k) {
    if (rest[k] != '%') {
      path += rest[k];
      continue;
    }
    const auto digit = [&](std::size_t at) -> int {
      if (at >= rest.size() || !std::isxdigit(static_cast<unsigned char>(rest[at]))) return -1;
      const char c = static_cast<char>(std::tolower(static_cast<unsigned char>(rest[at])));
      return c <= '9' ? c - '0' : c - 'a' + 10;
    };
    const int high = digit(k + 1), low = digit(k + 2);
    if (high < 0 || low < 0 || high * 16 + low == 0) return {};
    path += static_cast<char>(high * 16 + low);
    k += 2;
  }
  return fs::path(path);
}

std::string globOf(const std::string& extension) {
  std::string glob = "*";
  for (const char c : extension) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalpha(byte))
      glob +=
          {'[', static_cast<char>(std::tolower(byte)), static_cast<char>(std::toupper(byte)), ']'};
    else
      glob += c;
  }
  return glob;
}

DialogAnswer askPortal(const FileQuestion& question, const std::string& parent,
                       std::chrono::milliseconds starting, const std::stop_token& stop) {
  using Kind = DialogAnswer::Kind;
  const BusLibrary* lib = BusLibrary::load();
  if (!lib) return {};
  try {
    Connection connection(*lib);
    static std::atomic<unsigned> count{0};
    const std::string token = fmt::format("dapple{}", ++count);
    std::string request = requestPath(connection, token);
    Response response{.lib = lib};
    listen(connection, request, response);
    Message call(*lib);
    check(
        lib->message_new_method_call(connection.bus, &call.message, kPortal, kPath, kChooser,
                                     question.purpose == BrowseFor::save ? "SaveFile" : "OpenFile"),
        "the question");
    writeCall(call, question, parent, token);
    const std::string given = send(connection, call, starting);
    if (given != request) listen(connection, request = given, response);  // portals before 0.9
    while (!response.came) {
      if (stop.stop_requested()) {
        closeRequest(connection, request);
        return {Kind::Cancelled, {}, {}};
      }
      const int processed = lib->process(connection.bus, nullptr);
      check(processed, "the session's bus");
      if (processed == 0) check(lib->wait(connection.bus, kLook), "the session's bus");
    }
    return answerOf(response);
  } catch (const BusFailure& failure) {
    if (meansAbsent(failure) || std::string_view(failure.what()).starts_with("the session's bus: "))
      return {};
    return {Kind::Failed, {}, fmt::format("The desktop's dialog failed: {}.", failure.what())};
  }
}

DesktopDialog::~DesktopDialog() {
  stop_.request_stop();
  if (answer_.valid()) answer_.wait();
}

void DesktopDialog::open(FileQuestion question) {
  if (isOpen()) return;
  question_ = std::move(question);
  answer_ = std::async(std::launch::async, ask_, question_, stop_.get_token());
}

std::optional<DialogAnswer> DesktopDialog::poll() {
  if (!isOpen() || answer_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return {};
  return answer_.get();
}

}  // namespace dapple
