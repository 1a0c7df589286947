#include "volume/hbVolumeReader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <new>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/geometric.hpp>
#include <zlib.h>

#include "volume/hbDicomHeader.h"
#include "volume/hbError.h"
#include "volume/hbHeaderText.h"
#include "volume/hbItkImage.h"
#include "volume/hbMappedFile.h"
#include "volume/hbMetaImageHeader.h"
#include "volume/hbNrrdHeader.h"
#include "volume/hbVtkHeader.h"

namespace fs = std::filesystem;
using Format = hbItkImage::Format;

namespace {

constexpr std::string_view kFormats = ".nrrd, .nhdr, .mha, .mhd, .nii, .nii.gz, .tif, .tiff, .vtk, .dcm, .raw, or a "
                                      "folder of DICOM slices";
constexpr std::string_view kLps = "left-posterior-superior";

// The most bytes that a compressed byte can stand for. Deflate: 258 bytes in 2 bits. Others (the codecs of TIFF and
// DICOM) have no such bound; this one is far beyond what pictures reach.
constexpr std::uint64_t kDeflateRatio = 1032;
constexpr std::uint64_t kAnyRatio = 65536;

std::uint64_t bytesOf(std::int64_t samples, std::int64_t components, std::size_t each) {
  std::uint64_t bytes = 0;
  if (__builtin_mul_overflow(std::uint64_t(samples), std::uint64_t(components) * each, &bytes))
    return std::numeric_limits<std::uint64_t>::max();
  return bytes;
}

std::uint64_t fileSize(const fs::path& path) {
  std::error_code failed;
  const std::uint64_t size = fs::file_size(path, failed);
  if (failed) throw hbError(fmt::format("{}: cannot be read: {}", path.string(), failed.message()));
  return size;
}

void requireFile(const fs::path& path, std::uint64_t expected, std::uint64_t found) {
  if (found < expected)
    throw hbError(fmt::format("{}: expected at least {} bytes of samples, found {}", path.string(), expected, found));
}

/// A compressed file, too small for what its header promises.
void requireRatio(const fs::path& path, std::uint64_t expected, std::uint64_t found, std::uint64_t ratio) {
  if (found < expected / ratio)
    throw hbError(fmt::format("{}: expected {} bytes of samples, which {} compressed bytes cannot hold", path.string(),
                              expected, found));
}

std::shared_ptr<std::byte> allocate(const fs::path& path, std::uint64_t bytes, const hbReadOptions& options) {
  const auto fail = [&](std::string_view limit) {
    return hbError(fmt::format("{}: needs {} bytes of memory for its samples, {}", path.string(), bytes, limit));
  };
  if (bytes > options.memoryLimit) throw fail(fmt::format("the limit is {}", options.memoryLimit));
  try {
    return {new std::byte[bytes], std::default_delete<std::byte[]>()};
  } catch (const std::bad_alloc&) {
    throw fail("which there is not");
  }
}

/// The sizes of the first three dimensions; the others must be 1.
hbSize3 sizesOf(const fs::path& path, const std::vector<std::int64_t>& sizes) {
  if (!hb::productOf(sizes))
    throw hbError(fmt::format("{}: expected at least one sample along each axis and fewer than 2^60 in all, found {}",
                              path.string(), hb::sizesText(sizes)));
  hbSize3 result(1);
  for (std::size_t d = 0; d < sizes.size(); ++d) {
    if (d < 3)
      result[int(d)] = sizes[d];
    else if (sizes[d] != 1)
      throw hbError(fmt::format("{}: expected a volume of three dimensions, found {} ({}); split a time series into "
                                "one file a step",
                                path.string(), sizes.size(), hb::sizesText(sizes)));
  }
  return result;
}

/// ITK's coordinates as ours: positive spacings, unit directions.
hbGeometry geometryOf(const fs::path& path, const hbItkImage& image, std::string_view space) {
  hbGeometry g;
  g.size = sizesOf(path, image.sizes());
  g.origin = image.origin();
  g.space = space;
  for (int d = 0; d < 3; ++d) {
    const glm::dvec3 step = image.directions()[std::size_t(d)] * image.spacing()[d];
    g.spacing[d] = glm::length(step);
    if (g.spacing[d] > 0.0) g.direction[d] = step / g.spacing[d];
  }
  g.validate(path.string());
  return g;
}

/// Integers of 64 bits, packed, as int32 or uint32, where they fit.
template <class Wide, class Narrow, bool Swapped>
hbVolume narrowed(const fs::path& path, const hbGeometry& geometry, int components, const std::byte* data) {
  std::vector<Narrow> samples(std::size_t(geometry.samples() * components));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto value = hb::loadSample<Wide, Swapped>(data + i * sizeof(Wide));
    samples[i] = Narrow(value);
    if (Wide(samples[i]) != value)
      throw hbError(
          fmt::format("{}: expected 64-bit integers whose values fit 32 bits, found {}", path.string(), value));
  }
  return hbVolume::fromSamples(geometry, std::move(samples), components);
}

