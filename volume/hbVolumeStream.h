#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "volume/hbError.h"
#include "volume/hbGeometry.h"
#include "volume/hbOutputFile.h"
#include "volume/hbSampleType.h"

/// Writes a volume file piece by piece, so that it may be larger than the memory. The file appears with commit().
///
/// The target's extension chooses the format; doc/files.md describes what each keeps:
/// - `.nrrd`: NRRD0005, attached header, raw encoding;
/// - `.vti`: VTK XML image data, appended raw data; samples that are cell centres become cell data;
/// - `.raw`: the samples only. The name must say their size and type (see hb::rawFileName).
class hbVolumeStream {
public:
  /// Writes the header. Throws hbError for an unknown extension, a geometry or name that the format cannot keep, and
  /// where the file cannot be made. `names`: one a component, or none.
  hbVolumeStream(const std::filesystem::path& target, const hbGeometry& geometry, hbSampleType type, int components,
                 const std::vector<std::string>& names = {});

  /// Writes the next samples as they lie in memory: the components of a sample side by side, then x, y, z. Pieces may
  /// be of any size. Throws hbError where the disk refuses, or there are more bytes than the volume has.
  void write(std::span<const std::byte> samples);

  /// Completes the file and puts it in place; throws hbError where samples are missing or the disk refuses.
  void commit();

  /// Bytes of all samples.
  std::uint64_t bytes() const { return bytes_; }

private:
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  hbError failure() const; ///< Says what errno says.
  void put(const void* data, std::size_t size);

  hbOutputFile output_;
  std::unique_ptr<std::FILE, Closer> file_;
  std::uint64_t bytes_ = 0;
  std::uint64_t written_ = 0;
  std::uint64_t begun_ = 0; ///< Of those, what the disk was told to write.
  std::string footer_;
};
