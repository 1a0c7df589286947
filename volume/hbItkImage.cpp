#include "volume/hbItkImage.h"

#include <array>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <limits>
#include <mutex>
#include <sstream>
#include <tuple>

#include <fmt/format.h>
#include <itkGDCMImageIO.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkTIFFImageIO.h>
#include <itkVTKImageIO.h>
#include <tiffio.h>

#include "volume/hbError.h"

namespace fs = std::filesystem;

namespace {

std::mutex itkMutex;

/// The first of libtiff's complaints that concern the file's end; it reads on without what is missing.
std::string tiffComplaint;

__attribute__((format(printf, 2, 0))) void keepTiffComplaint(const char* /*module*/, const char* format,
                                                             va_list arguments) {
  std::array<char, 256> text{};
  std::vsnprintf(text.data(), text.size(), format, arguments);
  if (tiffComplaint.empty() && std::strstr(text.data(), "IO error") != nullptr) tiffComplaint = text.data();
}

/// Holds the mutex and keeps the libraries quiet: they print to std::cerr, libtiff through its handlers.
class Quiet {
public:
  Quiet()
      : lock_(itkMutex), cerr_(std::cerr.rdbuf(dropped_.rdbuf())), tiffError_(TIFFSetErrorHandler(nullptr)),
        tiffWarning_(TIFFSetWarningHandler(keepTiffComplaint)) {
    tiffComplaint.clear();
    itk::Object::SetGlobalWarningDisplay(false);
  }
  ~Quiet() {
    std::cerr.rdbuf(cerr_);
    TIFFSetErrorHandler(tiffError_);
    TIFFSetWarningHandler(tiffWarning_);
  }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

private:
  std::lock_guard<std::mutex> lock_;
  std::ostringstream dropped_;
  std::streambuf* cerr_;
  TIFFErrorHandler tiffError_, tiffWarning_;
};

/// One line of ITK's: without its class and address, and of the lines that teem stacks up only the last, the cause.
std::string reason(const itk::ExceptionObject& exception) {
  std::istringstream lines(exception.GetDescription());
  std::string line, text;
  for (bool stacked = false; std::getline(lines, line);) {
    line.erase(0, line.find_first_not_of(" \t"));
    line.erase(line.find_last_not_of(" \t\r:") + 1);
    if (line.empty()) continue;
    if (line.starts_with("itk::ERROR: "))
      if (const auto end = line.find("): "); end != std::string::npos) line.erase(0, end + 3);
    if (line.starts_with('[')) {
      stacked = true;
      if (const auto end = line.find(": "); end != std::string::npos) line.erase(0, end + 2);
    }
    if (stacked) text.clear();
    if (!text.empty()) text += "; ";
    text += line;
  }
  return text;
}

/// Calls f with the libraries quiet; whatever they throw leaves as one line.
template <class F>
auto guarded(const fs::path& path, F&& f) {
  const Quiet quiet;
  try {
    return f();
  } catch (const hbError&) {
    throw;
  } catch (const itk::ExceptionObject& e) {
    throw hbError(fmt::format("{}: cannot be read: {}", path.string(), reason(e)));
  } catch (const std::exception& e) {
    throw hbError(fmt::format("{}: cannot be read: {}", path.string(), e.what()));
  }
}

/// The whole list of formats: none is registered or loaded at run time.
itk::ImageIOBase::Pointer makeIo(hbItkImage::Format format) {
  switch (format) {
  case hbItkImage::Format::nrrd:
    return itk::NrrdImageIO::New().GetPointer();
  case hbItkImage::Format::metaImage:
    return itk::MetaImageIO::New().GetPointer();
  case hbItkImage::Format::nifti:
    return itk::NiftiImageIO::New().GetPointer();
  case hbItkImage::Format::tiff:
    return itk::TIFFImageIO::New().GetPointer();
  case hbItkImage::Format::vtk:
    return itk::VTKImageIO::New().GetPointer();
  case hbItkImage::Format::dicom:
    break;
  }
  return itk::GDCMImageIO::New().GetPointer();
}

} // namespace

struct hbItkImage::Io {
  itk::ImageIOBase::Pointer base;
};

