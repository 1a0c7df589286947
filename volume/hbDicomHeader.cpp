#include "volume/hbDicomHeader.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>

#include <fmt/format.h>

#include "volume/hbError.h"
#include "volume/hbHeaderText.h"
#include "volume/hbMappedFile.h"
#include "volume/hbVolume.h"

namespace {

constexpr std::uint64_t kPrefixAt = 128, kStart = 132;
constexpr std::uint32_t kUndefined = 0xFFFFFFFFU;
constexpr std::uint32_t kItem = 0xFFFEE000U, kItemEnd = 0xFFFEE00DU, kSequenceEnd = 0xFFFEE0DDU;
constexpr std::uint32_t kPixelData = 0x7FE00010U;
constexpr int kMaxDepth = 16; // of sequences in sequences

/// The value representations, those with a length of 32 bits first.
constexpr std::array<std::string_view, 34> kRepresentations{
    "OB", "OD", "OF", "OL", "OV", "OW", "SQ", "SV", "UC", "UN", "UR", "UT", "UV", "AE", "AS", "AT", "CS",
    "DA", "DS", "DT", "FD", "FL", "IS", "LO", "LT", "PN", "SH", "SL", "SS", "ST", "TM", "UI", "UL", "US"};
constexpr std::size_t kLongRepresentations = 13;

struct Element {
  std::uint32_t tag = 0;
  std::string_view representation; ///< Empty where it is implicit.
  std::uint32_t length = 0;
};

class Walker {
public:
  Walker(std::span<const std::byte> file, const std::filesystem::path& path)
      : path_(path), size_(file.size()), file_(file.data()) {}

  hbDicomHeader read() {
    if (size_ < kStart || text(kPrefixAt, 4) != "DICM") fail("expected a DICOM file, with DICM at byte 128");
    at_ = kStart;
    const std::string syntax = readMeta();
    if (syntax == "1.2.840.10008.1.2.1.99") fail("expected pixels or JPEG and the like, found a deflated data set");
    bigEndian_ = syntax == "1.2.840.10008.1.2.2";
    readElements(size_, syntax == "1.2.840.10008.1.2", false, 0);

    if (header_.rows < 1 || header_.columns < 1 || header_.frames < 1 || header_.pixelBytes == 0)
      fail("expected an image of at least one row, column and frame, and its pixels");
    if (header_.samples < 1 || header_.samples > 4)
      fail(fmt::format("expected 1 to 4 samples a pixel, found {}", header_.samples));
    if (header_.bits < 1 || header_.bits > 64)
      fail(fmt::format("expected 1 to 64 bits a sample, found {}", header_.bits));
    if (header_.frames > (std::int64_t{1} << 24))
      fail(fmt::format("expected up to 2^24 frames, found {}", header_.frames));
    // Samples of 12 bits lie packed in some files.
    const auto stored = std::uint64_t(header_.rows * header_.columns * header_.samples * header_.frames) *
                        std::uint64_t(header_.bits) / 8;
    if (!header_.encapsulated && header_.pixelBytes < stored)
      fail(fmt::format("expected {} bytes of pixels, found {}", stored, header_.pixelBytes));
    return header_;
  }

private:
  [[noreturn]] void fail(const std::string& what) const { throw hbError(fmt::format("{}: {}", path_.string(), what)); }
  [[noreturn]] void damaged() const {
    fail(fmt::format("byte {}: expected a DICOM element that ends within the file", at_));
  }

  std::string_view text(std::uint64_t at, std::uint64_t length) const {
    return {reinterpret_cast<const char*>(file_) + at, length};
  }
  template <class T>
  T number(std::uint64_t at) const {
    return bigEndian_ ? hb::loadSample<T, true>(file_ + at) : hb::loadSample<T, false>(file_ + at);
  }
  template <class T>
  T take(std::uint64_t end) {
    if (end - at_ < sizeof(T)) damaged();
    at_ += sizeof(T);
    return number<T>(at_ - sizeof(T));
  }
  std::uint32_t takeTag(std::uint64_t end) {
    const auto group = std::uint32_t(take<std::uint16_t>(end));
    return group << 16 | take<std::uint16_t>(end);
  }

  /// The next element's head; at_ is its value afterwards.
  Element takeElement(std::uint64_t end, bool implicit) {
    Element e;
    e.tag = takeTag(end);
    if (implicit || e.tag == kItemEnd || e.tag == kSequenceEnd || e.tag == kItem) {
      e.length = take<std::uint32_t>(end);
    } else {
      if (end - at_ < 2) damaged();
      e.representation = text(at_, 2);
      const auto* found = std::find(kRepresentations.begin(), kRepresentations.end(), e.representation);
      if (found == kRepresentations.end()) damaged();
      at_ += 2;
      if (std::size_t(found - kRepresentations.begin()) < kLongRepresentations) {
        take<std::uint16_t>(end);
        e.length = take<std::uint32_t>(end);
      } else {
        e.length = take<std::uint16_t>(end);
      }
    }
    if (e.length != kUndefined && e.length > end - at_) damaged();
    return e;
  }

