#include "report/hbFolderLock.h"

#include <cerrno>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include "volume/hbError.h"

hbFolderLock::hbFolderLock(const std::filesystem::path& folder)
    : folder_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (folder_ < 0) throw hbError(fmt::format("{}: cannot be opened as a folder", folder.string()));
  if (::flock(folder_, LOCK_EX | LOCK_NB) == 0) return;
  const bool isBusy = errno == EWOULDBLOCK;
  ::close(folder_);
  // A file system that knows no locks is no reason to refuse work.
  folder_ = -1;
  if (isBusy) throw hbError(fmt::format("{}: another process is at work there", folder.string()));
}

hbFolderLock::~hbFolderLock() {
  if (folder_ >= 0) ::close(folder_); // which unlocks it
}
