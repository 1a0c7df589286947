#include "scene/hbPictureFile.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <Iex.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>
#include <png.h>

#include "scene/hbScene.h"
#include "volume/hbError.h"
#include "volume/hbMappedFile.h"
#include "volume/hbOutputFile.h"

static_assert(std::endian::native == std::endian::little, "the header check reads integers as they lie in the file");

namespace {

constexpr int kMaxSide = hbScene::kMaxPictureSide;
constexpr std::size_t kMaxNameBytes = 255; // what OpenEXR stores of a name
constexpr int kMaxChannels = 32;
constexpr std::int64_t kMaxValues = std::int64_t{1} << 30;
constexpr unsigned kMaxTileSide = 1024;

/// A library's message as part of ours: on one line, printable, not long.
std::string oneLine(std::string_view text) {
  std::string line(text.substr(0, 300));
  for (char& c : line)
    if (c < ' ' || c > '~') c = ' ';
  return line;
}

/// A whole file in memory.
struct Bytes {
  std::uint64_t size = 0; // before `data`, whose making sets it
  std::shared_ptr<const std::byte> data;
  std::string name;

  explicit Bytes(const std::filesystem::path& path) : data(hb::mapFile(path, size)), name(path.string()) {}
  const char* chars() const { return reinterpret_cast<const char*>(data.get()); }
  bool beginsWith(std::string_view magic) const {
    return size >= magic.size() && std::memcmp(data.get(), magic.data(), magic.size()) == 0;
  }
};

void checkSides(const std::string& name, std::int64_t width, std::int64_t height) {
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide)
    throw hbError(
        fmt::format("{}: expected a picture of 1 to {} pixels a side, found {} x {}", name, kMaxSide, width, height));
}

// ---- OpenEXR ----

constexpr std::string_view kExrMagic("\x76\x2f\x31\x01", 4);

class MemoryStream final : public Imf::IStream {
public:
  explicit MemoryStream(const Bytes& bytes) : Imf::IStream(bytes.name.c_str()), bytes_(bytes) {}

  bool read(char out[], int count) override {
    if (count < 0 || at_ > bytes_.size || std::uint64_t(count) > bytes_.size - at_)
      throw Iex::InputExc("the file ends too early");
    std::memcpy(out, bytes_.chars() + at_, std::size_t(count));
    at_ += std::uint64_t(count);
    return at_ < bytes_.size;
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t at) override { at_ = at; }

private:
  const Bytes& bytes_;
  std::uint64_t at_ = 0;
};

/// Walks over the header's attributes (name, type, 32-bit length, value; "The OpenEXR File Layout", 2.0) before
/// OpenEXR sees them: it allocates what an attribute claims to hold before it looks whether the file has it.
void checkExrHeader(const Bytes& bytes) {
  const std::span data(bytes.chars(), bytes.size);
  if (!bytes.beginsWith(kExrMagic) || bytes.size < 8)
    throw hbError(fmt::format("{}: expected an OpenEXR picture, found other data", bytes.name));
  std::uint32_t version = 0;
  std::memcpy(&version, data.data() + 4, sizeof version);
  constexpr std::uint32_t kNumber = 0xFF, kTiled = 0x200, kLongNames = 0x400;
  if ((version & kNumber) != 2 || (version & ~(kNumber | kTiled | kLongNames)) != 0)
    throw hbError(
        fmt::format("{}: expected a single-part flat OpenEXR picture of version 2, found version {}, flags {:#x}",
                    bytes.name, version & kNumber, version & ~kNumber));
  std::size_t at = 8;
  const auto damaged = [&] { return hbError(fmt::format("{}: damaged OpenEXR header at byte {}", bytes.name, at)); };
  const auto skipString = [&] {
    const auto rest = data.subspan(at, std::min(data.size() - at, kMaxNameBytes + 1));
    const auto end = std::find(rest.begin(), rest.end(), '\0');
    if (end == rest.end()) throw damaged();
    at += std::size_t(end - rest.begin()) + 1;
  };
  while (at < data.size() && data[at] != '\0') {
    skipString();
    skipString();
    std::int32_t length = 0;
    if (data.size() - at < sizeof length) throw damaged();
    std::memcpy(&length, data.data() + at, sizeof length);
    if (length < 0 || std::size_t(length) > data.size() - at - sizeof length) throw damaged();
    at += sizeof length + std::size_t(length);
  }
  if (at == data.size()) throw damaged();
}

