#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

/// What the text header of a MetaImage file says about where its samples are
/// (https://itk.org/Wiki/ITK/MetaIO/Documentation); ITK interprets the rest. Private to the volume reader.
struct hbMetaImageHeader {
  std::vector<std::int64_t> sizes;
  std::int64_t components = 1;
  bool ascii = false;
  bool compressed = false;
  bool bigEndian = false;
  bool oriented = false;       ///< Names its anatomical orientation.
  std::int64_t headerSize = 0; ///< Bytes before the samples of a data file; -1 where they are its end.
  /// Where the samples are: other files, or this one from `dataOffset` on where `files` is empty.
  std::vector<std::filesystem::path> files;
  std::uint64_t dataOffset = 0;
};

namespace hb {

/// Throws hbError for a header without usable sizes, lines too long for ITK, or data files named by a pattern.
hbMetaImageHeader readMetaImageHeader(const std::filesystem::path& path);

/// The same from the beginning of the file at hand, `text`; `path` is for messages and for the data files beside it.
hbMetaImageHeader parseMetaImageHeader(std::string_view text, const std::filesystem::path& path);

} // namespace hb
