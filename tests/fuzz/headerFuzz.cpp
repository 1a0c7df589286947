// The headers that are read before a library sees the file: NRRD, MetaImage, legacy VTK, DICOM, and what the name of a
// raw file says. The first byte chooses: n, m, v, d, r.

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "tests/fuzz/fuzz.h"
#include "volume/hbDicomHeader.h"
#include "volume/hbMetaImageHeader.h"
#include "volume/hbNrrdHeader.h"
#include "volume/hbRawFile.h"
#include "volume/hbVtkHeader.h"

namespace {

void parseRawName(const std::string& name) {
  const auto layout = hb::rawLayoutFromName(name);
  if (!layout) return;
  const auto again = hb::rawLayoutFromName(hb::rawFileName("a", layout->size, layout->type));
  fuzz::expect(again && again->size == layout->size && again->type == layout->type);
}

void parse(char kind, std::string_view text) {
  const std::filesystem::path path("folder/file");
  switch (kind) {
  case 'n': {
    const hbNrrdHeader header = hb::parseNrrdHeader(text, path);
    fuzz::expect(header.dataOffset <= text.size() && header.geometry.samples() > 0);
    break;
  }
  case 'm':
    fuzz::expect(hb::parseMetaImageHeader(text, path).dataOffset <= text.size());
    break;
  case 'v':
    fuzz::expect(hb::parseVtkHeader(text, path).dataOffset <= text.size());
    break;
  case 'd': {
    const hbDicomHeader header = hb::parseDicomHeader(std::as_bytes(std::span(text)), path);
    fuzz::expect(header.decodedBytes() > 0);
    break;
  }
  case 'r':
    parseRawName(std::string(text));
    break;
  default:
    break;
  }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  fuzz::allowErrors([&] { parse(char(data[0]), {reinterpret_cast<const char*>(data) + 1, size - 1}); });
  return 0;
}
