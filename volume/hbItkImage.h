#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "volume/hbSampleType.h"

/// One image file read by ITK's image IO, without ITK in the header. Private to the volume reader.
///
/// Everything ITK and the libraries under it have to say arrives as an hbError of one line; while a member runs, what
/// they would print to std::cerr is dropped. One runs at a time in a process (these libraries keep global state).
class hbItkImage {
public:
  enum class Format { nrrd, metaImage, nifti, tiff, vtk, dicom };

  /// Reads the header. Throws hbError where ITK cannot.
  hbItkImage(Format format, const std::filesystem::path& path);
  ~hbItkImage();
  hbItkImage(const hbItkImage&) = delete;
  hbItkImage& operator=(const hbItkImage&) = delete;

  const std::vector<std::int64_t>& sizes() const { return sizes_; } ///< One a dimension, 1 or more dimensions.
  int components() const { return components_; }
  std::size_t componentBytes() const { return componentBytes_; }
  /// Empty for integers of 64 bits, which `isUnsigned()` tells apart.
  std::optional<hbSampleType> type() const { return type_; }
  bool isUnsigned() const { return isUnsigned_; }

  /// The first three dimensions, world units; a dimension the file lacks has origin 0, spacing 1, its own direction.
  const glm::dvec3& origin() const { return origin_; }
  const glm::dvec3& spacing() const { return spacing_; }
  const std::array<glm::dvec3, 3>& directions() const { return directions_; }

  /// Reads all samples, components side by side, first dimension fastest, in the machine's byte order:
  /// componentBytes() * components() * the product of sizes() bytes.
  void read(std::byte* out);

private:
  struct Io;
  std::unique_ptr<Io> io_;
  std::filesystem::path path_;
  std::vector<std::int64_t> sizes_;
  int components_ = 1;
  std::size_t componentBytes_ = 1;
  std::optional<hbSampleType> type_;
  bool isUnsigned_ = false;
  glm::dvec3 origin_{0.0}, spacing_{1.0};
  std::array<glm::dvec3, 3> directions_;
};

namespace hb {

/// What all pages of a TIFF file share, and how many there are.
struct TiffPages {
  std::int64_t pages = 0;
  std::uint64_t bytes = 0; ///< Of all pages, decoded.
  bool compressed = false;
};

/// Walks the pages. Throws hbError for what ITK would read wrongly: pages of different kinds, integers of 32 or 64
/// bits, 64-bit floats.
TiffPages checkTiff(const std::filesystem::path& path);

} // namespace hb
