#include <array>
#include <string>
#include <vector>

#include "liu/folder.h"
#include "liu/machine.h"
#include "liu/results.h"
#include "papers.h"
#include "progress.h"

namespace abbe {
namespace {

double largest_distance(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return (a - b).colwise().norm().maxCoeff();
}

Eigen::Matrix3Xd closed_form(const Machine& machine, const ErrorSet& errors, const LiuReference& reference) {
  return liu_points(machine, errors, reference.positions, reference.indication);
}

constexpr std::array<double, 3> kSphereShares = {0.25, 0.5, 0.7};
constexpr std::size_t kLiuCampaigns = 100;

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
  scanner.taper = kLiuTaper;
  LiuUnitResults results{unit, liu_calibrate(machine, scanner), planned_parts(machine, unit)};
  for (std::size_t i = 0; i < results.parts.size(); ++i) {
    LiuMeasuredPart& part = results.parts[i];
    // The first part is the standard cylinder, which is not quite one.
    const TriangleMesh scanned = i == 0 ? liu_cylinder(10, kLiuTaper).mesh : part.model.mesh;
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
  r.figures = liu_figure_study(machine, kLiuCampaigns);
  r.agrees = r.agrees && r.figures.complete() && r.figures.reference.difference < kLiuAgreement;

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
  tapered.taper = reversed.taper = kLiuTaper;
  reversed.reversed = true;
  wrong_radius.radius_error = 0.021;
  const std::array<std::pair<const char*, LiuScanner>, 4> scanners = {
      {{"cylinder as assumed", exact_cylinder},
       {"cylinder with 14 um of taper", tapered},
       {"the same, second clamping end for end", reversed},
       {"cylinder 21 um larger than assumed", wrong_radius}}};
  for (const auto& [words, scanner] : scanners) {
    progress(2 + r.variants.size(), 6);
    r.variants.push_back(variant(machine, words, scanner, r.units[1].parts));
    r.agrees = r.agrees && r.variants.back().calibration.converged;
  }
  return r;
}

std::vector<std::string> liu_failures(const LiuResults& r) {
  std::vector<std::string> failures;
  if (!r.figures.complete()) failures.emplace_back("a calibration of section 4.2 does not converge");
  for (const LiuUnitResults& unit : r.units) {
    if (!unit.calibration.converged) failures.push_back("calibration of the stages: " + unit.calibration.message);
    for (const LiuMeasuredPart& part : unit.parts) {
      if (!part.measurement.before.registered || !part.measurement.after.registered) {
        failures.push_back(part.model.name + " is not registered");
      }
    }
  }
  return failures;
}

Reproduction liu_reproduction() {
  const LiuResults r = liu_results();
  Reproduction made;
  made.paper = "liu";
  made.citation = "Liu, Zhu, Miao, Li, Fang, Zhang (2021), Sensors 21, 4609";
  made.title =
      "Cradle-type five-axis point scanner: closed form, error terms, calibration of stages and clamping, paths, "
      "virtual measurement";
  made.facts = {{"machine", r.machine.chain() + ", confocal probe on Z"}};
  made.tables = liu_tables(r);
  made.published = liu_published(r);
  made.figures = liu_figures(r.figures);
  made.headline = liu_headline(r.figures);
  made.conclusions = liu_conclusions(r);
  made.corrections = liu_corrections();
  made.failures = liu_failures(r);
  made.agrees = r.agrees;
  made.page = liu_page(r);
  made.details = liu_details(r);
  made.write_study = [r](ResultsFolder& folder) { write_liu_study(r, folder); };
  return made;
}

}  // namespace

int reproduce_liu(const ReproduceOptions& options) { return run_reproduction(options, liu_reproduction); }

}  // namespace abbe
