#pragma once

// What changed in a machine from one campaign to the next, as `abbe compare` finds it:
//
//   #include <abbe/study/comparison/compared_campaigns.h>
//
//   #include <cstdio>
//
//   int main() {
//     const abbe::CompareRequest request = abbe::read_campaigns(
//         {"examples/compare/march.errors.toml", "examples/compare/october.errors.toml"},
//         "examples/machines/three-axis-mill.machine.toml");
//     const abbe::ComparedCampaigns result = abbe::compare_campaigns(request);
//     for (const abbe::ComparedError& error : result.pairs.front().errors) {
//       if (error.verdict != abbe::ChangeVerdict::changed) continue;
//       const double micro = error.is_angle ? 1e6 : 1e3;
//       std::printf("%s changed by %.1f +- %.1f %s\n", error.name.c_str(), micro * error.change,
//                   micro * *error.expanded_uncertainty, error.is_angle ? "urad" : "um");
//     }
//     return result.is_judged() ? 0 : 1;  // evaluation_text(result.report) says more
//   }
//
// It prints:
//
//   EXX changed by 7.6 +- 1.6 um
//   EC0Y changed by 19.7 +- 6.0 urad
//
// Its page and files: evaluation_files(result.report) and comparison_files(). Method and figures: docs/compare.md.

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/machine/machine.h"
#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/report/evaluations/partial_errors.h"
#include "abbe/study/job_options.h"
#include "abbe/verify/error_map.h"
#include "abbe/verify/volumetric_figures.h"

