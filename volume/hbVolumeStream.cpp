#include "volume/hbVolumeStream.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>

#include "volume/hbError.h"
#include "volume/hbRawFile.h"
#include "volume/hbVolumeWriter.h"

namespace fs = std::filesystem;

namespace {

static_assert(std::endian::native == std::endian::little, "samples are written as they lie in memory");

enum class Format { nrrd, vti, raw };

Format formatOf(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  if (extension == ".nrrd") return Format::nrrd;
  if (extension == ".vti") return Format::vti;
  if (extension == ".raw") return Format::raw;
  throw hbError(fmt::format("{}: expected a volume file to write, {}, found '{}'", path.string(), hb::kWritableVolumes,
                            extension));
}

std::string vector(const glm::dvec3& v) { return fmt::format("({},{},{})", v.x, v.y, v.z); }

/// A key/value pair's value: NRRD0005 keeps it on one line by these two escapes.
std::string nrrdEscaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\n')
      result += "\\n";
    else if (c == '\\')
      result += "\\\\";
    else if (c != '\r')
      result += c;
  }
  return result;
}

/// http://teem.sourceforge.net/nrrd/format.html
std::string nrrdHeader(const hbGeometry& g, hbSampleType type, int components, const std::vector<std::string>& names) {
  // The spaces of three dimensions that NRRD knows and the reader keeps as they are; others are only counted.
  constexpr std::array<std::string_view, 4> kSpaces{"left-posterior-superior", "scanner-xyz", "3D-right-handed",
                                                    "3D-left-handed"};
  const bool named = std::find(kSpaces.begin(), kSpaces.end(), g.space) != kSpaces.end();
  const std::string_view typeName = type == hbSampleType::float32   ? "float"
                                    : type == hbSampleType::float64 ? "double"
                                                                    : hb::sampleTypeName(type);
  const bool several = components > 1;
  const std::string_view center = g.centring == hbGeometry::Centring::cell ? "cell" : "node";
  std::string text = fmt::format("NRRD0005\ntype: {}\ndimension: {}\n", typeName, several ? 4 : 3);
  text += named ? fmt::format("space: {}\n", g.space) : std::string("space dimension: 3\n");
  text +=
      fmt::format("sizes:{} {} {} {}\n", several ? fmt::format(" {}", components) : "", g.size.x, g.size.y, g.size.z);
  text += fmt::format("space directions:{} {} {} {}\n", several ? " none" : "", vector(g.direction[0] * g.spacing[0]),
                      vector(g.direction[1] * g.spacing[1]), vector(g.direction[2] * g.spacing[2]));
  text += fmt::format("centers:{0} {1} {1} {1}\n", several ? " ???" : "", center);
  text += fmt::format("kinds:{} domain domain domain\n", several ? " list" : "");
  text += fmt::format("endian: little\nencoding: raw\nspace origin: {}\n", vector(g.origin));
  for (std::size_t c = 0; c < names.size(); ++c)
    if (!names[c].empty()) text += fmt::format("component name {}:={}\n", c, nrrdEscaped(names[c]));
  return text + "\n";
}

/// Text between the quotes of an XML attribute; what is no printable ASCII becomes '_'.
std::string xmlEscaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
    case '&':
      result += "&amp;";
      break;
    case '<':
      result += "&lt;";
      break;
    case '>':
      result += "&gt;";
      break;
    case '"':
      result += "&quot;";
      break;
    default:
      result += c < ' ' || c > '~' ? '_' : c;
    }
  }
  return result;
}

/// https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html, up to and with the "_" before the data.
std::string vtiHeader(const hbGeometry& g, hbSampleType type, int components, const std::vector<std::string>& names) {
  std::string typeName(hb::sampleTypeName(type));
  const bool isUnsigned = typeName.front() == 'u';
  typeName[0] = char(typeName[0] - 'a' + 'A');
  if (isUnsigned) typeName[1] = 'I';

  // A cell's value sits half a spacing inside the grid of the cells' corners, which is what VTK's origin is.
  const bool cell = g.centring == hbGeometry::Centring::cell;
  const glm::dvec3 origin = cell ? g.origin - g.direction * (0.5 * g.spacing) : g.origin;
  const hbSize3 last = cell ? g.size : g.size - std::int64_t{1};
  const std::string extent = fmt::format("0 {} 0 {} 0 {}", last.x, last.y, last.z);
  std::string direction; // rows; column d is axis d
  for (int row = 0; row < 3; ++row)
    for (int d = 0; d < 3; ++d) direction += fmt::format("{}{}", direction.empty() ? "" : " ", g.direction[d][row]);

  std::string array = components == 1 && !names[0].empty() ? xmlEscaped(names[0]) : "values";
  array = fmt::format("Name=\"{}\" NumberOfComponents=\"{}\"", array, components);
  if (components > 1)
    for (std::size_t c = 0; c < names.size(); ++c)
      if (!names[c].empty()) array += fmt::format(" ComponentName{}=\"{}\"", c, xmlEscaped(names[c]));

  const std::string_view data = cell ? "CellData" : "PointData";
  const std::string_view other = cell ? "PointData" : "CellData";
  return fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "  <ImageData WholeExtent=\"{0}\" Origin=\"{1} {2} {3}\" Spacing=\"{4} {5} {6}\" Direction=\"{7}\">\n"
      "    <Piece Extent=\"{0}\">\n"
      "      <{8}>\n"
      "        <DataArray type=\"{10}\" {11} format=\"appended\" offset=\"0\"/>\n"
      "      </{8}>\n"
      "      <{9}/>\n"
      "    </Piece>\n"
      "  </ImageData>\n"
      "  <AppendedData encoding=\"raw\">\n"
      "   _",
      extent, origin.x, origin.y, origin.z, g.spacing.x, g.spacing.y, g.spacing.z, direction, data, other, typeName,
      array);
}

