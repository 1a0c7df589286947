#include "volume/hbMappedFile.h"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "volume/hbError.h"

std::shared_ptr<const std::byte> hb::mapFile(const std::filesystem::path& path, std::uint64_t& size) {
  const auto fail = [&] {
    return hbError(fmt::format("{}: cannot be read: {}", path.string(), std::generic_category().message(errno)));
  };
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
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
  return {static_cast<const std::byte*>(address),
          [length = size](const std::byte* p) { ::munmap(const_cast<std::byte*>(p), length); }};
}