hbItkImage::hbItkImage(Format format, const fs::path& path) : io_(std::make_unique<Io>()), path_(path) {
  guarded(path, [&] {
    io_->base = makeIo(format);
    itk::ImageIOBase& io = *io_->base;
    io.SetFileName(path.string());
    io.ReadImageInformation();

    const unsigned dimensions = io.GetNumberOfDimensions();
    for (unsigned d = 0; d < dimensions; ++d) sizes_.push_back(std::int64_t(io.GetDimensions(d)));
    components_ = int(io.GetNumberOfComponents());
    if (dimensions < 1 || components_ < 1)
      throw hbError(fmt::format("{}: expected at least one dimension and one component, found {} and {}", path.string(),
                                dimensions, components_));

    using Type = itk::IOComponentEnum;
    switch (io.GetComponentType()) {
    case Type::CHAR:
      type_ = hbSampleType::int8;
      break;
    case Type::UCHAR:
      type_ = hbSampleType::uint8;
      break;
    case Type::SHORT:
      type_ = hbSampleType::int16;
      break;
    case Type::USHORT:
      type_ = hbSampleType::uint16;
      break;
    case Type::INT:
      type_ = hbSampleType::int32;
      break;
    case Type::UINT:
      type_ = hbSampleType::uint32;
      break;
    case Type::FLOAT:
      type_ = hbSampleType::float32;
      break;
    case Type::DOUBLE:
      type_ = hbSampleType::float64;
      break;
    case Type::ULONG:
    case Type::ULONGLONG:
      isUnsigned_ = true;
      break;
    case Type::LONG:
    case Type::LONGLONG:
      break;
    default:
      throw hbError(fmt::format("{}: expected samples of 8 to 64-bit integers or 32 or 64-bit floats, found {}",
                                path.string(), itk::ImageIOBase::GetComponentTypeAsString(io.GetComponentType())));
    }
    componentBytes_ = type_ ? hb::sampleBytes(*type_) : 8;

    for (unsigned d = 0; d < 3; ++d) {
      directions_[d] = {d == 0, d == 1, d == 2};
      if (d >= dimensions) continue;
      origin_[int(d)] = io.GetOrigin(d);
      spacing_[int(d)] = io.GetSpacing(d);
      const std::vector<double> axis = io.GetDirection(d);
      for (unsigned row = 0; row < 3; ++row) directions_[d][int(row)] = row < axis.size() ? axis[row] : 0.0;
    }
  });
}

hbItkImage::~hbItkImage() = default;

void hbItkImage::read(std::byte* out) {
  guarded(path_, [&] {
    itk::ImageIOBase& io = *io_->base;
    itk::ImageIORegion region(unsigned(sizes_.size()));
    for (unsigned d = 0; d < sizes_.size(); ++d) region.SetSize(d, itk::SizeValueType(sizes_[d]));
    io.SetIORegion(region);
    io.Read(out);
  });
}

hb::TiffPages hb::checkTiff(const fs::path& path) {
  return guarded(path, [&] {
    const std::unique_ptr<TIFF, void (*)(TIFF*)> tiff(TIFFOpen(path.c_str(), "r"), TIFFClose);
    if (!tiff) throw hbError(fmt::format("{}: cannot be read: expected a TIFF file", path.string()));
    TiffPages result;
    using Kind = std::tuple<std::uint32_t, std::uint32_t, std::uint16_t, std::uint16_t, std::uint16_t>;
    Kind first;
    do {
      Kind kind;
      auto& [width, height, bits, format, samples] = kind;
      std::uint16_t compression = COMPRESSION_NONE;
      TIFFGetField(tiff.get(), TIFFTAG_IMAGEWIDTH, &width);
      TIFFGetField(tiff.get(), TIFFTAG_IMAGELENGTH, &height);
      TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_BITSPERSAMPLE, &bits);
      TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_SAMPLEFORMAT, &format);
      TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_SAMPLESPERPIXEL, &samples);
      TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_COMPRESSION, &compression);
      if (result.pages == 0) first = kind;
      if (kind != first)
        throw hbError(fmt::format("{}: page {}: expected the size and type of the first page ({} x {}, {} x {} bits), "
                                  "found {} x {}, {} x {} bits",
                                  path.string(), result.pages, std::get<0>(first), std::get<1>(first),
                                  std::get<4>(first), std::get<2>(first), width, height, samples, bits));
      const bool isFloat = format == SAMPLEFORMAT_IEEEFP;
      if (isFloat ? bits != 32 : bits > 16)
        throw hbError(fmt::format("{}: expected TIFF samples of 8 or 16-bit integers or 32-bit floats, found {}-bit {}",
                                  path.string(), bits, isFloat ? "floats" : "integers"));
      std::uint64_t page = 0;
      if (__builtin_mul_overflow(std::uint64_t(width) * height, std::uint64_t(samples) * bits / 8, &page) ||
          __builtin_add_overflow(result.bytes, page, &result.bytes))
        result.bytes = std::numeric_limits<std::uint64_t>::max();
      result.compressed = result.compressed || compression != COMPRESSION_NONE;
      ++result.pages;
    } while (TIFFReadDirectory(tiff.get()) != 0);
    if (!tiffComplaint.empty()) throw hbError(fmt::format("{}: cannot be read: {}", path.string(), tiffComplaint));
    return result;
  });
}
