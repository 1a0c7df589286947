#pragma once

#include <filesystem>

/// A file that appears whole or not at all: it is written beside its target under a temporary name and renamed by
/// commit().
///
/// Destroyed without commit(), it removes the temporary file and leaves the target as it was. The target may be a
/// symbolic link (its destination is replaced); an existing target that is no regular file is refused.
class hbOutputFile {
public:
  /// Creates the temporary file (empty, permissions by the umask). Throws hbError where the folder is missing or not
  /// writable, or the target is a folder or a device.
  explicit hbOutputFile(const std::filesystem::path& target);
  ~hbOutputFile();
  hbOutputFile(const hbOutputFile&) = delete;
  hbOutputFile& operator=(const hbOutputFile&) = delete;

  /// Where to write; ends with the target's own extension, as some libraries choose the format by it.
  const std::filesystem::path& path() const { return temporary_; }
  const std::filesystem::path& target() const { return target_; }

  /// Flushes to disk and renames onto the target; throws hbError (and leaves the target) when that fails.
  void commit();

private:
  std::filesystem::path target_;
  std::filesystem::path temporary_;
  int slot_ = -1; ///< Place in the table that removeTemporaryFiles() reads; -1 when the file is gone or renamed.
};

namespace hb {

/// Removes the temporary files of all living hbOutputFiles: for a signal handler that is about to end the process.
/// Async-signal-safe.
void removeTemporaryFiles() noexcept;

} // namespace hb
