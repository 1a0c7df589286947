#include "volume/hbMappedFile.h"

#include <algorithm>
#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "volume/hbError.h"

namespace {

/// The deleter of a mapping, and so what tells one from other shared bytes (see std::get_deleter).
struct Unmap {
  void* address;
  std::size_t length;
  void operator()(const std::byte*) const { ::munmap(address, length); }
};

/// Advice about the mapping that `bytes` share, whatever part of it they point to.
void advise(const std::shared_ptr<const std::byte>& bytes, int advice) {
  if (const auto* mapping = std::get_deleter<Unmap>(bytes)) ::madvise(mapping->address, mapping->length, advice);
}

} // namespace

std::shared_ptr<const std::byte> hb::mapFile(const std::filesystem::path& path, std::uint64_t& size) {
  const auto fail = [&] {
    return hbError(fmt::format("{}: cannot be read: {}", path.string(), std::generic_category().message(errno)));
  };
  // O_NONBLOCK: a named pipe is refused below instead of waited for.
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

void hb::adviseScatteredReads(const std::shared_ptr<const std::byte>& bytes) { advise(bytes, MADV_RANDOM); }

void hb::releasePages(const std::shared_ptr<const std::byte>& bytes) { advise(bytes, MADV_DONTNEED); }

void hb::releasePages(const std::shared_ptr<const std::byte>& bytes, std::uint64_t first, std::uint64_t count) {
  const auto* mapping = std::get_deleter<Unmap>(bytes);
  if (mapping == nullptr) return;
  // Linux maps as much of the file around a byte as lies together in its cache: up to the 2 MB of a huge page.
  constexpr std::uint64_t kAround = std::uint64_t{2} << 20;
  auto* start = static_cast<std::byte*>(mapping->address);
  const std::uint64_t offset = std::uint64_t(bytes.get() - start) + first, length = mapping->length,
                      from = (offset - std::min(offset, kAround)) / kAround * kAround;
  if (from < length) ::madvise(start + from, std::min(length, offset + count + kAround) - from, MADV_DONTNEED);
}
