// The desktop's dialog against a portal that is played, on a bus of the test's own.
#include "app/gui/desktop_dialog.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "app/gui/session_bus.h"
#include "tests/child_process.h"

using namespace dapple;
using namespace std::chrono_literals;
namespace fs = std::filesystem;
using Kind = DialogAnswer::Kind;

namespace {

// A bus that starts no services; the environment names it while this lives.
class PrivateBus {
 public:
  PrivateBus() {
    const char* set = std::getenv(kVariable);
    if (set) before_ = set;
    const fs::path config =
        fs::temp_directory_path() / fmt::format("dapple_bus_{}.conf", ::getpid());
    std::ofstream(config) << "<!DOCTYPE busconfig PUBLIC \"-//freedesktop//DTD D-Bus Bus "
                             "Configuration 1.0//EN\" \"http://www.freedesktop.org/standards/dbus/"
                             "1.0/busconfig.dtd\"><busconfig><type>session</type><listen>unix:"
                             "tmpdir=/tmp</listen><policy context=\"default\"><allow "
                             "send_destination=\"*\"/><allow eavesdrop=\"true\"/><allow own=\"*\"/>"
                             "</policy></busconfig>";
    daemon_.emplace(std::vector<std::string>{"dbus-daemon", "--nofork", "--print-address",
                                             "--config-file=" + config.string()});
    address_ = daemon_->line();
    fs::remove(config);
    if (runs()) ::setenv(kVariable, address_.c_str(), 1);
  }
  ~PrivateBus() {
    if (before_)
      ::setenv(kVariable, before_->c_str(), 1);
    else
      ::unsetenv(kVariable);
  }
  bool runs() const { return !address_.empty() && BusLibrary::load(); }

 private:
  static constexpr const char* kVariable = "DBUS_SESSION_BUS_ADDRESS";
  std::optional<std::string> before_;
  std::optional<ChildProcess> daemon_;
  std::string address_;
};

const std::vector<FileKind> kScans{{"Scans", {".ply", ".e57"}}, {"All files", {}}};

DialogAnswer ask(const FileQuestion& question, std::chrono::milliseconds starting = 2s) {
  return askPortal(question, "x11:1a", starting, {});
}

}  // namespace

TEST_CASE("an address of a file becomes its path, others none") {
  CHECK(pathOfUri("file:///home/a/scan.ply") == fs::path("/home/a/scan.ply"));
  CHECK(pathOfUri("file:///a%20b/%C3%A4.ply") == fs::path("/a b/\xc3\xa4.ply"));
  CHECK(pathOfUri("file://localhost/a") == fs::path("/a"));
  CHECK_FALSE(pathOfUri("file://server/a"));
  CHECK_FALSE(pathOfUri("sftp:///a"));
  CHECK_FALSE(pathOfUri("file:///a%2"));
  CHECK_FALSE(pathOfUri("file:///a%00b"));
  CHECK_FALSE(pathOfUri(""));
}

TEST_CASE("a pattern takes an extension in any case") {
  CHECK(globOf(".ply") == "*.[pP][lL][yY]");
  CHECK(globOf(".e57") == "*.[eE]57");
}

TEST_CASE("without a session's bus there is no dialog of the desktop, and nothing to tell") {
  const char* set = std::getenv("DBUS_SESSION_BUS_ADDRESS");
  const std::string before = set ? set : "";
  ::setenv("DBUS_SESSION_BUS_ADDRESS", "unix:path=/nonexistent/bus", 1);
  const DialogAnswer answer = ask({.title = "choose"});
  CHECK(answer.kind == Kind::Absent);
  CHECK(answer.why.empty());
  if (set)
    ::setenv("DBUS_SESSION_BUS_ADDRESS", before.c_str(), 1);
  else
    ::unsetenv("DBUS_SESSION_BUS_ADDRESS");
}

TEST_CASE("a portal's dialog is asked, understood, timed out and closed") {
  PrivateBus bus;
  if (!bus.runs()) {
    MESSAGE("skipped: no dbus-daemon or no libsystemd here");
    return;
  }
  CHECK(ask({.title = "choose"}).kind == Kind::Absent);  // no portal on it yet
  ChildProcess portal({"/usr/bin/python3", "-B", DAPPLE_MOCK_PORTAL});
  if (portal.line() != "ready") {
    MESSAGE("skipped: no python3-dbus and python3-gi here");
    return;
  }

  const FileQuestion open{.title = "choose", .accept = "Take", .folder = "/tmp", .kinds = kScans};
  const DialogAnswer chosen = ask(open);
  CHECK(chosen.kind == Kind::Chosen);
  CHECK(chosen.path == "/tmp/a scan.ply");
  nlohmann::json call = nlohmann::json::parse(portal.line());
  CHECK(call["member"] == "OpenFile");
  CHECK(call["parent"] == "x11:1a");
  CHECK(call["options"]["accept_label"] == "Take");
  CHECK(call["options"]["modal"] == true);
  CHECK(call["options"]["current_folder"] == std::string("/tmp") + '\0');
  CHECK(call["options"]["filters"] ==
        nlohmann::json::parse(R"([["Scans", [[0, "*.[pP][lL][yY]"], [0, "*.[eE]57"]]],
                                  ["All files", [[0, "*"]]]])"));

  const FileQuestion save{
      .purpose = BrowseFor::save, .title = "cancel", .name = "bunny", .kinds = kScans};
  CHECK(ask(save).kind == Kind::Cancelled);
  call = nlohmann::json::parse(portal.line());
  CHECK(call["member"] == "SaveFile");
  CHECK(call["options"]["current_name"] == "bunny.ply");

  CHECK(ask({.title = "break"}).kind == Kind::Failed);
  portal.line();
  const auto before = std::chrono::steady_clock::now();
  const DialogAnswer slow = ask({.title = "slow"}, 200ms);
  CHECK(slow.kind == Kind::Failed);
  CHECK(slow.why == "The desktop's dialog failed: it did not come in time.");
  CHECK(std::chrono::steady_clock::now() - before < 2s);

  {
    DesktopDialog dialog([](const FileQuestion& question, const std::stop_token& stop) {
      return askPortal(question, "", 2s, stop);
    });
    dialog.open({.title = "wait"});
    CHECK(nlohmann::json::parse(portal.line())["title"] == "wait");
    CHECK(dialog.isOpen());
    CHECK_FALSE(dialog.poll());
  }  // the program ends: so does the dialog
  CHECK(portal.line() == R"({"closed": true})");
}
