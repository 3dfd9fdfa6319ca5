#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/machine/transform_file.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/report/words/registration_words.h"
#include "abbe/study/scans/scan_registration.h"
#include "command.h"
#include "evaluate/number_option.h"
#include "exit_code.h"
#include "messages.h"
#include "options.h"
#include "progress.h"
#include "scan/scan_files.h"

namespace abbe {
namespace {

struct RegisterCommand {
  ScanFiles files;
  std::string start = "global", loss = "adf", output;
  double noise_mm = 0;
  std::uint64_t seed = 1;
  bool uncertainty = false, json = false;

  RegistrationOptions options() const {
    RegistrationOptions result;
    if (start == "identity") {
      result.start = RigidTransform{};
    } else if (start != "global") {
      result.start = read_transform(start);
    }
    result.loss = loss == "tukey" ? RegistrationLoss::tukey : RegistrationLoss::welsch;
    result.adaptive_distance = loss == "adf";
    result.noise_mm = noise_mm;
    result.seed = seed;
    result.threads = files.threads;
    return result;
  }
};

int run_register(const RegisterCommand& command, ProcessGroup* processes) {
  ScanRegistrationRequest request;
  request.options = command.options();
  request.scan_file = command.files.scan;
  request.part_file = command.files.part;
  request.scan = command.files.read_scan();
  request.part = command.files.read_part();
  request.compare = !command.output.empty();
  SharedWork work(processes, "", tell_sentence);
  const ScanRegistration result =
      register_scan(std::move(request), {.progress = Progress("registering").callback(), .work = work.driver()});
  if (!work.is_first()) return kDone;
  if (!command.output.empty()) write_result_files(command.output, scan_registration_files(result));
  if (command.json) {
    fmt::print("{}", json_text(scan_registration_json(result)));
  } else {
    fmt::print("{}", scan_registration_text(result, command.uncertainty));
    if (!command.output.empty()) {
      fmt::print("\nresults in {}{}\n", command.output,
                 has_pose(result.found) ? "" : ", without transform.csv and registered.ply, as there is no pose");
    }
  }
  return result.is_ok() ? kDone : kNegative;
}

}  // namespace

void add_register_command(CommandLine& line) {
  auto command = std::make_shared<RegisterCommand>();
  Subcommand* app = line.add(
      "register", "Fit a scan onto its part, from any start: pose with uncertainty",
      "  abbe register examples/scan/bracket-scan.csv examples/scan/bracket.stl -o results/bracket\n"
      "  abbe register examples/scan/bracket-scan.csv examples/scan/bracket.stl --loss tukey --noise-um 5 "
      "--uncertainty\n"
      "  abbe register examples/scan/pin-scan.csv examples/scan/pin.stl   a pin turns about its axis: exit code 1\n\n"
      "Exit code 1: the scan does not fix one pose (ambiguous, undetermined), or none was found; the output says "
      "which.");
  add_scan_files(app, command->files);
  app->add_input_file(
      "--start", command->start,
      "Start of the search: global (any pose, the default), identity, or a transform file (transform.csv)");
  app->add_option("--loss", command->loss,
                  "welsch, tukey: robust weights with steps to tangent planes; adf (default): Welsch weights with "
                  "second-order steps (adaptive distance function)")
      ->check(one_of({"welsch", "tukey", "adf"}));
  add_number(app, "--noise-um", Quantity::length, "um", {0, 1e6}, command->noise_mm,
             "Standard uncertainty of a point along the normal (default: from the residuals)");
  app->add_option("--seed", command->seed, "Seed of the random choices of the search (default 1)");
  app->add_flag("--uncertainty", command->uncertainty, "Also print the covariance of the pose");
  app->add_output_folder(
      "-o,--output", command->output,
      "Results folder to write: registered.ply (the scan in the frame of the part), transform.csv, "
      "registration.json, report.html (deviations on the part); the first two only if a pose was found");
  app->add_flag("--json", command->json, "Print JSON for programs");
  app->callback([&line, command] { line.share([command](ProcessGroup* all) { return run_register(*command, all); }); });
}

}  // namespace abbe