/// The volume of an image's samples, which lie packed in `data`.
hbVolume packedVolume(const fs::path& path, const hbItkImage& image, const hbGeometry& geometry,
                      const std::shared_ptr<const std::byte>& data, bool swapped) {
  const int components = image.components();
  if (image.type()) {
    hbVolume::Layout layout = hbVolume::Layout::packed(geometry.size, components);
    layout.byteSwapped = swapped && image.componentBytes() > 1;
    return hbVolume(geometry, *image.type(), components, data, layout);
  }
  const auto narrow =
      image.isUnsigned()
          ? (swapped ? narrowed<std::uint64_t, std::uint32_t, true> : narrowed<std::uint64_t, std::uint32_t, false>)
          : (swapped ? narrowed<std::int64_t, std::int32_t, true> : narrowed<std::int64_t, std::int32_t, false>);
  return narrow(path, geometry, components, data.get());
}

/// Reads the samples through ITK; the file is known to be large enough for them.
hbVolume decode(const fs::path& path, hbItkImage& image, const hbGeometry& geometry, const hbReadOptions& options,
                hbProgress& progress) {
  const std::uint64_t bytes = bytesOf(geometry.samples(), image.components(), image.componentBytes());
  const std::shared_ptr<std::byte> data = allocate(path, bytes, options);
  progress.begin("reading", std::int64_t(bytes), "bytes");
  progress.advance(0);
  image.read(data.get());
  progress.advance(std::int64_t(bytes));
  return packedVolume(path, image, geometry, data, false);
}

/// Maps a file from `offset` on, where it must have `bytes`.
std::shared_ptr<const std::byte> mappedBytes(const fs::path& path, std::uint64_t offset, std::uint64_t bytes) {
  std::uint64_t size = 0;
  const std::shared_ptr<const std::byte> file = hb::mapFile(path, size);
  requireFile(path, bytes, size - std::min(size, offset));
  return {file, file.get() + offset};
}

/// Inflates `bytes` bytes from a zlib or gzip stream that starts at `offset`. (MetaIO would not notice its end.)
std::shared_ptr<const std::byte> inflated(const fs::path& path, std::uint64_t offset, std::uint64_t bytes,
                                          const hbReadOptions& options, hbProgress& progress) {
  std::uint64_t size = 0;
  const std::shared_ptr<const std::byte> file = hb::mapFile(path, size);
  const std::shared_ptr<std::byte> data = allocate(path, bytes, options);
  progress.begin("reading", std::int64_t(bytes), "bytes");
  z_stream stream{};
  inflateInit2(&stream, 15 + 32); // 32: either header
  const std::unique_ptr<z_stream, int (*)(z_stream*)> closer(&stream, inflateEnd);
  // zlib counts in 32 bits: pieces of a size that lets progress show, too.
  constexpr std::uint64_t kPiece = 1 << 24;
  std::uint64_t read = std::min(offset, size), written = 0;
  int status = Z_OK;
  while (written < bytes && status == Z_OK) {
    const auto in = uInt(std::min(kPiece, size - read)), out = uInt(std::min(kPiece, bytes - written));
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(file.get() + read));
    stream.avail_in = in;
    stream.next_out = reinterpret_cast<Bytef*>(data.get() + written);
    stream.avail_out = out;
    status = inflate(&stream, Z_NO_FLUSH);
    read += in - stream.avail_in;
    written += out - stream.avail_out;
    progress.advance(std::int64_t(out - stream.avail_out));
  }
  if (written < bytes)
    throw hbError(fmt::format("{}: expected {} bytes of compressed samples, found {} and then {}", path.string(), bytes,
                              written, status == Z_STREAM_END || status == Z_BUF_ERROR ? "the end" : "damage"));
  return data;
}

