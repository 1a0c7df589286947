// Colour maps as JSON and as tables, the first byte deciding.

#include <string>

#include "scene/hbOpacityRange.h"
#include "scene/hbTransferFunctionFile.h"
#include "scene/hbTransferTable.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  fuzz::allowErrors([&] {
    const bool isJson = text.starts_with('[') || text.starts_with('{');
    const auto functions = isJson ? hb::transferFunctionsFromJson(text, "maps.json")
                                  : std::vector{hb::transferFunctionFromTable(text, "table.txt")};
    fuzz::expect(hb::transferFunctionsFromJson(hb::toJson(functions), "again") == functions);
    for (const hbTransferFunction& function : functions) {
      const auto [lo, hi] = function.range();
      const double greatest = hbOpacityRange(function).maximum(lo, hi);
      const hbTransferTable table(function.withUnitLength(1.0), 17);
      for (const auto& entry : table.entries())
        for (int c = 0; c < 3; ++c) fuzz::expect(entry[c] >= 0.0F && entry[c] <= 1.0F);
      for (int i = 0; i <= 16; ++i) fuzz::expect(function.opacity((1.0 - i / 16.0) * lo + i / 16.0 * hi) <= greatest);
      table.at(0.0F);
    }
  });
  return 0;
}
