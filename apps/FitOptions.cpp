#include "apps/FitOptions.h"

#include <CLI/CLI.hpp>

#include "apps/ChoiceOption.h"

void app::addLoss(CLI::App& subcommand, hbFitLoss::Kind& loss, const std::string& help) {
  addChoice(subcommand, "--loss", loss, {{"none", hbFitLoss::Kind::none}, {"huber", hbFitLoss::Kind::huber}}, help);
}

void app::FitOptions::addTo(CLI::App& subcommand) {
  addChoice(
      subcommand, "--fit", method,
      {{"interpolation", {}}, {"opticom", hbFit::Method::opticom}, {"least-squares", hbFit::Method::leastSquares}},
      "interpolation (default): the samples at the nodes, whatever lies between; opticom: the coefficients of the "
      "combination that suit all samples best; least-squares: the surpluses that do. Judged by samples held out: "
      "where it is no better, interpolation is kept");
  addLoss(
      subcommand, fit.loss,
      "none (default): squared residuals; huber: those of bad samples count less, so that outliers do not spoil the "
      "fit");
  subcommand
      .add_option("--loss-threshold", fit.threshold,
                  "From which residual on huber counts less, in data values (default: 1.345 standard deviations of a "
                  "plain fit's residuals, by their median)")
      ->check(CLI::PositiveNumber & isFinite())
      ->type_name("VALUE");
  subcommand
      .add_option("--smoothing", fit.smoothing,
                  "Weight of the squared mixed derivative in least squares (default: what the samples held out say)")
      ->check(CLI::NonNegativeNumber & isFinite())
      ->type_name("WEIGHT");
  addChoice(subcommand, "--solver", fit.solver,
            {{"auto", hbFit::Solver::automatic},
             {"ceres", hbFit::Solver::ceres},
             {"conjugate-gradient", hbFit::Solver::conjugateGradient}},
            "Of least squares; auto (default): Ceres for small problems");
  subcommand.add_flag("--keep-best", fit.keepBest,
                      "On Ctrl-C end the fit and write the best so far; a second one ends the program");
}

std::optional<hbFit> app::FitOptions::choice(const CLI::App& subcommand) const {
  const auto given = [&](const char* name) { return subcommand.count(name) > 0; };
  if (!method) {
    for (const char* name : {"--loss", "--loss-threshold", "--smoothing", "--solver", "--keep-best"})
      if (given(name)) throw CLI::ValidationError(name, "expected --fit opticom or least-squares beside it");
    return {};
  }
  if (*method != hbFit::Method::leastSquares)
    for (const char* name : {"--smoothing", "--solver"})
      if (given(name)) throw CLI::ValidationError(name, "expected --fit least-squares beside it");
  if (fit.threshold && fit.loss != hbFitLoss::Kind::huber)
    throw CLI::ValidationError("--loss-threshold", "expected --loss huber beside it");
  hbFit choice = fit;
  choice.method = *method;
  return choice;
}
