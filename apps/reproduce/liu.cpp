#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "abbe/formats/json_text.h"
#include "abbe/formats/results_folder.h"
#include "exit_code.h"
#include "progress.h"
#include "reproduce/liu_folder.h"
#include "reproduce/liu_machine.h"
#include "reproduce/liu_results.h"
#include "reproduce/reproduce.h"

namespace abbe {
namespace {

double largest_distance(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return (a - b).colwise().norm().maxCoeff();
}

Eigen::Matrix3Xd closed_form(const Machine& machine, const ErrorSet& errors, const LiuReference& reference) {
  VirtualScan scan;
  scan.positions = reference.positions;
  scan.indication = reference.indication;
  ProbeBeam beam;
  beam.direction = -machine.tool_direction;
  return scanned_points(machine, errors, beam, scan);
}

constexpr std::array<double, 3> kSphereShares = {0.25, 0.5, 0.7};
constexpr double kTaper = 0.014 / 23.5;

/// A part with the path over it and the figures of the paper.
LiuMeasuredPart planned(const Machine& machine, LiuPart model, LiuUnit unit, double before, double after) {
  ScanPlan plan = liu_plan(machine, model, liu_clamping(unit));
  return {std::move(model), std::move(plan), {}, before, after};
}

std::vector<LiuMeasuredPart> planned_parts(const Machine& machine, LiuUnit unit) {
  std::vector<LiuMeasuredPart> parts;
  parts.push_back(planned(machine, liu_cylinder(10, 0), unit, 101.27, 12.42));
  parts.push_back(planned(machine, liu_cross_cylinder(), unit, 0, 64.16));
  parts.push_back(planned(machine, liu_pyramid(), unit, 0, 86.25));
  constexpr std::array<double, 3> kPaper = {9.60, 0, 29.07};
  for (std::size_t i = 0; i < 3; ++i) {
    parts.push_back(planned(machine, liu_sphere(kSphereShares[i]), unit, 0, kPaper[i]));
  }
  parts.push_back(planned(machine, liu_blade(), unit, 0, 0));
  return parts;
}

LiuUnitResults measure_parts(const Machine& machine, LiuUnit unit) {
  LiuScanner scanner;
  scanner.unit = unit;
  scanner.taper = kTaper;
  LiuUnitResults results{unit, liu_calibrate(machine, scanner), planned_parts(machine, unit)};
  for (std::size_t i = 0; i < results.parts.size(); ++i) {
    LiuMeasuredPart& part = results.parts[i];
    // The first part is the standard cylinder, which is not quite one.
    const TriangleMesh scanned = i == 0 ? liu_cylinder(10, kTaper).mesh : part.model.mesh;
    part.measurement = liu_measure(machine, scanner, results.calibration.errors, part.model, scanned, part.plan);
  }
  return results;
}

/// @param parts  as planned with the shifts in micrometres: the cylinder, the others, of which 3 to 5 are the sphere
LiuVariant variant(const Machine& machine, const std::string& words, const LiuScanner& scanner,
                   const std::vector<LiuMeasuredPart>& parts) {
  LiuVariant result{words, liu_calibrate(machine, scanner), {}, {}};
  const ErrorSet& calibrated = result.calibration.errors;
  result.cylinder = liu_measure(machine, scanner, calibrated, parts[0].model,
                                liu_cylinder(10 + scanner.radius_error, scanner.taper).mesh, parts[0].plan);
  for (std::size_t i = 3; i < 6; ++i) {
    result.spheres.push_back(
        liu_measure(machine, scanner, calibrated, parts[i].model, parts[i].model.mesh, parts[i].plan));
  }
  return result;
}

LiuResults liu_results() {
  LiuResults r;
  r.machine = liu_machine();
  const Machine& machine = r.machine;
  const LiuReference reference = read_liu_reference(machine);
  const ErrorSet millimetre = liu_errors(machine, LiuUnit::millimetre),
                 micrometre = liu_errors(machine, LiuUnit::micrometre);
  r.reference = {largest_distance(closed_form(machine, {}, reference), reference.nominal),
                 largest_distance(closed_form(machine, millimetre, reference), reference.millimetre),
                 largest_distance(closed_form(machine, micrometre, reference), reference.micrometre)};
  for (const double difference : r.reference) r.agrees = r.agrees && difference < kLiuAgreement;
  const Eigen::Matrix3Xd exact = closed_form(machine, millimetre, reference);
  for (std::size_t form = 0; form < 2; ++form) {
    r.recursion[form] = largest_distance(liu_recursion(machine, millimetre, reference.positions, reference.indication,
                                                       form == 0 ? LiuRecursion::as_worded : LiuRecursion::corrected),
                                         exact);
  }
  r.agrees = r.agrees && r.recursion[1] < kLiuAgreement;
  r.sensitivity = liu_sensitivity(machine);

  Progress progress("scanning the parts");
  for (const LiuUnit unit : {LiuUnit::millimetre, LiuUnit::micrometre}) {
    progress(r.units.size(), 6);
    r.units.push_back(measure_parts(machine, unit));
    r.agrees = r.agrees && r.units.back().calibration.converged;
    for (const LiuMeasuredPart& part : r.units.back().parts) {
      r.agrees = r.agrees && part.measurement.before.registered && part.measurement.after.registered;
    }
  }
  LiuScanner exact_cylinder, tapered, reversed, wrong_radius;
  tapered.taper = reversed.taper = kTaper;
  reversed.reversed = true;
  wrong_radius.radius_error = 0.021;
  const std::array<std::pair<const char*, LiuScanner>, 4> scanners = {
      {{"cylinder as it is taken for", exact_cylinder},
       {"cylinder with 14 um of taper", tapered},
       {"the same, second clamping end for end", reversed},
       {"cylinder 21 um larger than taken for", wrong_radius}}};
  for (const auto& [words, scanner] : scanners) {
    progress(2 + r.variants.size(), 6);
    r.variants.push_back(variant(machine, words, scanner, r.units[1].parts));
    r.agrees = r.agrees && r.variants.back().calibration.converged;
  }
  return r;
}

}  // namespace

int reproduce_liu(const ReproduceOptions& options) {
  if (!options.output.empty()) check_results_folder(options.output);
  const LiuResults results = liu_results();
  if (!options.output.empty()) write_liu_folder(results, options.output);
  if (options.json) {
    fmt::print("{}", json_text(liu_json(results)));
  } else {
    print_liu(results);
  }
  return results.agrees ? kDone : kNegative;
}

}  // namespace abbe