/// The offset of the samples in a file where they start `skip` bytes after `start`, or are its end (skip -1).
std::uint64_t offsetOf(const fs::path& path, std::uint64_t start, std::int64_t skip, std::uint64_t bytes) {
  if (skip >= 0) return start + std::uint64_t(skip);
  const std::uint64_t size = fileSize(path);
  requireFile(path, bytes, size);
  return size - bytes;
}

/// Where `lines` lines after `offset` end.
std::uint64_t skipLines(const fs::path& path, std::uint64_t offset, std::int64_t lines) {
  if (lines == 0) return offset;
  std::uint64_t size = 0;
  const std::shared_ptr<const std::byte> file = hb::mapFile(path, size);
  const std::byte* const end = file.get() + size;
  const std::byte* at = file.get() + std::min(offset, size);
  for (; lines > 0 && at != end; --lines) at = std::min(std::find(at, end, std::byte{'\n'}) + 1, end);
  return std::uint64_t(at - file.get());
}

std::uint64_t totalSize(const std::vector<fs::path>& files) {
  std::uint64_t total = 0;
  for (const fs::path& file : files) total += fileSize(file);
  return total;
}

hbVolume readNrrd(const fs::path& path, const hbReadOptions& options, hbProgress& progress) {
  const hbNrrdHeader header = hb::readNrrdHeader(path);
  const hbGeometry& geometry = header.geometry;
  std::uint64_t stored = header.files.empty() ? fileSize(path) - header.dataOffset : totalSize(header.files);
  hbItkImage image(Format::nrrd, path);
  const int fileComponents = image.components() + (header.masked ? 1 : 0);
  const std::uint64_t bytes = bytesOf(geometry.samples(), fileComponents, image.componentBytes());
  const bool raw = header.encoding == "raw";
  if (raw || header.encoding == "hex")
    requireFile(path, raw ? bytes : 2 * bytes, stored);
  else if (header.encoding == "ascii")
    requireFile(path, bytes / image.componentBytes(), stored); // a digit each, at the very least
  else
    requireRatio(path, bytes, stored, header.encoding == "gzip" ? kDeflateRatio : kAnyRatio);

  const auto finish = [&](hbVolume volume) {
    if (int(header.componentNames.size()) == volume.components()) volume.setComponentNames(header.componentNames);
    return volume;
  };
  if (!raw || header.files.size() > 1 || header.masked || !image.type()) {
    // ITK cuts sizes to 32 bits.
    if (sizesOf(path, image.sizes()) != geometry.size)
      throw hbError(fmt::format("{}: expected sizes below 2^32, found {}", path.string(), hb::sizesText(header.sizes)));
    return finish(decode(path, image, geometry, options, progress));
  }

  const fs::path& file = header.files.empty() ? path : header.files[0];
  const std::uint64_t start = skipLines(file, header.files.empty() ? header.dataOffset : 0, header.lineSkip);
  hbVolume::Layout layout;
  layout.byteSwapped = header.bigEndian && image.componentBytes() > 1;
  std::int64_t step = 1;
  int d = 0;
  for (std::size_t a = 0; a < header.sizes.size(); ++a) {
    if (int(a) == header.rangeAxis)
      layout.componentStride = step;
    else if (d < 3)
      layout.stride[std::size_t(d++)] = step;
    step *= header.sizes[a];
  }
  const std::uint64_t offset = offsetOf(file, start, header.byteSkip, bytes);
  return finish(hbVolume(geometry, *image.type(), image.components(), mappedBytes(file, offset, bytes), layout));
}

