#pragma once

#include <optional>
#include <string>

#include "fitting/hbFit.h"

namespace CLI {
class App;
} // namespace CLI

namespace app {

/// Adds `--loss none|huber`.
void addLoss(CLI::App& subcommand, hbFitLoss::Kind& loss, const std::string& help);

/// The options of `compress` that say how the grid is fitted to the samples.
struct FitOptions {
  std::optional<hbFit::Method> method; ///< None: interpolation.
  hbFit fit;                           ///< Everything but the method.

  void addTo(CLI::App& subcommand);

  /// What they ask for; none: interpolation. Throws CLI::ValidationError where options do not go together.
  std::optional<hbFit> choice(const CLI::App& subcommand) const;
};

} // namespace app
