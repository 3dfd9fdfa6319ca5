#include "command.h"
#include "evaluate/evaluate.h"
#include "evaluate/number_option.h"
#include "options.h"

namespace abbe {
namespace {

struct RotationCommand {
  EvaluationOptions options;
  RotationOptions rotation;
};

}  // namespace

void add_evaluate_rotation(Subcommand& evaluate, CommandLine& line) {
  auto command = std::make_shared<RotationCommand>();
  Subcommand* app = add_evaluation(
      evaluate, "rotation", "Error motions of a spindle or rotary table (ISO 230-7) from displacement probes",
      "  angle_deg       of the axis, in order of time; runs on from turn to turn or restarts at each\n"
      "  x1_um, y1_um    radial probes along X and Y\n"
      "  x2_um, y2_um    the same in a second plane (tilt, with --plane-distance-mm)\n"
      "  axial_um        on the axis\n"
      "  face_um         parallel to the axis at a radius",
      "x1_um=ch1",
      "  abbe evaluate rotation examples/evaluate/rotation.csv --plane-distance-mm 80 --u-reading-um 0.02 --output "
      "results/spindle",
      command->options);
  add_customer_report_options(*app, command->options);
  add_number(app, "--plane-distance-mm", Quantity::length, "mm", {0.001, 1e6}, command->rotation.plane_distance,
             "Distance from the first to the second plane, in the positive direction of the axis");
  add_number(app, "--sensitive-deg", Quantity::angle, "deg", {-360, 360}, command->rotation.sensitive_angle,
             "Rotating sensitive direction at axis angle zero, from X towards Y (default 0)");
  add_number(app, "--u-reading-um", Quantity::length, "um", {0, 1e6}, command->rotation.reading_uncertainty,
             "Standard uncertainty of one displacement");
  app->callback([&line, command] {
    line.run = [command] {
      return run_evaluation(command->options, [&](const std::string& file) {
        return RotationTest{read_rotation(file, command->options.columns.mapping()), command->rotation};
      });
    };
  });
}

}  // namespace abbe