hbVolume readMetaImage(const fs::path& path, const hbReadOptions& options, hbProgress& progress) {
  const hbMetaImageHeader header = hb::readMetaImageHeader(path);
  const std::uint64_t stored = header.files.empty() ? fileSize(path) - header.dataOffset : totalSize(header.files);
  // The samples are counted before ITK sees the header, as it reads sizes into 32 bits.
  const std::uint64_t values = bytesOf(*hb::productOf(header.sizes), header.components, 1);
  if (header.compressed)
    requireRatio(path, values, stored, kDeflateRatio);
  else
    requireFile(path, values, stored);
  if (header.ascii) {
    const fs::path& file = header.files.empty() ? path : header.files[0];
    const std::int64_t found = hb::countWords(file, header.files.empty() ? header.dataOffset : 0);
    if (std::uint64_t(found) < values)
      throw hbError(fmt::format("{}: expected {} values, found {}", path.string(), values, found));
  }

  hbItkImage image(Format::metaImage, path);
  if (image.sizes() != header.sizes || image.components() != header.components)
    throw hbError(fmt::format("{}: expected sizes below 2^31, found {}", path.string(), hb::sizesText(header.sizes)));
  const hbGeometry geometry = geometryOf(path, image, header.oriented ? kLps : "");
  const std::uint64_t bytes = bytesOf(geometry.samples(), image.components(), image.componentBytes());
  if (header.ascii) return decode(path, image, geometry, options, progress);
  if (header.compressed)
    requireRatio(path, bytes, stored, kDeflateRatio);
  else
    requireFile(path, bytes, stored);
  if (header.files.size() > 1) {
    if (header.compressed)
      throw hbError(fmt::format("{}: expected compressed samples in one file, found a list of {}", path.string(),
                                header.files.size()));
    for (const fs::path& file : header.files) requireFile(file, bytes / header.files.size(), fileSize(file));
    return decode(path, image, geometry, options, progress);
  }
  const bool local = header.files.empty();
  const fs::path& file = local ? path : header.files[0];
  std::uint64_t offset = header.dataOffset;
  if (!local)
    offset =
        offsetOf(file, 0, header.compressed ? std::max<std::int64_t>(0, header.headerSize) : header.headerSize, bytes);
  const auto data =
      header.compressed ? inflated(file, offset, bytes, options, progress) : mappedBytes(file, offset, bytes);
  return packedVolume(path, image, geometry, data, header.bigEndian);
}

/// The whole of a gzip file is inflated once to learn its length, and that it is complete: niftilib takes what is
/// missing for zeros. `start` receives the first bytes.
std::uint64_t inflatedSize(const fs::path& path, std::vector<std::byte>& start) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), gzclose);
  std::vector<std::byte> chunk(std::size_t{1} << 18);
  const std::size_t wanted = start.size();
  start.clear();
  std::uint64_t size = 0;
  int read = -1;
  while (file && (read = gzread(file.get(), chunk.data(), unsigned(chunk.size()))) > 0) {
    const std::size_t missing = std::min(wanted - start.size(), std::size_t(read));
    start.insert(start.end(), chunk.begin(), chunk.begin() + std::ptrdiff_t(missing));
    size += std::uint64_t(read);
  }
  int status = Z_OK;
  const char* reason = file ? gzerror(file.get(), &status) : "cannot be opened";
  if (read < 0 || status < 0) throw hbError(fmt::format("{}: cannot be read: gzip: {}", path.string(), reason));
  return size;
}

