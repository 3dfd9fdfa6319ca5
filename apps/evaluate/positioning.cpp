
#include "abbe/formats/evaluations/evaluation_positioning.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/report/evaluations/positioning_report.h"
#include "command.h"
#include "evaluate/evaluate.h"
#include "options.h"

namespace abbe {
namespace {

/// Contributions as given on the command line, in the units of their names.
struct Contributions {
  double instrument_um = 0, instrument_um_per_m = 0, instrument_arcsec = 0, setup_um = 0, setup_arcsec = 0;
  double misalignment_mm = 0, machine_um_per_m_K = 0, machine_range_K = 0, machine_range_um_per_m_K = 0;
  double device_um_per_m_K = 0, device_range_K = 0, device_range_um_per_m_K = 0, from_20_C_K = 0;
  double environment_um = 0, environment_arcsec = 0;
};

void add_contributions(Subcommand& command, Contributions& c) {
  const auto add = [&](const char* name, double& value, const char* help) {
    command.add_option(name, value, help)->check(in_range(0.0, 1e6))->group("Measurement uncertainty");
  };
  add("--instrument-um", c.instrument_um, "Instrument, expanded (k = 2), part that does not grow with the length");
  add("--instrument-um-per-m", c.instrument_um_per_m, "Instrument, expanded (k = 2), part that grows with the length");
  add("--instrument-arcsec", c.instrument_arcsec, "Instrument on a rotary axis, expanded (k = 2)");
  add("--setup-um", c.setup_um, "Mounting, expanded (k = 2)");
  add("--setup-arcsec", c.setup_arcsec, "Mounting or coupling on a rotary axis, expanded (k = 2)");
  add("--misalignment-mm", c.misalignment_mm, "Largest sideways offset of the beam over the measured travel");
  add("--machine-expansion-um-per-m-K", c.machine_um_per_m_K, "Expansion coefficient of the machine");
  add("--machine-temperature-range-K", c.machine_range_K, "Full range in which the machine's temperature is known");
  add("--machine-expansion-range-um-per-m-K", c.machine_range_um_per_m_K, "Full range of that coefficient");
  add("--instrument-expansion-um-per-m-K", c.device_um_per_m_K, "Expansion coefficient of the instrument's scale");
  add("--instrument-temperature-range-K", c.device_range_K, "Full range in which its temperature is known");
  add("--instrument-expansion-range-um-per-m-K", c.device_range_um_per_m_K, "Full range of that coefficient");
  add("--temperature-from-20C-K", c.from_20_C_K, "Largest difference of the temperature from 20 \xC2\xB0\x43");
  add("--environment-um", c.environment_um, "E_VE: range of the indication at rest over the duration of a test");
  add("--environment-arcsec", c.environment_arcsec, "E_VE on a rotary axis");
}

PositioningUncertaintyInput uncertainty_input(const Contributions& c, bool rotary) {
  const bool lengths = c.instrument_um > 0 || c.instrument_um_per_m > 0 || c.setup_um > 0 || c.misalignment_mm > 0 ||
                       c.environment_um > 0 || c.machine_range_K > 0 || c.device_range_K > 0 ||
                       c.machine_range_um_per_m_K > 0 || c.device_range_um_per_m_K > 0;
  const bool angles = c.instrument_arcsec > 0 || c.setup_arcsec > 0 || c.environment_arcsec > 0;
  if (rotary && lengths) {
    throw InputError({}, "an uncertainty in um or by length or temperature was given for a rotary axis",
                     "--instrument-arcsec, --setup-arcsec, --environment-arcsec");
  }
  if (!rotary && angles) {
    throw InputError({}, "an uncertainty in arcsec was given for a linear axis",
                     "--instrument-um, --setup-um, --environment-um");
  }
  PositioningUncertaintyInput input;
  input.instrument = rotary ? c.instrument_arcsec * kArcsec : c.instrument_um * 1e-3;
  input.instrument_per_length = c.instrument_um_per_m * 1e-6;
  input.setup = rotary ? c.setup_arcsec * kArcsec : c.setup_um * 1e-3;
  input.misalignment_range = c.misalignment_mm;
  input.machine_expansion = c.machine_um_per_m_K * 1e-6;
  input.machine_temperature_range = c.machine_range_K;
  input.machine_expansion_range = c.machine_range_um_per_m_K * 1e-6;
  input.device_expansion = c.device_um_per_m_K * 1e-6;
  input.device_temperature_range = c.device_range_K;
  input.device_expansion_range = c.device_range_um_per_m_K * 1e-6;
  input.temperature_from_20_C = c.from_20_C_K;
  input.environmental_variation = rotary ? c.environment_arcsec * kArcsec : c.environment_um * 1e-3;
  return input;
}

}  // namespace

void add_evaluate_positioning(Subcommand& evaluate, CommandLine& line) {
  struct Options {
    EvaluationOptions common;
    Contributions contributions;
  };
  auto options = std::make_shared<Options>();
  Subcommand* command = add_evaluation(
      evaluate, "positioning", "Accuracy and repeatability of positioning of a linear or rotary axis (ISO 230-2)",
      "  direction       + or -: from which side the target was approached\n"
      "  target_mm       target position; target_deg for a rotary axis\n"
      "  deviation_um    actual minus target; or actual_mm. deviation_arcsec or actual_deg for a rotary axis\n"
      "  run             optional: number or name of the run",
      "  abbe evaluate positioning examples/evaluate/linear.csv\n"
      "  abbe evaluate positioning examples/evaluate/rotary.csv --tolerance A_arcsec=20 -o results/c\n"
      "  abbe evaluate positioning examples/evaluate/linear.csv --instrument-um-per-m 0.6 --misalignment-mm 1 "
      "--environment-um 1.2",
      options->common);
  add_contributions(*command, options->contributions);
  command->callback([&line, options] {
    line.run = [options]() -> int {
      const PositioningFile file = read_positioning(options->common.file);
      const PositioningEvaluation evaluation = evaluate_positioning(file.readings);
      const PositioningUncertaintyInput input = uncertainty_input(options->contributions, file.rotary);
      const PositioningUncertainty uncertainty = positioning_uncertainty(input, evaluation, file.rotary);
      EvaluationReport report =
          positioning_report(evaluation, file.rotary, options->common.file, input.is_empty() ? nullptr : &uncertainty);
      return finish_evaluation(report, options->common);
    };
  });
}

}  // namespace abbe
