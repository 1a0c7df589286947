#include "volume/hbOutputFile.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "volume/hbError.h"

namespace fs = std::filesystem;

namespace {

// What a signal handler may read: fixed storage, a slot in use while its flag is set.
constexpr int kSlots = 16;
constexpr std::size_t kPathBytes = 4096;
std::array<std::array<char, kPathBytes>, kSlots> slotPaths;
std::array<std::atomic<bool>, kSlots> slotUsed{};
std::mutex slotMutex;

int takeSlot(const std::string& path) {
  const std::lock_guard lock(slotMutex);
  for (int i = 0; i < kSlots; ++i) {
    if (slotUsed[i] || path.size() >= kPathBytes) continue;
    std::memcpy(slotPaths[i].data(), path.c_str(), path.size() + 1);
    slotUsed[i] = true;
    return i;
  }
  throw hbError(fmt::format("{}: too many files being written at once, or too long a path", path));
}

std::string reason() { return std::generic_category().message(errno); }

} // namespace

hbOutputFile::hbOutputFile(const fs::path& target) : target_(target) {
  std::error_code ignored;
  if (fs::is_symlink(fs::symlink_status(target_, ignored))) target_ = fs::weakly_canonical(target_, ignored);
  const fs::file_status status = fs::status(target_, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw hbError(fmt::format("{}: expected a regular file to write, found {}", target.string(),
                              fs::is_directory(status) ? "a folder" : "a device or pipe"));
  if (!target_.has_filename())
    throw hbError(fmt::format("'{}': expected the name of a file to write", target.string()));

  for (int attempt = 0; slot_ < 0; ++attempt) {
    temporary_ = target_.parent_path() / fmt::format(".{}.{}-{}.tmp{}", target_.stem().string(), ::getpid(), attempt,
                                                     target_.extension().string());
    const int file = ::open(temporary_.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    if (file < 0 && errno == EEXIST) continue;
    if (file < 0) throw hbError(fmt::format("{}: cannot be written: {}", target.string(), reason()));
    ::close(file);
    try {
      slot_ = takeSlot(temporary_.string());
    } catch (...) {
      ::unlink(temporary_.c_str());
      throw;
    }
  }
}

hbOutputFile::~hbOutputFile() {
  if (slot_ < 0) return;
  ::unlink(temporary_.c_str());
  slotUsed[slot_] = false;
}

void hbOutputFile::commit() {
  const int file = ::open(temporary_.c_str(), O_RDONLY | O_CLOEXEC);
  const bool flushed = file >= 0 && ::fsync(file) == 0;
  if (file >= 0) ::close(file);
  if (!flushed || ::rename(temporary_.c_str(), target_.c_str()) != 0)
    throw hbError(fmt::format("{}: cannot be written: {}", target_.string(), reason()));
  slotUsed[slot_] = false;
  slot_ = -1;
}

void hb::removeTemporaryFiles() noexcept {
  for (int i = 0; i < kSlots; ++i)
    if (slotUsed[i]) ::unlink(slotPaths[i].data());
}
