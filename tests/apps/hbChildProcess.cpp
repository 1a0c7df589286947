#include "tests/apps/hbChildProcess.h"

#include <cerrno>
#include <csignal>
#include <stdexcept>

#include <sys/wait.h>
#include <unistd.h>

namespace {

// Between fork and exec: only what a signal handler may call.
[[noreturn]] void becomeProgram(char* const* arguments, const hbChildProcess::Place& place) {
  if (place.out >= 0) ::dup2(place.out, STDOUT_FILENO);
  if (place.err >= 0) ::dup2(place.err, STDERR_FILENO);
  if (place.fileBytes) {
    const rlimit limit{*place.fileBytes, *place.fileBytes};
    if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) ::_exit(126);
  }
  if (!place.folder.empty() && ::chdir(place.folder.c_str()) != 0) ::_exit(126);
  ::execv(HBVOL_PROGRAM, arguments);
  ::_exit(127);
}

} // namespace

hbChildProcess::hbChildProcess(std::vector<std::string> arguments, const Place& place) {
  std::string program = "hbvol";
  std::vector<char*> pointers{program.data()};
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  child_ = ::fork();
  if (child_ < 0) throw std::runtime_error("fork failed");
  if (child_ == 0) becomeProgram(pointers.data(), place);
}

hbChildProcess::~hbChildProcess() {
  signal(SIGKILL);
  wait();
}

void hbChildProcess::signal(int number) const {
  if (!result_) ::kill(child_, number);
}

bool hbChildProcess::look(int options) {
  int status = 0;
  pid_t ended = 0;
  while (!result_ && (ended = ::wait4(child_, &status, options, &usage_)) < 0 && errno == EINTR) {
  }
  if (ended == child_) result_ = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  return result_.has_value();
}

bool hbChildProcess::running() { return !look(WNOHANG); }

int hbChildProcess::wait() {
  look(0);
  return result_.value();
}
