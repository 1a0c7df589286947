#include "apps/FitOptions.h"

#include <map>

#include <CLI/CLI.hpp>

namespace {

constexpr const char* kInterpolation = "interpolation";

const std::map<std::string, hbFit::Method>& methods() {
  static const std::map<std::string, hbFit::Method> names{{"opticom", hbFit::Method::opticom},
                                                          {"least-squares", hbFit::Method::leastSquares}};
  return names;
}

} // namespace

void app::FitOptions::addTo(CLI::App& subcommand) {
  subcommand
      .add_option("--fit", method,
                  "interpolation (default): the samples at the nodes, whatever lies between; opticom: the coefficients "
                  "of the combination that suit all samples best; least-squares: the surpluses that do. Judged by "
                  "samples held out: where it is no better, interpolation is kept")
      ->check(CLI::IsMember({kInterpolation, "opticom", "least-squares"}));
  const std::map<std::string, hbFitLoss::Kind> losses{{"none", hbFitLoss::Kind::none},
                                                      {"huber", hbFitLoss::Kind::huber}};
  subcommand
      .add_option("--loss", fit.loss,
                  "none (default): squared residuals; huber: those of bad samples count less, so that outliers do not "
                  "spoil the fit")
      ->transform(CLI::CheckedTransformer(losses));
  subcommand
      .add_option("--loss-threshold", fit.threshold,
                  "From which residual on huber counts less, in data values (default: 1.345 standard deviations of a "
                  "plain fit's residuals, by their median)")
      ->check(CLI::PositiveNumber)
      ->type_name("VALUE");
  subcommand
      .add_option("--smoothing", fit.smoothing,
                  "Weight of the squared mixed derivative in least squares (default: what the samples held out say)")
      ->check(CLI::NonNegativeNumber)
      ->type_name("WEIGHT");
  const std::map<std::string, hbFit::Solver> solvers{{"auto", hbFit::Solver::automatic},
                                                     {"ceres", hbFit::Solver::ceres},
                                                     {"conjugate-gradient", hbFit::Solver::conjugateGradient}};
  subcommand.add_option("--solver", fit.solver, "Of least squares; auto (default): Ceres for small problems")
      ->transform(CLI::CheckedTransformer(solvers));
  subcommand.add_flag("--keep-best", fit.keepBest,
                      "On Ctrl-C end the fit and write the best so far; a second one ends the program");
}

std::optional<hbFit> app::FitOptions::choice(const CLI::App& subcommand) const {
  const auto given = [&](const char* name) { return subcommand.count(name) > 0; };
  const auto found = methods().find(method);
  if (found == methods().end()) {
    for (const char* name : {"--loss", "--loss-threshold", "--smoothing", "--solver", "--keep-best"})
      if (given(name)) throw CLI::ValidationError(name, "expected --fit opticom or least-squares beside it");
    return {};
  }
  hbFit choice = fit;
  choice.method = found->second;
  if (choice.method != hbFit::Method::leastSquares)
    for (const char* name : {"--smoothing", "--solver"})
      if (given(name)) throw CLI::ValidationError(name, "expected --fit least-squares beside it");
  if (choice.threshold && choice.loss != hbFitLoss::Kind::huber)
    throw CLI::ValidationError("--loss-threshold", "expected --loss huber beside it");
  return choice;
}