/// Refuses what the format cannot keep; returns the target for the initialiser list.
const fs::path& checked(const fs::path& target, const hbGeometry& geometry, hbSampleType type, int components,
                        const std::vector<std::string>& names) {
  const Format format = formatOf(target);
  geometry.validate(target.string());
  if (components < 1 || (!names.empty() && int(names.size()) != components))
    throw hbError(fmt::format("{}: expected at least one component and a name for each or none, found {} and {} names",
                              target.string(), components, names.size()));
  if (format != Format::raw) return target;
  if (components != 1)
    throw hbError(fmt::format("{}: expected one component, as a raw file's name cannot say more, found {}; "
                              "write a .nrrd or .vti file",
                              target.string(), components));
  const auto named = hb::rawLayoutFromName(target);
  if (!named || named->size != geometry.size || named->type != type) {
    // What the name already says of sizes and type is replaced.
    std::string stem = target.stem().string();
    if (named) stem = stem.substr(0, stem.rfind('_', stem.rfind('_') - 1));
    throw hbError(fmt::format("{}: expected the name to say the samples' sizes and type, as in {}", target.string(),
                              hb::rawFileName(stem, geometry.size, type)));
  }
  return target;
}

} // namespace

hbVolumeStream::hbVolumeStream(const fs::path& target, const hbGeometry& geometry, hbSampleType type, int components,
                               const std::vector<std::string>& names)
    : output_(checked(target, geometry, type, components, names)) {
  if (__builtin_mul_overflow(std::uint64_t(geometry.samples()),
                             std::uint64_t(components) * std::uint64_t(hb::sampleBytes(type)), &bytes_) ||
      bytes_ > std::uint64_t(INT64_MAX))
    throw hbError(fmt::format("{}: expected fewer than 2^63 bytes, found {} samples of {} {}", target.string(),
                              geometry.samples(), components, hb::sampleTypeName(type)));
  std::vector<std::string> all = names;
  all.resize(std::size_t(components));
  std::string header;
  switch (formatOf(target)) {
  case Format::nrrd:
    header = nrrdHeader(geometry, type, components, all);
    break;
  case Format::vti:
    header = vtiHeader(geometry, type, components, all);
    header.append(reinterpret_cast<const char*>(&bytes_), sizeof bytes_);
    footer_ = "\n  </AppendedData>\n</VTKFile>\n";
    break;
  case Format::raw:
    break;
  }
  file_.reset(std::fopen(output_.path().c_str(), "wb"));
  if (!file_) throw failure();
  put(header.data(), header.size());
}

hbError hbVolumeStream::failure() const {
  return hbError(
      fmt::format("{}: cannot be written: {}", output_.target().string(), std::generic_category().message(errno)));
}

void hbVolumeStream::put(const void* data, std::size_t size) {
  if (size > 0 && std::fwrite(data, 1, size, file_.get()) != size) throw failure();
}

void hbVolumeStream::write(std::span<const std::byte> samples) {
  if (samples.size() > bytes_ - written_)
    throw hbError(fmt::format("{}: expected {} bytes of samples, found more", output_.target().string(), bytes_));
  put(samples.data(), samples.size());
  written_ += samples.size();
  // The disk may begin now, not when everything is there; whether it managed, commit() asks.
  constexpr std::uint64_t kEnough = std::uint64_t{16} << 20;
  if (written_ - begun_ < kEnough) return;
  ::sync_file_range(::fileno(file_.get()), std::int64_t(begun_), 0, SYNC_FILE_RANGE_WRITE);
  begun_ = written_;
}

void hbVolumeStream::commit() {
  if (written_ != bytes_)
    throw hbError(
        fmt::format("{}: expected {} bytes of samples, found {}", output_.target().string(), bytes_, written_));
  put(footer_.data(), footer_.size());
  if (std::fclose(file_.release()) != 0) throw failure();
  output_.commit();
}
