#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/machine/transform_file.h"
#include "abbe/formats/shapes/ply_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/geometry/registration/registration.h"
#include "abbe/report/pages/evaluation_data.h"
#include "abbe/report/pages/registration_page.h"
#include "abbe/report/report.h"
#include "abbe/report/words/geometry_facts.h"
#include "abbe/report/words/registration_words.h"
#include "command.h"
#include "evaluate/number_option.h"
#include "exit_code.h"
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

PointCloud moved(const PointCloud& cloud, const RigidTransform& pose) {
  PointCloud result;
  result.points = (pose.rotation * cloud.points).colwise() + pose.translation;
  if (cloud.has_normals()) result.normals = pose.rotation * cloud.normals;
  return result;
}

int run_register(const RegisterCommand& command) {
  const RegistrationOptions options = command.options();
  const PointCloudFile scan = command.files.read_scan();
  const MeshFile part = command.files.read_part();
  Registration result;
  const RegistrationTarget target(part.mesh, options);
  {
    Progress progress("registering");
    result = target.register_scan(scan.cloud, progress.callback());
  }
  nlohmann::ordered_json json;
  json["scan"] = command.files.scan;
  json["part"] = command.files.part;
  for (const auto& [name, text] : facts_of(scan, part)) json["files"][name] = text;
  json.update(registration_json(result));
  if (!command.output.empty()) {
    const PointCloud placed = moved(scan.cloud, result.fine.mesh_from_scan);
    ResultsFolder folder(command.output);
    folder.write("registration.json", json_text(json));
    if (has_pose(result)) {
      const bool sure = result.status == RegistrationStatus::ok;
      folder.write("transform.csv",
                   transform_csv(result.fine.mesh_from_scan, sure ? "" : registration_status_name(result.status)));
      folder.write("registered.ply", ply_bytes({.points = placed.points, .normals = placed.normals}));
    }
    const auto name = [](const std::string& file) { return std::filesystem::path(file).filename().string(); };
    std::optional<ScanComparison> compared;
    if (has_pose(result)) {
      compared = compare_scan(target.surface(), placed.points,
                              {.largest_mm = farthest_shown_mm(part.mesh), .threads = command.files.threads});
    }
    EvaluationReport page =
        registration_page(fmt::format("Registration of {} on {}", name(command.files.scan), name(command.files.part)),
                          result, part.mesh, compared ? &*compared : nullptr, command.files.threads);
    const auto facts = facts_of(scan, part);
    page.facts.insert(page.facts.begin(), facts.begin(), facts.end());
    for (const std::string& note : part.notes) page.notes.push_back(name(command.files.part) + ": " + note);
    folder.write("report.html", report_page(evaluation_data(page)));
    folder.commit();
  }
  if (command.json) {
    fmt::print("{}", json_text(json));
  } else {
    fmt::print("Registration of {} on {}\n", command.files.scan, command.files.part);
    for (const auto& [name, text] : facts_of(scan, part)) fmt::print("  {}: {}\n", name, text);
    fmt::print("\n{}", registration_text(result, scan.cloud.size(), command.uncertainty));
    for (const std::string& note : part.notes) fmt::print("note: {}: {}\n", command.files.part, note);
    if (!command.output.empty()) {
      fmt::print("\nresults in {}{}\n", command.output,
                 has_pose(result) ? "" : ", without transform.csv and registered.ply, as there is no pose");
    }
  }
  return result.status == RegistrationStatus::ok ? kDone : kNegative;
}

}  // namespace

void add_register_command(CommandLine& line) {
  auto command = std::make_shared<RegisterCommand>();
  Subcommand* app = line.add(
      "register", "Fit a scan onto its part: pose with uncertainty, from any start",
      "  abbe register examples/scan/bracket-scan.csv examples/scan/bracket.stl -o results/bracket\n"
      "  abbe register examples/scan/bracket-scan.csv examples/scan/bracket.stl --loss tukey --noise-um 5 "
      "--uncertainty\n"
      "  abbe register examples/scan/pin-scan.csv examples/scan/pin.stl   a pin turns about its axis: exit code 1\n\n"
      "Exit code 1: the scan does not fix one pose (ambiguous, undetermined), or none was found; the output says "
      "which.");
  add_scan_files(app, command->files);
  app->add_input_file("--start", command->start,
                      "Where to begin: global (any pose, the default), identity, or a transform file (transform.csv)");
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
  app->callback([&line, command] { line.run = [command] { return run_register(*command); }; });
}

}  // namespace abbe