namespace abbe {

/// The errors of a machine as they were identified at one time.
struct IdentifiedCampaign {
  std::string name;         ///< for texts: "march"
  std::string errors_file;  ///< for messages; the name itself if there is no file
  Machine machine;          ///< as it was described then
  ErrorsFile errors;
};

/// Campaigns of one machine, in the order of time.
///
/// Messages name a field by the option of `abbe compare` that sets it, given below.
struct CompareRequest {
  std::vector<IdentifiedCampaign> campaigns;  ///< two to 26
  double level = 0.05;                        ///< --level-percent: of the family of errors of a pair, 0 to 0.5
  std::vector<std::string> states{};          ///< --state: "ambient_degC=26.5", where the change is mapped
  std::vector<std::string> tolerances;        ///< --tolerance: "V_max_um=10", as apply_tolerances() takes them
  bool page = false;                          ///< the report is to have plots and the map, for its page
  bool curves = false;                        ///< the error motions are to have their curves, as for a page
};

/// Opens the files of campaigns.
/// @param campaigns     results folders of `abbe run`, or errors files
/// @param machine_file  of all of them; empty: machine.toml of each results folder
/// @throws InputError naming the file, or --machine for an errors file without a machine
CompareRequest read_campaigns(const std::vector<std::string>& campaigns, const std::string& machine_file);
/// The same for one campaign. @param machine  absent: machine.toml of its results folder
IdentifiedCampaign read_campaign(const std::string& path, const std::optional<Machine>& machine,
                                 StatesOfErrors states = StatesOfErrors::refused);
/// Makes duplicate names unique: by their paths, and if these are equal too, by a number.
/// @param paths  [campaigns] or other words for them
void make_names_different(std::vector<IdentifiedCampaign>& campaigns, const std::vector<std::string>& paths);

/// Verdict on the change of an error.
enum class ChangeVerdict {
  changed,          ///< significant with the others of its pair (Holm)
  not_significant,  ///< explained by the uncertainties
  not_known,        ///< the files state no uncertainty of it
  partly,           ///< a convention stands for a part of it in one campaign: neither judged nor mapped
  only_first,       ///< in the other campaign a convention sets it
  only_second,
  by_convention  ///< a convention sets it in both
};

/// Whether a change with this verdict is one: the error was identified in both campaigns.
bool is_comparable(ChangeVerdict verdict);
/// For programs: "changed", "not_significant", "not_known", "partly_set", "only_first", "only_second", "by_convention".
std::string change_verdict_name(ChangeVerdict verdict);

/// An error motion over a range, [n] each; mm or rad. First and second are in the same gauge, in the functions that
/// both campaigns can describe.
struct ComparedCurve {
  std::vector<double> position, first, second, change;
  std::vector<double> u_first, u_second, u_change;  ///< standard uncertainties, or empty
};

/// The change of one error from the first to the second campaign of a pair; mm or rad.
struct ComparedError {
  std::string name;   ///< "EXX", "EC0Y", "reversal_X", "tool_offset"
  std::string words;  ///< "positioning error motion of X"
  std::string per{};  ///< of errors with a state: unit of its factor, "K" or "N m"; all values are per that unit
  std::size_t axis = 0;
  bool is_angle = false;
  bool is_motion = false;           ///< a function of the position of its axis: has a curve, a range and a place
  double from = 0, to = 0;          ///< range in which both know it
  double change = 0;                ///< second - first where its amount is largest; tool offset: length of the change
  double at = 0;                    ///< there
  std::array<double, 2> value{};    ///< of first and second there
  std::array<double, 2> u_value{};  ///< their standard uncertainties, where both campaigns state them
  std::array<double, 2> beyond{};   ///< largest amount of what the functions of the other campaign cannot describe
  std::optional<double> expanded_uncertainty;  ///< of `change`, k = 2
  std::optional<double> chi_square;            ///< of the whole function; none where it cannot be judged
  std::size_t rank = 0;                        ///< its degrees of freedom
  double probability = 1;                      ///< of a larger chi-square without a change
  double adjusted = 1;                         ///< the same after Holm's procedure: changed where it is below the level
  double at_tool = 0;  ///< largest displacement of the functional point by this change alone, mm
  ChangeVerdict verdict = ChangeVerdict::not_known;
  ComparedCurve curve;
};

/// A later campaign against an earlier one.
struct ComparedPair {
  std::size_t first = 0, second = 0;                 ///< campaigns
  std::vector<ComparedError> errors;                 ///< of both files, in the order of the first
  std::vector<std::string> only_first, only_second;  ///< names of errors that one file has
  std::vector<std::string> apart;                    ///< names of error motions without a range in common
  std::vector<std::string> conventions;  ///< equations that were set for both, because one campaign knows no better
  PartialErrors partial;                 ///< what moves the tool and is not in both
  bool tools_differ = false;             ///< tool offset errors are not compared
  std::optional<double> chi_square;      ///< of all judged errors together, where both have one gauge
  std::size_t rank = 0;
  double probability = 1;
  StatedPoses stated;  ///< of the map
  /// Change of the displacement of the functional point, second - first, after the best fit of the workpiece datum;
  /// uncertainties from both campaigns, where both state them.
  ErrorMap change;
  std::vector<double> expanded;  ///< [poses] 2 sqrt(u_x^2 + u_y^2 + u_z^2), mm, or empty
  std::optional<double> share;   ///< of the poses, where the change is larger than that

  std::size_t count(ChangeVerdict verdict) const;
};

/// Campaigns against each other. It holds no reference to the request.
struct ComparedCampaigns {
  Machine machine;                 ///< of the first campaign, with the travel that all have
  std::vector<std::string> names;  ///< of the campaigns, each once
  double level = 0.05;
  StateValues at_state{};           ///< where the changes are mapped: as requested, else at the references
  std::vector<ComparedPair> pairs;  ///< each against the first; then each but the second against the one before
  EvaluationReport report;          ///< with the tolerances of the request

  /// Whether every pair has errors to compare and the significance of all of them is known.
  bool is_judged() const;
};

/// Compares campaigns. Opens no file and prints nothing.
/// @param options  progress: pairs done of all
/// Errors with states are compared per unit of the factor of their state, as errors of their own.
/// @throws InputError for fewer than two campaigns, machines of different chains, axes or states, errors composed in
/// different
///   orders, a level that is not one, and as apply_tolerances()
/// @throws Stopped
ComparedCampaigns compare_campaigns(const CompareRequest& request, const JobOptions& options = {});

/// Files of the maps of the change, name and contents: change.csv and change.vts (or .vtu), a pair each.
std::vector<std::pair<std::string, std::string>> comparison_files(const ComparedCampaigns& result);

}  // namespace abbe