/// Refuses what would not fit the limits, before pixel memory is allocated; returns the channels' names.
std::vector<std::string> checkExrContent(const Imf::Header& header, const std::string& name) {
  const Imath::Box2i& box = header.dataWindow();
  const std::int64_t width = std::int64_t(box.max.x) - box.min.x + 1, height = std::int64_t(box.max.y) - box.min.y + 1;
  checkSides(name, width, height);
  if (header.hasTileDescription() &&
      (header.tileDescription().xSize > kMaxTileSide || header.tileDescription().ySize > kMaxTileSide))
    throw hbError(fmt::format("{}: expected tiles of at most {} pixels a side, found {} x {}", name, kMaxTileSide,
                              header.tileDescription().xSize, header.tileDescription().ySize));
  std::vector<std::string> names;
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    names.emplace_back(channel.name());
    if (channel.channel().xSampling != 1 || channel.channel().ySampling != 1)
      throw hbError(fmt::format("{}: channel {}: expected a value for every pixel, found one for {} x {}", name,
                                oneLine(names.back()), channel.channel().xSampling, channel.channel().ySampling));
  }
  if (names.empty() || names.size() > kMaxChannels || width * height * std::int64_t(names.size()) > kMaxValues)
    throw hbError(fmt::format("{}: expected 1 to {} channels and at most {} values, found {} channels of {} x {}", name,
                              kMaxChannels, kMaxValues, names.size(), width, height));
  return names;
}

hbPicture readExrPart(Imf::MultiPartInputFile& file, const std::string& name) {
  const Imf::Header& header = file.header(0);
  const std::vector<std::string> names = checkExrContent(header, name);
  const Imath::Box2i box = header.dataWindow();
  hbPicture picture;
  picture.width = box.max.x - box.min.x + 1;
  picture.height = box.max.y - box.min.y + 1;
  for (auto attribute = header.begin(); attribute != header.end(); ++attribute)
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute()))
      if (std::string_view(attribute.name()).starts_with(hbPicture::kMetadataPrefix))
        picture.metadata[attribute.name()] = text->value();

  // Strip by strip, so that memory is taken only as the file proves to hold the rows it claims.
  constexpr int kStripRows = 64;
  Imf::InputPart part(file, 0);
  const std::size_t width = std::size_t(picture.width);
  std::vector<float> strip(names.size() * width * std::size_t(std::min(kStripRows, picture.height)));
  for (int first = 0; first < picture.height; first += kStripRows) {
    const int rows = std::min(kStripRows, picture.height - first);
    const std::size_t count = width * std::size_t(rows);
    const Imath::V2i corner(box.min.x, box.min.y + first);
    Imf::FrameBuffer target;
    for (std::size_t c = 0; c < names.size(); ++c)
      target.insert(names[c], Imf::Slice::Make(Imf::FLOAT, strip.data() + c * count, corner, picture.width, rows,
                                               sizeof(float), sizeof(float) * width));
    part.setFrameBuffer(target);
    part.readPixels(corner.y, corner.y + rows - 1);
    for (std::size_t c = 0; c < names.size(); ++c) {
      const float* values = strip.data() + c * count;
      auto& channel = picture.channels[names[c]];
      channel.insert(channel.end(), values, values + count);
    }
  }
  return picture;
}

// ---- PNG ----

struct PngImage : png_image {
  PngImage() : png_image() { version = PNG_IMAGE_VERSION; }
  ~PngImage() { png_image_free(this); }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
};

} // namespace

