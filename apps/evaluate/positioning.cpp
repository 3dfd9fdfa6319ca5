#include <array>

#include "abbe/geometry/angle_units.h"
#include "command.h"
#include "evaluate/evaluate.h"
#include "options.h"

namespace abbe {
namespace {

/// A contribution to the uncertainty, given in the unit of its name.
struct ContributionOption {
  const char* name;
  PositioningUncertaintyInput PositioningTest::*axis;  ///< of which kind
  double PositioningUncertaintyInput::*value;
  double unit;
  const char* help;
};

using Known = PositioningUncertaintyInput;
constexpr auto kLinear = &PositioningTest::linear, kRotary = &PositioningTest::rotary;

constexpr std::array<ContributionOption, 15> kContributions = {{
    {"--instrument-um", kLinear, &Known::instrument, 1e-3,
     "Instrument, expanded (k = 2), part that does not grow with the length"},
    {"--instrument-um-per-m", kLinear, &Known::instrument_per_length, 1e-6,
     "Instrument, expanded (k = 2), part that grows with the length"},
    {"--instrument-arcsec", kRotary, &Known::instrument, kArcsec, "Instrument on a rotary axis, expanded (k = 2)"},
    {"--setup-um", kLinear, &Known::setup, 1e-3, "Mounting, expanded (k = 2)"},
    {"--setup-arcsec", kRotary, &Known::setup, kArcsec, "Mounting or coupling on a rotary axis, expanded (k = 2)"},
    {"--misalignment-mm", kLinear, &Known::misalignment_range, 1,
     "Largest sideways offset of the beam over the measured travel"},
    {"--machine-expansion-um-per-m-K", kLinear, &Known::machine_expansion, 1e-6,
     "Expansion coefficient of the machine"},
    {"--machine-temperature-range-K", kLinear, &Known::machine_temperature_range, 1,
     "Full range in which the machine's temperature is known"},
    {"--machine-expansion-range-um-per-m-K", kLinear, &Known::machine_expansion_range, 1e-6,
     "Full range of that coefficient"},
    {"--instrument-expansion-um-per-m-K", kLinear, &Known::device_expansion, 1e-6,
     "Expansion coefficient of the instrument's scale"},
    {"--instrument-temperature-range-K", kLinear, &Known::device_temperature_range, 1,
     "Full range in which its temperature is known"},
    {"--instrument-expansion-range-um-per-m-K", kLinear, &Known::device_expansion_range, 1e-6,
     "Full range of that coefficient"},
    {"--temperature-from-20C-K", kLinear, &Known::temperature_from_20_C, 1,
     "Largest difference of the temperature from 20 \xC2\xB0\x43"},
    {"--environment-um", kLinear, &Known::environmental_variation, 1e-3,
     "E_VE: range of the indication at rest over the duration of a test"},
    {"--environment-arcsec", kRotary, &Known::environmental_variation, kArcsec, "E_VE on a rotary axis"},
}};

struct PositioningCommand {
  EvaluationOptions options;
  std::array<double, kContributions.size()> contributions{};  ///< in the units of their names
};

int run(const PositioningCommand& command) {
  PositioningTest test;
  test.readings = read_positioning(command.options.file);
  for (std::size_t i = 0; i < kContributions.size(); ++i) {
    const ContributionOption& option = kContributions[i];
    (test.*option.axis).*option.value = command.contributions[i] * option.unit;
  }
  return run_evaluation(std::move(test), command.options);
}

}  // namespace

void add_evaluate_positioning(Subcommand& evaluate, CommandLine& line) {
  auto command = std::make_shared<PositioningCommand>();
  Subcommand* app = add_evaluation(
      evaluate, "positioning", "Accuracy and repeatability of positioning of a linear or rotary axis (ISO 230-2)",
      "  direction       + or -: from which side the target was approached\n"
      "  target_mm       target position; target_deg for a rotary axis\n"
      "  deviation_um    actual minus target; or actual_mm. deviation_arcsec or actual_deg for a rotary axis\n"
      "  run             optional: number or name of the run",
      "  abbe evaluate positioning examples/evaluate/linear.csv\n"
      "  abbe evaluate positioning examples/evaluate/rotary.csv --tolerance A_arcsec=20 -o results/c\n"
      "  abbe evaluate positioning examples/evaluate/linear.csv --instrument-um-per-m 0.6 --misalignment-mm 1 "
      "--environment-um 1.2",
      command->options);
  for (std::size_t i = 0; i < kContributions.size(); ++i) {
    app->add_option(kContributions[i].name, command->contributions[i], kContributions[i].help)
        ->check(in_range(0.0, 1e6))
        ->group("Measurement uncertainty");
  }
  app->callback([&line, command] { line.run = [command] { return run(*command); }; });
}

}  // namespace abbe