hbVolume readNifti(const fs::path& path, bool compressed, const hbReadOptions& options, hbProgress& progress) {
  // What the file itself holds, as ITK's types differ where a slope makes floats.
  // https://nifti.nimh.nih.gov/pub/dist/src/niftilib/nifti1.h
  constexpr std::size_t kHeader = 348, kDims = 40, kBits = 72, kSpacings = 80, kOffset = 108, kQform = 252,
                        kSform = 254, kQuaternion = 256, kRows = 280;
  std::vector<std::byte> header(kHeader);
  std::uint64_t size = 0;
  if (compressed) {
    size = inflatedSize(path, header);
  } else {
    const std::shared_ptr<const std::byte> file = hb::mapFile(path, size);
    header.assign(file.get(), file.get() + std::min<std::uint64_t>(size, kHeader));
  }
  if (header.size() < kHeader)
    throw hbError(fmt::format("{}: expected a NIfTI header of {} bytes, found {}", path.string(), kHeader, size));
  const bool swapped = hb::loadSample<std::int32_t, false>(header.data()) != std::int32_t(kHeader);
  const auto int16 = [&](std::size_t at) {
    return swapped ? hb::loadSample<std::int16_t, true>(header.data() + at)
                   : hb::loadSample<std::int16_t, false>(header.data() + at);
  };
  const auto float32 = [&](std::size_t at) {
    return swapped ? hb::loadSample<float, true>(header.data() + at) : hb::loadSample<float, false>(header.data() + at);
  };
  std::vector<std::int64_t> dims;
  for (int d = 1; d <= std::clamp<int>(int16(kDims), 1, 7); ++d) dims.push_back(int16(kDims + 2 * std::size_t(d)));
  const std::optional<std::int64_t> samples = hb::productOf(dims);
  if (!samples)
    throw hbError(fmt::format("{}: expected at least one sample along each axis and fewer than 2^60 in all, found {}",
                              path.string(), hb::sizesText(dims)));
  // Coordinates that are not finite, or nearly so, send ITK into endless loops.
  const auto requireCoordinates = [&](std::size_t at, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
      if (const float value = float32(at + 4 * i); !(std::abs(value) < 1e15F))
        throw hbError(
            fmt::format("{}: byte {}: expected coordinates below 1e15, found {}", path.string(), at + 4 * i, value));
  };
  requireCoordinates(kSpacings, std::min<std::size_t>(3, dims.size()));
  if (int16(kQform) > 0) requireCoordinates(kQuaternion, 6);
  if (int16(kSform) > 0) requireCoordinates(kRows, 12);
  const float start = float32(kOffset);
  if (!(start >= 0.0F && start < 0x1p62F))
    throw hbError(fmt::format("{}: expected samples after the header, found them at byte {}", path.string(), start));
  requireFile(path, bytesOf(*samples, 1, std::size_t(std::max<int>(8, int16(kBits))) / 8),
              size - std::min(size, std::uint64_t(start)));

  hbItkImage image(Format::nifti, path);
  return decode(path, image, geometryOf(path, image, kLps), options, progress);
}

hbVolume readTiff(const fs::path& path, const hbReadOptions& options, hbProgress& progress) {
  const hb::TiffPages pages = hb::checkTiff(path);
  if (pages.compressed)
    requireRatio(path, pages.bytes, fileSize(path), kAnyRatio);
  else
    requireFile(path, pages.bytes, fileSize(path));
  hbItkImage image(Format::tiff, path);
  return decode(path, image, geometryOf(path, image, ""), options, progress);
}