  /// The meta elements (group 2, always explicit and little-endian); returns the transfer syntax.
  std::string readMeta() {
    std::string syntax;
    while (size_ - at_ >= 2 && number<std::uint16_t>(at_) == 2) {
      const Element e = takeElement(size_, false);
      if (e.length == kUndefined) damaged();
      if (e.tag == 0x00020000 && (e.representation != "UL" || e.length != 4)) damaged();
      if (e.tag == 0x00020010) syntax = string(e);
      at_ += e.length;
    }
    if (syntax.empty()) fail("expected a DICOM file that names its transfer syntax");
    return syntax;
  }

  void readElements(std::uint64_t end, bool implicit, bool untilEnd, int depth) {
    if (depth > kMaxDepth) fail(fmt::format("expected at most {} sequences inside each other", kMaxDepth));
    while (at_ < end) {
      const Element e = takeElement(end, implicit);
      if (e.tag == kItemEnd && untilEnd) return;
      if (e.tag >> 16 == 0xFFFE) damaged();
      const std::uint64_t value = at_;
      const bool pixels = depth == 0 && e.tag == kPixelData;
      if (pixels) header_.encapsulated = e.length == kUndefined;
      if (e.length != kUndefined && e.representation != "SQ") {
        if (depth == 0) keep(e);
        at_ = value + e.length;
      } else if (pixels) {
        readFragments(end);
      } else if (implicit || e.representation == "SQ" || e.representation == "UN") {
        const bool undefined = e.length == kUndefined;
        readSequence(undefined ? end : value + e.length, implicit || e.representation == "UN", undefined, depth);
      } else {
        damaged();
      }
    }
    if (untilEnd) damaged();
  }

  void readSequence(std::uint64_t end, bool implicit, bool untilEnd, int depth) {
    while (at_ < end) {
      const Element item = takeElement(end, true);
      if (item.tag == kSequenceEnd && untilEnd) return;
      if (item.tag != kItem) damaged();
      const bool undefined = item.length == kUndefined;
      readElements(undefined ? end : at_ + item.length, implicit, undefined, depth + 1);
    }
    if (untilEnd) damaged();
  }

  /// Compressed pixels: items of bytes.
  void readFragments(std::uint64_t end) {
    while (at_ < end) {
      const Element item = takeElement(end, true);
      if (item.tag == kSequenceEnd) return;
      if (item.tag != kItem || item.length == kUndefined) damaged();
      header_.pixelBytes += item.length;
      at_ += item.length;
    }
    damaged();
  }

  std::string string(const Element& e) const {
    std::string_view value = text(at_, e.length);
    while (!value.empty() && (value.back() == '\0' || value.back() == ' ')) value.remove_suffix(1);
    return std::string(hb::trimmed(value));
  }

  /// The numbers of a decimal string, separated by backslashes.
  void numbers(const Element& e, std::initializer_list<double*> out) const {
    const std::string value = string(e);
    std::string_view rest = value;
    for (double* number : out) {
      const std::size_t end = std::min(rest.size(), rest.find('\\'));
      const auto read = hb::toDouble(rest.substr(0, end));
      if (!read)
        fail(fmt::format("({:04x},{:04x}): expected {} numbers, found '{}'", e.tag >> 16, e.tag & 0xFFFF, out.size(),
                         value));
      *number = *read;
      rest.remove_prefix(std::min(rest.size(), end + 1));
    }
  }

  void keep(const Element& e) {
    const auto count = [&] {
      if (e.length != 2) damaged();
      return std::int64_t(number<std::uint16_t>(at_));
    };
    switch (e.tag) {
    case 0x0020000E:
      header_.series = string(e);
      break;
    case 0x00200032:
      numbers(e, {&header_.position.x, &header_.position.y, &header_.position.z});
      break;
    case 0x00200037:
      numbers(
          e, {&header_.row.x, &header_.row.y, &header_.row.z, &header_.column.x, &header_.column.y, &header_.column.z});
      break;
    case 0x00280002:
      header_.samples = count();
      break;
    case 0x00280008:
      header_.frames = hb::toInteger(string(e)).value_or(0);
      break;
    case 0x00280010:
      header_.rows = count();
      break;
    case 0x00280011:
      header_.columns = count();
      break;
    case 0x00280100:
      header_.bits = count();
      break;
    case kPixelData:
      header_.pixelBytes = e.length;
      break;
    default:
      break;
    }
  }

  std::filesystem::path path_;
  std::uint64_t size_;
  const std::byte* file_;
  std::uint64_t at_ = 0;
  bool bigEndian_ = false;
  hbDicomHeader header_;
};

} // namespace

bool hb::isDicom(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::array<char, kStart> start{};
  in.read(start.data(), std::streamsize(start.size()));
  return in && std::string_view(start.data() + kPrefixAt, 4) == "DICM";
}

hbDicomHeader hb::readDicomHeader(const std::filesystem::path& path) {
  std::uint64_t size = 0;
  const std::shared_ptr<const std::byte> file = mapFile(path, size);
  return parseDicomHeader({file.get(), size}, path);
}

hbDicomHeader hb::parseDicomHeader(std::span<const std::byte> file, const std::filesystem::path& path) {
  return Walker(file, path).read();
}
