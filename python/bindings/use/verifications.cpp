#include <fmt/format.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include <nlohmann/json.hpp>

#include "abbe/study/verification/verification.h"
#include "abbe/study/verification/verification_page.h"
#include "abbe/study/verification/verification_text.h"
#include "bindings/files.h"
#include "bindings/job.h"
#include "bindings/use/map_parts.h"
#include "bindings/use/piece_parts.h"

namespace abbe::python {
namespace {

/// A test piece with what the axes were commanded without and with the compensation.
using RunPieces = std::vector<std::tuple<std::variant<ConeFrustum, SShape>, PieceTrace, PieceTrace>>;

struct VerificationArguments {
  std::size_t poses = 1000;
  std::optional<std::uint64_t> seed;
  AxisRanges ranges;
  std::optional<double> least_reduction, largest_ratio;
  RunPieces pieces;
  double reach_mm = 1;
};

Verification verified(VerificationRequest request, const VerificationArguments& given, const nb::object& progress) {
  request.poses = given.poses;
  if (given.seed) request.seed = *given.seed;
  request.ranges = axis_ranges(request.machine, "ranges", given.ranges, false);
  request.least_reduction = given.least_reduction;
  request.largest_ratio = given.largest_ratio;
  request.reach_mm = given.reach_mm;
  if (!(given.reach_mm >= 0.01 && given.reach_mm <= 10)) {
    throw InputError({.field = "reach_mm"}, fmt::format("is {}", given.reach_mm), "0.01 to 10 mm");
  }
  if (given.poses > 10000) throw InputError({.field = "poses"}, fmt::format("is {}", given.poses), "10 to 10000");
  for (const auto& [sizes, before, after] : given.pieces) {
    for (const PieceTrace* trace : {&before, &after}) {
      if (trace->trace.commands.axis.size() == request.machine.axes.size()) continue;
      throw InputError({.file = trace->file, .field = "pieces"},
                       fmt::format("a trace of {} axes", trace->trace.commands.axis.size()),
                       fmt::format("{} axes: {}", request.machine.axes.size(), request.machine.chain()));
    }
    request.pieces.push_back({sizes, before, after});
  }
  return job_result(progress, [&](const JobControl& control) {
    return naming_arguments([&] {
      return verify_compensation(
          request, {.progress = [&](VerificationStep step, std::size_t done,
                                    std::size_t total) { control.progress(step_words(step), done, total); },
                    .stop = control.stop});
    });
  });
}

Verification of_errors(const MachineErrors& identified, const MachineErrors& truth, const VerificationArguments& given,
                       const std::string& errors_file, const std::string& truth_file, const nb::object& progress) {
  require_same_machine(identified.machine, truth.machine, "truth");
  VerificationRequest request;
  request.machine = identified.machine;
  request.identified = identified.file;
  request.truth = truth.file;
  request.errors_file = errors_file;
  request.truth_file = truth_file;
  return verified(std::move(request), given, progress);
}

void bind_poses_of(nb::module_& module) {
  nb::class_<CompensatedPoses>(module, "CompensatedPoses",
                               "What a compensation leaves of the errors of a machine at poses, each pose one value.")
      .def_ro("outside_travel", &CompensatedPoses::outside_travel, "Poses whose corrected commands leave the travel.")
      .def_ro("not_reached", &CompensatedPoses::not_reached, "Poses whose point is not reached.")
      .def_ro("not_covered", &CompensatedPoses::not_covered, "Poses outside the range in which the errors are known.")
      .def_prop_ro(
          "before_mm", [](const CompensatedPoses& p) { return copied_array(p.before); },
          nb::sig("def before_mm(self) -> numpy.ndarray"), "[n] volumetric error, mm.")
      .def_prop_ro(
          "after_mm", [](const CompensatedPoses& p) { return copied_array(p.after); },
          nb::sig("def after_mm(self) -> numpy.ndarray"), "[n] the same with the compensation, mm.")
      .def_prop_ro(
          "direction_before_rad", [](const CompensatedPoses& p) { return copied_array(p.direction_before); },
          nb::sig("def direction_before_rad(self) -> numpy.ndarray"),
          "[n] angle of the tool's direction to the wanted one, rad.")
      .def_prop_ro(
          "direction_after_rad", [](const CompensatedPoses& p) { return copied_array(p.direction_after); },
          nb::sig("def direction_after_rad(self) -> numpy.ndarray"), "[n] the same with the compensation, rad.")
      .def_prop_ro(
          "uncertainty_mm",
          [](const CompensatedPoses& p) -> nb::object {
            if (p.uncertainty.empty()) return nb::none();
            return copied_array(p.uncertainty);
          },
          nb::sig("def uncertainty_mm(self) -> numpy.ndarray | None"),
          "[n] predicted standard uncertainty of after_mm (JCGM 100), mm; None: not stated.")
      .def_ro("coverage", &CompensatedPoses::coverage,
              "Share of the coordinates within twice their predicted standard uncertainty.")
      .def_ro("before_statistics_mm", &CompensatedPoses::before_statistics)
      .def_ro("after_statistics_mm", &CompensatedPoses::after_statistics)
      .def_ro("direction_before_statistics_rad", &CompensatedPoses::direction_before_statistics)
      .def_ro("direction_after_statistics_rad", &CompensatedPoses::direction_after_statistics)
      .def_ro("uncertainty_statistics_mm", &CompensatedPoses::uncertainty_statistics)
      .def_prop_ro("reduction", &CompensatedPoses::reduction, "Mean volumetric error before over that after.")
      .def_prop_ro("uncertainty_ratio", &CompensatedPoses::uncertainty_ratio,
                   "Root mean square error after correction over the predicted one; 0 without a covariance.")
      .def("__repr__", [](const CompensatedPoses& p) {
        return fmt::format("<abbe.CompensatedPoses: {}, mean {:.3f} um before, {:.3f} um after>", p.before.size(),
                           1e3 * p.before_statistics.mean, 1e3 * p.after_statistics.mean);
      });
  nb::class_<VerificationVerdict>(module, "Verdict", "On one of the figures that may be asked for.")
      .def_ro("text", &VerificationVerdict::text)
      .def_ro("met", &VerificationVerdict::met)
      .def("__bool__", [](const VerificationVerdict& v) { return v.met; })
      .def("__repr__", [](const VerificationVerdict& v) {
        return fmt::format("<abbe.Verdict {}: {}>", v.met ? "met" : "not met", v.text);
      });
}

void bind_result(nb::module_& module) {
  nb::class_<Verification>(module, "Verification", "What a compensation leaves. Made by verify() and verify_results().")
      .def_ro("machine", &Verification::machine)
      .def_ro("parameters", &Verification::parameters, "Of the identified errors.")
      .def_ro("seed", &Verification::seed, "Of the random poses.")
      .def_ro("poses_asked", &Verification::poses_asked, "With those that are left out.")
      .def_prop_ro(
          "ranges_mm_rad",
          [](const Verification& v) {
            std::map<std::string, std::pair<double, double>> ranges;
            for (std::size_t i = 0; i < v.ranges.size(); ++i) {
              ranges[v.machine.axes[i].name] = {v.ranges[i].from, v.ranges[i].to};
            }
            return ranges;
          },
          "Of the random poses, by axis.")
      .def_ro("correlations_known", &Verification::correlations_known,
              "False: the errors state standard uncertainties only.")
      .def_ro("partial", &Verification::partial, "What the identified errors do not state.")
      .def_ro("both_directions", &Verification::both_directions,
              "There are reversal values: axes come from either side.")
      .def_ro("poses", &Verification::poses, "At random poses.")
      .def_ro("volumetric_mm", &Verification::volumetric, "Over the grid that all commands state.")
      .def_ro("pieces", &Verification::pieces, "Test pieces that were run twice.")
      .def_ro("verdicts", &Verification::verdicts, "On least_reduction and largest_ratio, where they were asked for.")
      .def_prop_ro("left_out", &Verification::left_out, "Random poses without a result.")
      .def_prop_ro("says_no", &Verification::says_no, "Whether something that was asked for is not met.")
      .def("sentence", &verification_sentence, "What was achieved, in one sentence.")
      .def("text", &verification_text, "What `abbe verify` prints.")
      .def(
          "to_dict", [](const Verification& v) { return python_value(verification_json(v)); },
          nb::sig("def to_dict(self) -> dict[str, typing.Any]"), "The same as `abbe verify --json`.")
      .def(
          "page_data", [](const Verification& v) { return python_value(verification_page_data(v)); },
          nb::sig("def page_data(self) -> dict[str, typing.Any]"), "Data of the page: docs/report-data.md.")
      .def("page_html", &verification_page, "The page of `abbe verify -o`, HTML.")
      .def(
          "write_page",
          [](const Verification& v, const std::filesystem::path& path, bool overwrite) {
            write_text(path, verification_page(v), overwrite);
          },
          nb::arg("path"), nb::arg("overwrite") = false, "Writes the page (*.html), whole or not at all.")
      .def("__repr__", [](const Verification& v) {
        return fmt::format("<abbe.Verification: {} poses, mean {:.3f} um before, {:.3f} um after{}>",
                           v.poses.before.size(), 1e3 * v.poses.before_statistics.mean,
                           1e3 * v.poses.after_statistics.mean, v.says_no() ? ", a condition is not met" : "");
      });
}

}  // namespace

void bind_verifications(nb::module_& module) {
  bind_poses_of(module);
  bind_piece_parts(module);
  bind_result(module);
  module.def(
      "verify",
      [](const MachineErrors& identified, const MachineErrors& truth, std::size_t poses, std::uint64_t seed,
         AxisRanges ranges, std::optional<double> least_reduction, std::optional<double> largest_ratio,
         RunPieces pieces, double reach_mm, const std::string& errors_file, const std::string& truth_file,
         const nb::object& progress) {
        return of_errors(identified, truth,
                         {poses, seed, std::move(ranges), least_reduction, largest_ratio, std::move(pieces), reach_mm},
                         errors_file, truth_file, progress);
      },
      nb::arg("identified"), nb::arg("truth"), nb::kw_only(), nb::arg("poses") = 1000, nb::arg("seed") = 1,
      nb::arg("ranges") = AxisRanges{}, nb::arg("least_reduction") = nb::none(), nb::arg("largest_ratio") = nb::none(),
      nb::arg("pieces") = RunPieces{}, nb::arg("reach_mm") = 1.0, nb::arg("errors_file") = "errors.toml",
      nb::arg("truth_file") = "truth.errors.toml", nb::arg("progress") = nb::none(),
      "What a compensation leaves of the errors of a simulated machine: at unseen poses and on test pieces.\n\n"
      "identified: errors that are corrected. truth: errors that the machine has. poses: random ones, 10 to 10000.\n"
      "ranges: {'X_mm': (-100, 100), 'C_deg': 30}; else where the errors are known. least_reduction: the mean\n"
      "volumetric error has to become so many times smaller. largest_ratio: of what is left to its predicted\n"
      "uncertainty. pieces: [(ConeFrustum(), before, after)] with Traces of the program without and with the\n"
      "compensation. reach_mm: a sample farther from the path of a piece does not cut it. progress: a function of the\n"
      "step, what is done and its total. Raises InputError. Method: docs/verify.md.\n\n"
      ">>> import abbe\n"
      ">>> mill = abbe.Machine.from_chain(\"w X' Y' b Z t\")\n"
      ">>> truth, identified = abbe.Errors(mill), abbe.Errors(mill)\n"
      ">>> truth.add_location('EC0Y', value_urad=20)\n"
      ">>> identified.add_location('EC0Y', value_urad=19)\n"
      ">>> result = abbe.verify(identified, truth, poses=50, least_reduction=10)\n"
      ">>> result.says_no, round(result.poses.reduction, 1)\n"
      "(False, 20.0)\n");
  module.def(
      "verify_results",
      [](const std::string& results, const std::string& machine, const std::string& errors, const std::string& truth,
         std::size_t poses, std::optional<std::uint64_t> seed, AxisRanges ranges, std::optional<double> least_reduction,
         std::optional<double> largest_ratio, RunPieces pieces, double reach_mm, const nb::object& progress) {
        return verified(
            naming_arguments([&] {
              return read_verification({.results = results, .machine = machine, .errors = errors, .truth = truth});
            }),
            {poses, seed, std::move(ranges), least_reduction, largest_ratio, std::move(pieces), reach_mm}, progress);
      },
      nb::arg("results") = "", nb::kw_only(), nb::arg("machine") = "", nb::arg("errors") = "", nb::arg("truth") = "",
      nb::arg("poses") = 1000, nb::arg("seed") = nb::none(), nb::arg("ranges") = AxisRanges{},
      nb::arg("least_reduction") = nb::none(), nb::arg("largest_ratio") = nb::none(), nb::arg("pieces") = RunPieces{},
      nb::arg("reach_mm") = 1.0, nb::arg("progress") = nb::none(),
      "The same for files: a folder of results of a study with simulated readings, or names of files.\n\n"
      "What is empty is the file of that name in the results (machine.toml, errors.toml, truth.errors.toml). seed: "
      "else\n"
      "the one at which the results were validated, 1 without results.");
}

}  // namespace abbe::python