hbVolume readVtk(const fs::path& path, const hbReadOptions& options, hbProgress& progress) {
  const hbVtkHeader header = hb::readVtkHeader(path);
  hbItkImage image(Format::vtk, path);
  hbGeometry geometry;
  geometry.size = sizesOf(path, header.sizes);
  geometry.origin = header.origin;
  geometry.spacing = header.spacing;
  geometry.validate(path.string());
  std::vector<std::int64_t> itkSizes = image.sizes();
  itkSizes.resize(3, 1);
  if (itkSizes != header.sizes)
    throw hbError(fmt::format("{}: expected sizes below 2^32, found {}", path.string(), hb::sizesText(header.sizes)));
  const std::uint64_t values = bytesOf(geometry.samples(), image.components(), 1);
  if (header.ascii && std::uint64_t(header.textValues) < values)
    throw hbError(fmt::format("{}: expected {} values, found {}", path.string(), values, header.textValues));
  if (!header.ascii)
    requireFile(path, bytesOf(geometry.samples(), image.components(), image.componentBytes()),
                fileSize(path) - header.dataOffset);
  hbVolume volume = decode(path, image, geometry, options, progress);
  if (volume.components() == 1) volume.setComponentNames({header.name});
  return volume;
}

/// A DICOM file as ITK may see it: whole, and not far more than its bytes can hold.
hbDicomHeader checkDicom(const fs::path& path) {
  hbDicomHeader header = hb::readDicomHeader(path);
  requireRatio(path, header.decodedBytes(), header.pixelBytes, kAnyRatio);
  return header;
}

/// One DICOM file, of one slice or several frames.
hbVolume readDicomFile(const fs::path& path, const hbReadOptions& options, hbProgress& progress) {
  checkDicom(path);
  hbItkImage image(Format::dicom, path);
  return decode(path, image, geometryOf(path, image, kLps), options, progress);
}

/// A slice and where it lies along the normal of its series.
struct Slice {
  fs::path file;
  double place = 0.0;
};

/// The slices of a folder (not of those inside it), by series: its UID, with the size and orientation of the slices,
/// as series mix them.
std::map<std::string, std::vector<Slice>> findSeries(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code failed;
  for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed))
    if (at->is_regular_file()) files.push_back(at->path());
  if (failed) throw hbError(fmt::format("{}: cannot be read: {}", folder.string(), failed.message()));
  std::sort(files.begin(), files.end());

  std::map<std::string, std::vector<Slice>> series;
  for (const fs::path& file : files) {
    if (!hb::isDicom(file) || file.filename() == "DICOMDIR") continue;
    const hbDicomHeader h = checkDicom(file);
    const std::string name =
        fmt::format("{} ({} x {}, rows ({:.3f},{:.3f},{:.3f}), columns ({:.3f},{:.3f},{:.3f}))", h.series, h.columns,
                    h.rows, h.row.x, h.row.y, h.row.z, h.column.x, h.column.y, h.column.z);
    series[name].push_back({file, glm::dot(h.position, glm::cross(h.row, h.column))});
  }
  for (auto& [name, slices] : series)
    std::stable_sort(slices.begin(), slices.end(), [](const Slice& a, const Slice& b) { return a.place < b.place; });
  return series;
}

/// The files of the series that the options choose, or of the only one, in the order of their places.
std::vector<fs::path> chooseSeries(const fs::path& folder, const std::string& wanted) {
  const auto series = findSeries(folder);
  if (series.empty())
    throw hbError(fmt::format("{}: expected a folder with DICOM slices, found none", folder.string()));
  std::vector<std::string> all, matching;
  for (const auto& [name, slices] : series) {
    all.push_back(name);
    if (name.starts_with(wanted)) matching.push_back(name);
  }
  if (matching.size() != 1)
    throw hbError(fmt::format("{}: expected one DICOM series{}, found {}; choose one of {}", folder.string(),
                              wanted.empty() ? "" : fmt::format(" that starts with '{}'", wanted), matching.size(),
                              fmt::join(all, ", ")));
  std::vector<fs::path> files;
  for (const Slice& slice : series.at(matching[0])) files.push_back(slice.file);
  return files;
}

