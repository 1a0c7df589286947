#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "raycast/hbInput.h"
#include "volume/hbProgress.h"
#include "volume/hbRawFile.h"

namespace CLI {
class App;
}

/// What all subcommands share: their common options, the progress bar, and the statistics file.
namespace app {

/// What a command line asks for, when it has been read and checked.
using Work = std::function<void()>;

/// Options of every subcommand.
struct CommonOptions {
  int threads = 0;          ///< 0: one a core.
  std::uint64_t memory = 0; ///< Bytes; 0: what the machine has.
  std::string stats;        ///< Where to write the statistics; "": nowhere.
  std::string command;      ///< The command line, for the records.

  void addTo(CLI::App& subcommand);

  /// The limit in bytes: `memory`, or the machine's physical memory.
  std::uint64_t memoryLimit() const;
  /// Throws hbError naming `what` when `bytes` would exceed the limit. (A double: estimates need not fit 64 bits.)
  void checkMemory(double bytes, const std::string& what) const;
  /// Throws hbError where two of the files about to be written, or the statistics, are one file; "" stands for none.
  void checkOutputs(std::vector<std::string> names) const;
  /// Writes the statistics (with version and command added) where they were asked for.
  void writeStats(nlohmann::ordered_json stats) const;
};

/// Options of a subcommand that reads a volume.
struct InputOptions {
  std::string name;
  std::string rawSize, rawType = "uint8", rawOrder = "little", rawAxes = "xyz", rawSpacing, rawInterleaving = "packed";
  std::uint64_t rawOffset = 0;
  int rawComponents = 1;
  std::string series;
  std::optional<double> nanValue;

  /// Adds the options; `positional` is the name the input has in the help.
  void addTo(CLI::App& command, const std::string& positional = "IN");
  void addReadTo(CLI::App& command); ///< All but the positional one.
  /// The layout of a raw file where the options give one. Throws hbError for sizes, types or spacings that are none.
  std::optional<hbRawLayout> rawLayout() const;
  /// Opens `name`, or another file read the same way.
  hbInput open(const CommonOptions& common, hbProgress& progress) const { return open(name, common, progress); }
  hbInput open(const std::string& file, const CommonOptions& common, hbProgress& progress) const;
  /// The field of an opened input for an engine's name, after checking the memory that building it takes.
  std::shared_ptr<const hbField> field(const hbInput& input, const std::string& engine,
                                       const CommonOptions& common) const;
};

/// "AxBxC" with `count` positive numbers, or one number for all where `count` is 3; throws hbError naming `option`.
std::vector<std::int64_t> parseSizes(const std::string& text, std::size_t count, const std::string& option);

/// "X0:X1,Y0:Y1,Z0:Z1", numbers of samples from 0 on; first all the first ones, then the last ones. Throws hbError
/// naming `option` for anything else, and for a last one before its first.
std::pair<hbSize3, hbSize3> parseBox(const std::string& text, const std::string& option);

/// "a,b,c": finite numbers; throws hbError naming `option` unless there are `least` to `most`.
std::vector<double> parseNumbers(const std::string& text, std::size_t least, std::size_t most,
                                 const std::string& option);

/// The extension of a file's name in small letters, ".png".
std::string extension(const std::string& name);

/// "12.3 MB": powers of 1024.
std::string bytesText(double bytes);

/// The progress bar on stderr when it is a terminal, otherwise one that shows nothing; Ctrl-C cancels it.
hbProgress& progress();

/// Takes the bar off the terminal before something else is written there.
void clearProgress() noexcept;

/// After this the first Ctrl-C only cancels progress(), however long what is done about it takes; a second one does
/// what handleInterrupts() says.
void waitAfterInterrupt();

/// Makes Ctrl-C cancel progress(), and end the process within a second in any case, leaving no temporary file.
void handleInterrupts();

} // namespace app

/// Each adds one subcommand to the program, whose callback checks its options, as far as that goes without opening the
/// input, and sets `work` to the rest. `common` must live as long as the program and the work.
void addInfo(CLI::App& program, const app::CommonOptions& common, app::Work& work);
void addGenerate(CLI::App& program, const app::CommonOptions& common, app::Work& work);
void addCompress(CLI::App& program, const app::CommonOptions& common, app::Work& work);
void addExtract(CLI::App& program, const app::CommonOptions& common, app::Work& work);
void addRender(CLI::App& program, const app::CommonOptions& common, app::Work& work);
void addProbe(CLI::App& program, const app::CommonOptions& common, app::Work& work);
void addDiff(CLI::App& program, const app::CommonOptions& common, app::Work& work);
void addCompare(CLI::App& program, const app::CommonOptions& common, app::Work& work);
