// hbvol: compresses 3D scalar volumes, renders from the compressed form, and says what that costs and loses.

#include <array>
#include <cstdio>
#include <new>
#include <span>
#include <string_view>

#include <fcntl.h>
#include <unistd.h>

#include "apps/CommandLine.h"
#include "volume/hbError.h"

namespace {

constexpr int kFailed = 1, kWrongUsage = 2;

/// Prints an error on one line, whatever characters a file's name has; returns `status`. Takes no memory, which may be
/// what there is none of.
int fail(std::string_view text, int status) noexcept {
  ::alarm(0); // an interrupt's last resort would say it again
  app::clearProgress();
  std::fputs("hbvol: error: ", stderr); // stderr may be closed: no reason to die
  while (!text.empty()) {
    std::array<char, 1024> piece;
    const std::size_t count = text.copy(piece.data(), piece.size());
    for (char& c : std::span(piece).first(count))
      if (static_cast<unsigned char>(c) < ' ' || c == 127) c = '?';
    std::fwrite(piece.data(), 1, count, stderr);
    text.remove_prefix(count);
  }
  std::fputs("\n", stderr);
  return status;
}

/// Descriptors 0 to 2 that the caller closed would be given to the first files opened, and messages written into them.
void openStandardStreams() {
  for (int file = ::open("/dev/null", O_RDWR); file >= 0; file = ::open("/dev/null", O_RDWR))
    if (file > STDERR_FILENO) {
      ::close(file);
      return;
    }
}

} // namespace

int main(int count, char** arguments) {
  try {
    openStandardStreams();
    app::handleInterrupts();
    app::CommandLine line;
    line.parse(count, arguments)();
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) throw hbError("standard output: cannot be written");
    return 0;
  } catch (const app::WrongUsage& error) {
    return fail(error.what(), kWrongUsage);
  } catch (const std::bad_alloc&) {
    return fail("out of memory", kFailed);
  } catch (const std::exception& error) {
    return fail(error.what(), kFailed);
  }
}
