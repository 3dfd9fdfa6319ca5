#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "papers.h"
#include "wang/grids.h"
#include "wang/results.h"

namespace abbe {
namespace {

std::vector<std::string> wang_conclusions(const WangResults& r) {
  std::vector<std::string> lines;
  for (const auto& row : wang_conclusion_rows(r.conclusions)) {
    lines.push_back(fmt::format("{}: the paper says {}; here {}. Confirmed: {}.", row[0], row[1], row[2], row[3]));
  }
  const double displacements = r.displacements.machine.norm();
  lines.push_back(
      fmt::format("With z = +0.0030 mm in (45), |E| by the displacements only is {:.2f} um at the zero pose. The paper "
                  "says that the ball bar agrees with it at 0.1 mm, which is {:.0f} times as much.",
                  1e3 * displacements, 0.1 / displacements));
  return lines;
}

std::vector<std::string> wang_corrections(const WangMeanColumn& mean) {
  return {
      "(36) to (39) mix displacements of i = 1 with angles of column 12; (40), (41), (43) have wrong signs or digits.",
      "(42) has the product T_X T_Z only, and 193.93746 is a slip for 199.93746; (44) does not add up; z in (45) is "
      "+0.0030 mm.",
      fmt::format(
          "Column 12 of Tables A1 to A6 is not a measurement: in {} of the {} rows that vary it is the mean of columns "
          "1 to 11 with the further digits cut off.",
          mean.equal, mean.rows),
      "The angles are probably 1000 times too large, as if the arctangent had been taken of um over mm. This is "
      "inferred, not proven, so both readings are shown.",
      "The strokes stated for A and B are interchanged, as Tables A4 and A5 show.",
      "(13) lacks T_B. (32) does not follow from the chain X Z A Y B; the term -200 cos(gamma) in (33) and (35) is "
      "spurious.",
      "(5) and (8) keep the zero of the dial and the misalignment of the face. (7) and (10) are constants of the "
      "misalignment, not pitch and yaw. (6) and (9) have opposite signs, so that (11) cancels the roll."};
}

Reproduction wang_reproduction(int threads) {
  WangResults r = wang_results(threads);
  Reproduction made;
  made.paper = "wang";
  made.citation = "Wang, Ran, Zhang, Li (2020), Applied Sciences 10, 2164";
  made.title = "36 measured errors of a gear grinder: integrated error, decoupling of dial readings";
  made.facts = {
      {"machine", wang_machine().chain() + ", tool at (200, 0, 0), workpiece point (0, 0, 400) mm"},
      {"integrated error",
       "E = (W_actual - T_actual) - (W_nominal - T_nominal), equation (18), machine frame, with T_B in (13) and "
       "(16) and the matrices of the tables' row i instead of (36) to (43)"},
      {"order of errors and motion", "iso; the paper leaves it open"}};
  made.tables = wang_tables(r);
  made.published = wang_published(r);
  made.figures = wang_point_plots(r.points);
  for (EvaluationPlot& plot : wang_ball_bar_plots(r.dials.ball_bar)) made.figures.push_back(std::move(plot));
  made.conclusions = wang_conclusions(r);
  made.corrections = wang_corrections(r.mean_column);
  made.agrees = r.agrees;
  made.details = wang_details(r);
  made.page = wang_page(r);
  made.write_study = [r = std::move(r)](ResultsFolder& folder) { write_wang_study(r, folder); };
  return made;
}

}  // namespace

int reproduce_wang(const ReproduceOptions& options) {
  if (!options.grids.empty()) return decouple_wang_grids(options);
  return run_reproduction(options, [&] { return wang_reproduction(options.threads); });
}

}  // namespace abbe
