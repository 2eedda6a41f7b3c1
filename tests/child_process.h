// Another program while a test goes on: what it prints is read line by line; killed in the end.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <utility>
#include <vector>

namespace dapple {

class ChildProcess {
 public:
  explicit ChildProcess(std::vector<std::string> command) {
    int ends[2] = {-1, -1};
    if (::pipe2(ends, O_CLOEXEC) != 0) return;
    std::vector<char*> arguments;
    for (std::string& word : command) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ == 0) {
      ::dup2(ends[1], STDOUT_FILENO);
      ::execvp(arguments[0], arguments.data());
      ::_exit(127);
    }
    ::close(ends[1]);
    output_ = ends[0];
  }
  ~ChildProcess() { kill(SIGTERM); }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // The next line without its end; empty when it ends or says nothing for some seconds.
  std::string line(int seconds = 10) {
    for (;;) {
      if (const std::size_t end = read_.find('\n'); end != std::string::npos) {
        std::string first = read_.substr(0, end);
        read_.erase(0, end + 1);
        return first;
      }
      pollfd wait{output_, POLLIN, 0};
      char bytes[4096];
      if (::poll(&wait, 1, 1000 * seconds) <= 0) return {};
      const ssize_t count = ::read(output_, bytes, sizeof bytes);
      if (count <= 0) return {};
      read_.append(bytes, static_cast<std::size_t>(count));
    }
  }
  void kill(int signal) {
    if (pid_ > 0) {
      ::kill(pid_, signal);
      ::waitpid(pid_, nullptr, 0);
    }
    if (output_ >= 0) ::close(output_);
    pid_ = output_ = -1;
  }

 private:
  int pid_ = -1, output_ = -1;
  std::string read_;
};

}  // namespace dapple
