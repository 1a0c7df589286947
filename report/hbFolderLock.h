#pragma once

#include <filesystem>

/// Keeps a folder for one process (and one object in it) as long as it lives; others who ask are told. Advisory: it
/// stops nobody who does not ask. Ends with the process, whatever ends it.
class hbFolderLock {
public:
  /// Throws hbError where the folder is locked already, or is none.
  explicit hbFolderLock(const std::filesystem::path& folder);
  ~hbFolderLock();
  hbFolderLock(const hbFolderLock&) = delete;
  hbFolderLock& operator=(const hbFolderLock&) = delete;

private:
  int folder_ = -1; ///< Its descriptor.
};