void hb::writeExr(const hbPicture& picture, const std::filesystem::path& path) {
  const std::string name = path.string();
  picture.validate(name);
  Imf::Header header(picture.width, picture.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer source;
  for (const auto& [channel, values] : picture.channels) {
    if (channel.empty() || channel.size() > kMaxNameBytes || channel.find('\0') != std::string::npos)
      throw hbError(
          fmt::format("{}: expected channel names of 1 to {} bytes, found {}", name, kMaxNameBytes, channel.size()));
    header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
    // OpenEXR's frame buffers serve reading too, hence the cast; writing leaves the values alone.
    source.insert(channel, Imf::Slice::Make(Imf::FLOAT, const_cast<float*>(values.data()), Imath::V2i(0), picture.width,
                                            picture.height, sizeof(float), sizeof(float) * std::size_t(picture.width)));
  }
  for (const auto& [key, text] : picture.metadata) {
    if (!key.starts_with(hbPicture::kMetadataPrefix) || key.size() > kMaxNameBytes ||
        key.find('\0') != std::string::npos)
      throw hbError(fmt::format("{}: expected metadata keys of at most {} bytes beginning with {}, found '{}'", name,
                                kMaxNameBytes, hbPicture::kMetadataPrefix, oneLine(key)));
    header.insert(key, Imf::StringAttribute(text));
  }

  hbOutputFile output(path);
  // Our own stream: closing it tells whether everything reached the file, which OpenEXR's destructor would not.
  std::ofstream stream(output.path(), std::ios::binary);
  try {
    Imf::StdOFStream wrapped(stream, output.path().c_str());
    Imf::OutputFile file(wrapped, header);
    file.setFrameBuffer(source);
    file.writePixels(picture.height);
  } catch (const std::exception& e) {
    throw hbError(fmt::format("{}: cannot be written: {}", name, oneLine(e.what())));
  }
  stream.close();
  if (!stream) throw hbError(fmt::format("{}: cannot be written", name));
  output.commit();
}

hbPicture hb::readExr(const std::filesystem::path& path) {
  const Bytes bytes(path);
  checkExrHeader(bytes);
  try {
    MemoryStream stream(bytes);
    Imf::MultiPartInputFile file(stream);
    return readExrPart(file, bytes.name);
  } catch (const hbError&) {
    throw;
  } catch (const std::exception& e) {
    throw hbError(fmt::format("{}: damaged OpenEXR picture: {}", bytes.name, oneLine(e.what())));
  }
}

void hb::writePng(const hbImage8& image, const std::filesystem::path& path) {
  const std::string name = path.string();
  checkSides(name, image.width, image.height);
  if (image.rgb.size() != 3 * std::size_t(image.width) * std::size_t(image.height))
    throw hbError(
        fmt::format("{}: expected 3 x {} x {} bytes, found {}", name, image.width, image.height, image.rgb.size()));
  PngImage png;
  png.width = png_uint_32(image.width);
  png.height = png_uint_32(image.height);
  png.format = PNG_FORMAT_RGB;
  hbOutputFile output(path);
  std::FILE* file = std::fopen(output.path().c_str(), "wb");
  const bool written = file != nullptr && png_image_write_to_stdio(&png, file, 0, image.rgb.data(), 0, nullptr) != 0;
  const bool closed = file != nullptr && std::fclose(file) == 0;
  if (!written || !closed) throw hbError(fmt::format("{}: cannot be written: {}", name, oneLine(png.message)));
  output.commit();
}

hbImage8 hb::readPng(const std::filesystem::path& path) {
  const Bytes bytes(path);
  if (!bytes.beginsWith("\x89PNG\r\n\x1a\n"))
    throw hbError(fmt::format("{}: expected a PNG picture, found other data", bytes.name));
  PngImage png;
  const auto damaged = [&] {
    return hbError(fmt::format("{}: damaged PNG picture: {}", bytes.name, oneLine(png.message)));
  };
  if (png_image_begin_read_from_memory(&png, bytes.data.get(), bytes.size) == 0) throw damaged();
  checkSides(bytes.name, png.width, png.height);
  png.format = PNG_FORMAT_RGB;
  png.flags |= PNG_IMAGE_FLAG_16BIT_sRGB; // files of 16 bits that do not say otherwise are sRGB as well
  hbImage8 image{int(png.width), int(png.height), {}};
  image.rgb.resize(PNG_IMAGE_SIZE(png));
  const png_color black{0, 0, 0};
  if (png_image_finish_read(&png, &black, image.rgb.data(), 0, nullptr) == 0) throw damaged();
  return image;
}

std::variant<hbPicture, hbImage8> hb::readPicture(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = char(std::tolower(static_cast<unsigned char>(c)));
  if (extension == ".exr") return readExr(path);
  if (extension == ".png") return readPng(path);
  throw hbError(fmt::format("{}: expected a picture named .exr or .png", path.string()));
}