hbVolume readDicomFolder(const fs::path& folder, const hbReadOptions& options, hbProgress& progress) {
  const std::vector<fs::path> files = chooseSeries(folder, options.series);
  if (files.size() == 1) return readDicomFile(files[0], options, progress);

  // The slices' positions, before anything large is read.
  hbItkImage first(Format::dicom, files[0]);
  hbGeometry geometry = geometryOf(files[0], first, kLps);
  const std::uint64_t sliceBytes = bytesOf(geometry.samples(), first.components(), first.componentBytes());
  const auto count = std::int64_t(files.size());
  if (geometry.size.z != 1 || !first.type())
    throw hbError(fmt::format("{}: expected one slice a file, of integers up to 32 bits or floats", files[0].string()));
  const glm::dvec3 last = hbItkImage(Format::dicom, files.back()).origin();
  const glm::dvec3 step = (last - geometry.origin) / double(count - 1);
  if (!(glm::length(step) > 0.0))
    throw hbError(fmt::format("{}: expected DICOM slices at different positions, found all at one", folder.string()));
  geometry.size.z = count;
  geometry.spacing.z = glm::length(step);
  geometry.direction[2] = step / geometry.spacing.z;
  geometry.validate(folder.string());

  const std::shared_ptr<std::byte> data = allocate(folder, bytesOf(count, 1, sliceBytes), options);
  progress.begin("reading", count, "slices");
  for (std::int64_t k = 0; k < count; ++k) {
    const fs::path& file = files[std::size_t(k)];
    hbItkImage slice(Format::dicom, file);
    const hbGeometry g = geometryOf(file, slice, kLps);
    if (g.size != hbSize3(geometry.size.x, geometry.size.y, 1) || slice.type() != first.type() ||
        slice.components() != first.components())
      throw hbError(fmt::format("{}: expected the size and type of the series' first slice, {} x {}, found {} x {}",
                                file.string(), geometry.size.x, geometry.size.y, g.size.x, g.size.y));
    // A hundredth of the spacing is more than scanners round, and far less than a missing slice.
    const double off = glm::length(slice.origin() - geometry.origin - double(k) * step);
    if (off > 0.01 * geometry.spacing.z)
      throw hbError(
          fmt::format("{}: expected evenly spaced DICOM slices, {} apart; this one is off by {} (one missing?)",
                      file.string(), geometry.spacing.z, off));
    slice.read(data.get() + std::uint64_t(k) * sliceBytes);
    progress.advance(1);
  }
  return hbVolume(geometry, *first.type(), first.components(), data,
                  hbVolume::Layout::packed(geometry.size, first.components()));
}

} // namespace

hbVolume hb::readVolume(const fs::path& path, const hbReadOptions& options, hbProgress& progress) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (!fs::exists(status)) throw hbError(fmt::format("{}: expected a file or folder, found none", path.string()));
  if (fs::is_directory(status)) return readDicomFolder(path, options, progress);
  if (!fs::is_regular_file(status))
    throw hbError(fmt::format("{}: expected a file or folder, found a device or pipe", path.string()));
  if (options.raw) return openRawFile(path, *options.raw);

  const std::string name = lowered(path.filename().string());
  const auto is = [&](std::string_view extension) { return name.ends_with(extension); };
  if (is(".nrrd") || is(".nhdr")) return readNrrd(path, options, progress);
  if (is(".mha") || is(".mhd")) return readMetaImage(path, options, progress);
  if (is(".nii") || is(".nii.gz")) return readNifti(path, is(".gz"), options, progress);
  if (is(".tif") || is(".tiff")) return readTiff(path, options, progress);
  if (is(".vtk")) return readVtk(path, options, progress);
  if (is(".dcm")) return readDicomFile(path, options, progress);
  if (is(".raw")) {
    if (const auto layout = rawLayoutFromName(path)) return openRawFile(path, *layout);
    throw hbError(fmt::format("{}: expected the size and type of the raw samples, in the name as in "
                              "name_256x256x128_uint16.raw or as options",
                              path.string()));
  }
  throw hbError(fmt::format("{}: expected a volume file, {}", path.string(), kFormats));
}
