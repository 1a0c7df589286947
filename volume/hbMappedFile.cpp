#include "volume/hbMappedFile.h"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "volume/hbError.h"

namespace {

/// Ends a mapping, and tells its pointers from others.
struct Unmap {
  void* address;
  std::uint64_t length;
  void operator()(const std::byte*) const { ::munmap(address, length); }
};

} // namespace

std::shared_ptr<const std::byte> hb::mapFile(const std::filesystem::path& path, std::uint64_t& size) {
  const auto fail = [&] {
    return hbError(fmt::format("{}: cannot be read: {}", path.string(), std::generic_category().message(errno)));
  };
  // O_NONBLOCK has no effect on files, but keeps a named pipe from waiting for a writer.
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) throw fail();
  const std::shared_ptr<const int> closer(&file, [](const int* f) { ::close(*f); });
  struct stat status {};
  if (::fstat(file, &status) != 0) throw fail();
  if (!S_ISREG(status.st_mode))
    throw hbError(fmt::format("{}: expected a file, found {}", path.string(),
                              S_ISDIR(status.st_mode) ? "a folder" : "a device or pipe"));
  size = std::uint64_t(status.st_size);
  static const std::byte kNothing{};
  if (size == 0) return {std::shared_ptr<const void>(), &kNothing};
  void* address = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
  if (address == MAP_FAILED) throw fail();
  return {static_cast<const std::byte*>(address), Unmap{address, size}};
}

void hb::releaseMapped(const std::shared_ptr<const std::byte>& data) {
  if (const auto* mapping = std::get_deleter<Unmap>(data)) ::madvise(mapping->address, mapping->length, MADV_DONTNEED);
}
