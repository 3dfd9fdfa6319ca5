#include "abbe/verify/evaluations/differential_expansion.h"

#include <algorithm>
#include <cmath>

#include "abbe/errors/expansion.h"

namespace abbe {
namespace {

/// Signed: +1 for the machine, -1 for the instrument.
void add_body(const ExpandingBody& body, double common, double sense, const std::array<const char*, 2>& names,
              const std::vector<PositioningReading>& readings, const std::vector<double>& temperatures,
              std::vector<ExpansionContribution>& result) {
  // What both thermometers share is common to both coefficients only as far as these are known.
  const double of_temperature =
      std::hypot(body.coefficient * body.temperature_uncertainty,
                 body.coefficient_uncertainty * body.temperature_uncertainty, body.coefficient_uncertainty * common);
  ExpansionContribution expansion{names[0], {}}, temperature{names[1], {}};
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const double arm = sense * (readings[i].target - body.fixed_point);
    expansion.standard.push_back(body.coefficient_uncertainty * (temperatures[i] - kReferenceTemperature) * arm);
    temperature.standard.push_back(of_temperature * arm);
  }
  for (ExpansionContribution& one : std::array{expansion, temperature}) {
    if (std::any_of(one.standard.begin(), one.standard.end(), [](double value) { return value != 0; })) {
      result.push_back(std::move(one));
    }
  }
}

std::vector<PositioningReading> moved(const std::vector<PositioningReading>& readings, const std::vector<double>& by,
                                      double times) {
  std::vector<PositioningReading> result = readings;
  for (std::size_t i = 0; i < readings.size(); ++i) result[i].deviation += times * by[i];
  return result;
}

}  // namespace

bool DifferentialExpansion::has_uncertainty() const {
  return common_temperature_uncertainty > 0 || machine.coefficient_uncertainty > 0 ||
         machine.temperature_uncertainty > 0 || instrument.coefficient_uncertainty > 0 ||
         instrument.temperature_uncertainty > 0;
}

double nominal_differential_expansion(const DifferentialExpansion& expansion, double position,
                                      const BodyTemperatures& at) {
  const ExpandingBody &machine = expansion.machine, &instrument = expansion.instrument;
  return machine.coefficient * (at.machine - kReferenceTemperature) * (position - machine.fixed_point) -
         instrument.coefficient * (at.instrument - kReferenceTemperature) * (position - instrument.fixed_point);
}

std::vector<PositioningReading> corrected_to_reference_temperature(const std::vector<PositioningReading>& readings,
                                                                   const DifferentialExpansion& expansion,
                                                                   const std::vector<BodyTemperatures>& at) {
  std::vector<PositioningReading> result = readings;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    result[i].deviation -= nominal_differential_expansion(expansion, readings[i].target, at[i]);
  }
  return result;
}

std::vector<ExpansionContribution> expansion_contributions(const std::vector<PositioningReading>& readings,
                                                           const DifferentialExpansion& expansion,
                                                           const std::vector<BodyTemperatures>& at) {
  std::vector<double> of_machine, of_instrument;
  for (const BodyTemperatures& one : at) {
    of_machine.push_back(one.machine);
    of_instrument.push_back(one.instrument);
  }
  const ExpandingBody &machine = expansion.machine, &instrument = expansion.instrument;
  const double common = expansion.common_temperature_uncertainty;
  std::vector<ExpansionContribution> result;
  add_body(machine, common, 1, {"expansion of the machine", "temperature of the machine"}, readings, of_machine,
           result);
  add_body(instrument, common, -1, {"expansion of the instrument", "temperature of the instrument"}, readings,
           of_instrument, result);
  ExpansionContribution shared{"temperature, common", {}};
  bool any = false;
  for (const PositioningReading& reading : readings) {
    shared.standard.push_back(common * (machine.coefficient * (reading.target - machine.fixed_point) -
                                        instrument.coefficient * (reading.target - instrument.fixed_point)));
    any = any || shared.standard.back() != 0;
  }
  if (any) result.push_back(std::move(shared));
  return result;
}

std::array<EvaluatedFigure, kPositioningFigures> positioning_figures(const PositioningEvaluation& e) {
  return {e.accuracy.figure,
          e.unidirectional_accuracy[0].figure,
          e.unidirectional_accuracy[1].figure,
          e.systematic.figure,
          e.unidirectional_systematic[0].figure,
          e.unidirectional_systematic[1].figure,
          e.mean_bidirectional.figure,
          e.repeatability.figure,
          e.unidirectional_repeatability[0],
          e.unidirectional_repeatability[1],
          e.reversal,
          e.mean_reversal};
}

std::array<double, kPositioningFigures> expanded_by_expansion(const std::vector<PositioningReading>& corrected,
                                                              const std::vector<ExpansionContribution>& contributions) {
  const auto figures = positioning_figures(evaluate_positioning(corrected));
  std::array<double, kPositioningFigures> squares{};
  for (const ExpansionContribution& one : contributions) {
    const auto more = positioning_figures(evaluate_positioning(moved(corrected, one.standard, 2)));
    const auto less = positioning_figures(evaluate_positioning(moved(corrected, one.standard, -2)));
    for (std::size_t f = 0; f < figures.size(); ++f) {
      if (!figures[f].is_evaluated()) continue;
      const double change =
          std::max(std::abs(more[f].value - figures[f].value), std::abs(less[f].value - figures[f].value));
      squares[f] += change * change;
    }
  }
  for (double& square : squares) square = std::sqrt(square);
  return squares;
}

}  // namespace abbe
