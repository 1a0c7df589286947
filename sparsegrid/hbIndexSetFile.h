#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sparsegrid/hbIndexSet.h"

/// An index set as text: one subspace a line, its levels `lx ly lz`; `#` begins a comment, blank lines say nothing, the
/// order is free.
///
/// Level 0 of an axis belongs to level 1 and need not be listed: it is added wherever level 1 is. An axis for which all
/// lines have level 0 is coarse. Along an axis of one or two samples, which has level 0 only, 0 and 1 both mean that.
class hbIndexSetFile {
public:
  /// Throws hbError, naming `source` and the line, for anything but three whole numbers from 0 to
  /// hbIndexSet::kMaxLevel, for a line that comes twice, and where there is none.
  static hbIndexSetFile fromText(std::string_view text, const std::string& source);
  /// The same from a file of at most 1 MB.
  static hbIndexSetFile load(const std::filesystem::path& path);

  /// The set for that number of samples an axis, of which only matters where there are one or two. Throws hbError,
  /// naming source and line, where an axis of one or two has a level above 1, a subspace needs one that is not listed
  /// (closed downwards), or there would be 2^60 values.
  hbIndexSet indexSet(const hbSize3& size) const;

  /// The text of a set: its subspaces of levels >= 1 (0 on coarse axes) in their order. Reading gives the set back.
  static std::string text(const hbIndexSet& set);

private:
  struct Line {
    glm::ivec3 levels{0};
    int number = 0;
  };
  std::string place(const Line& line) const;
  std::vector<Line> linesOn(const hbIndexSet::Axes& axes) const;

  std::string source_;
  std::vector<Line> lines_;
};
