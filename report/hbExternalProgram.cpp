#include "report/hbExternalProgram.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "volume/hbError.h"

namespace {

constexpr int kPollMilliseconds = 50; ///< How often a cancelled progress is looked for.

/// A file descriptor, closed when it goes; never inherited by programs.
class Descriptor {
public:
  explicit Descriptor(int value = -1) : value_(value) {}
  Descriptor(Descriptor&& other) noexcept : value_(std::exchange(other.value_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(value_, other.value_);
    return *this;
  }
  ~Descriptor() { close(); }
  int get() const { return value_; }
  bool open() const { return value_ >= 0; }
  void close() {
    if (open()) ::close(std::exchange(value_, -1));
  }

private:
  int value_;
};

struct Pipe {
  Descriptor read, write;
};

hbError failure(const std::filesystem::path& program, std::string_view what, int code) {
  return hbError(fmt::format("{}: {}: {}", program.string(), what, std::strerror(code)));
}

Pipe makePipe(const std::filesystem::path& program) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw failure(program, "no pipe to read its output from", errno);
  return {Descriptor(ends[0]), Descriptor(ends[1])};
}

/// The input as a file in memory: unlike a pipe it can be filled before the program starts, and a program that does not
/// read it raises no SIGPIPE.
Descriptor inputFile(std::string_view input, const std::filesystem::path& program) {
  Descriptor file(memfd_create("input", MFD_CLOEXEC));
  if (!file.open()) throw failure(program, "no file in memory for its input", errno);
  while (!input.empty()) {
    const ssize_t written = write(file.get(), input.data(), input.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw failure(program, "its input cannot be stored", errno);
    input.remove_prefix(std::size_t(written));
  }
  lseek(file.get(), 0, SEEK_SET);
  return file;
}

pid_t start(const std::filesystem::path& program, const std::vector<std::string>& arguments, int input, int output,
            int errors) {
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, errors, STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  pid_t child = 0;
  const int code = posix_spawn(&child, program.c_str(), &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (code != 0) throw failure(program, "cannot be started", code);
  return child;
}

/// A running child; killed with all it started, and waited for, unless it ended before.
class Child {
public:
  explicit Child(pid_t id) : id_(id) {}
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (ended_) return;
    kill(-id_, SIGKILL);
    while (waitpid(id_, nullptr, 0) < 0 && errno == EINTR) continue;
  }
  /// The wait status, or none while it runs.
  std::optional<int> ended() {
    int status = 0;
    if (waitpid(id_, &status, WNOHANG) != id_) return std::nullopt;
    ended_ = true;
    return status;
  }

private:
  pid_t id_;
  bool ended_ = false;
};

/// Appends what there is to read; closes the descriptor at the end of file.
void readAvailable(Descriptor& from, std::string& to) {
  std::array<char, 65536> buffer;
  const ssize_t size = read(from.get(), buffer.data(), buffer.size());
  if (size > 0) to.append(buffer.data(), std::size_t(size));
  if (size == 0 || (size < 0 && errno != EINTR)) from.close();
}

void throwIfCancelled(const hbProgress& progress) {
  if (progress.cancelled()) throw hbCancelled();
}

/// Reads both to their ends, whichever has something.
void readBoth(Descriptor& output, Descriptor& errors, hbExternalProgram::Result& result, const hbProgress& progress) {
  while (output.open() || errors.open()) {
    throwIfCancelled(progress);
    std::array<pollfd, 2> waiting{pollfd{output.get(), POLLIN, 0}, pollfd{errors.get(), POLLIN, 0}};
    if (poll(waiting.data(), waiting.size(), kPollMilliseconds) <= 0) continue;
    if (waiting[0].revents != 0) readAvailable(output, result.output);
    if (waiting[1].revents != 0) readAvailable(errors, result.errors);
  }
}

/// Waits for a child that has closed its output, which is the end of nearly all.
int wait(Child& child, const hbProgress& progress) {
  while (true) {
    if (const auto status = child.ended()) return *status;
    throwIfCancelled(progress);
    poll(nullptr, 0, 1);
  }
}

bool executable(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored) && access(path.c_str(), X_OK) == 0;
}

/// The folders of PATH; an empty one stands for the current folder, as in a shell.
std::vector<std::filesystem::path> searchPath() {
  std::vector<std::filesystem::path> folders;
  const char* variable = std::getenv("PATH");
  if (variable == nullptr) return folders;
  std::string_view rest = variable;
  while (true) {
    const auto colon = rest.find(':');
    const std::string_view folder = rest.substr(0, colon);
    folders.emplace_back(folder.empty() ? "." : folder);
    if (colon == std::string_view::npos) return folders;
    rest.remove_prefix(colon + 1);
  }
}

} // namespace

std::string hbExternalProgram::Result::lastLine() const {
  const std::string_view text = errors;
  const auto end = text.find_last_not_of(" \t\r\n");
  if (end == std::string_view::npos) return "nothing";
  const auto begin = text.find_last_of('\n', end) + 1; // npos + 1 is 0
  return std::string(text.substr(begin, end + 1 - begin));
}

std::optional<hbExternalProgram> hbExternalProgram::find(std::string_view name,
                                                         const std::vector<std::filesystem::path>& folders) {
  if (name.find('/') != std::string_view::npos)
    return executable(name) ? std::optional(hbExternalProgram(name)) : std::nullopt;
  std::vector<std::filesystem::path> all = folders;
  for (auto& folder : searchPath()) all.push_back(std::move(folder));
  for (const auto& folder : all)
    if (executable(folder / name)) return hbExternalProgram(folder / name);
  return std::nullopt;
}

hbExternalProgram::Result hbExternalProgram::run(const std::vector<std::string>& arguments, std::string_view input,
                                                 hbProgress& progress) const {
  throwIfCancelled(progress);
  Pipe output = makePipe(path_), errors = makePipe(path_);
  Descriptor stored = inputFile(input, path_);
  Child child(start(path_, arguments, stored.get(), output.write.get(), errors.write.get()));
  output.write.close(); // or reading would never end
  errors.write.close();

  Result result;
  readBoth(output.read, errors.read, result, progress);
  const int status = wait(child, progress);
  result.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  result.status = WIFSIGNALED(status) ? 128 + result.signal : WEXITSTATUS(status);
  return result;
}

std::string hbExternalProgram::output(const std::vector<std::string>& arguments, std::string_view input,
                                      hbProgress& progress) const {
  Result result = run(arguments, input, progress);
  if (result.status != 0)
    throw hbError(fmt::format("{}: expected exit status 0, found {} and the message: {}", path_.string(), result.status,
                              result.lastLine()));
  return std::move(result.output);
}
