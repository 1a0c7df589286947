#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "volume/hbGeometry.h"

/// What the text header of an NRRD file says (http://teem.sourceforge.net/nrrd/format.html), as far as ITK does not
/// pass it on, or does so wrongly: it drops `centers`, cuts sizes to 32 bits, and turns left-anterior-superior into
/// LPS by flipping the wrong axis. Private to the volume reader.
struct hbNrrdHeader {
  std::vector<std::int64_t> sizes; ///< In the file's order, the range axis included.
  int rangeAxis = -1;              ///< The axis that holds components; -1 for none.
  bool masked = false;             ///< The range axis starts with a mask value, which ITK leaves out.
  std::string encoding;            ///< "raw", "gzip", "bzip2", "ascii" or "hex".
  bool bigEndian = false;
  std::int64_t lineSkip = 0, byteSkip = 0;
  /// Where the samples are: other files, or this one from `dataOffset` on where `files` is empty.
  std::vector<std::filesystem::path> files;
  std::uint64_t dataOffset = 0;
  std::vector<std::string> componentNames; ///< Empty for those without; our own keys.

  /// Sizes, and world coordinates: LPS for the three anatomical spaces, else those of the file.
  hbGeometry geometry;
};

namespace hb {

/// Throws hbError for a header without usable sizes, with more than three domain axes longer than 1, more than one
/// range axis, or data files named by a pattern.
hbNrrdHeader readNrrdHeader(const std::filesystem::path& path);

/// The same from the beginning of the file at hand, `text`; `path` is for messages and for the data files beside it.
hbNrrdHeader parseNrrdHeader(std::string_view text, const std::filesystem::path& path);

} // namespace hb
