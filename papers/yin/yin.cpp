#include <fmt/format.h>

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "abbe/formats/files/results_folder.h"
#include "papers.h"
#include "yin/constants.h"
#include "yin/results.h"

namespace abbe {
namespace {

/// The edge that the sections have found, as points in the frame of the workpiece.
std::string engraved_csv(const YinSections& sections) {
  const std::vector<YinPoint> curve = yin_curve();
  std::string text = "x_mm,y_mm,z_mm\n";
  for (std::size_t i = 0; i < sections.fits.size(); ++i) {
    if (sections.fits[i].status != EdgeStatus::ok) continue;
    const YinPoint& at = curve[i];
    const Eigen::Vector3d p = at.point + sections.fits[i].corner.x() * at.normal.cross(at.tangent);
    text += fmt::format("{:.6f},{:.6f},{:.6f}\n", p.x(), p.y(), p.z());
  }
  return text;
}

std::vector<std::string> yin_corrections(const std::vector<YinEquation>& equations) {
  std::vector<std::string> lines;
  for (const YinEquation& e : equations) {
    if (!e.is_right) lines.push_back(fmt::format("{} is printed as {}. Right: {}.", e.number, e.printed, e.right));
  }
  for (const char* line :
       {"(9) has + h, right: R_A = |z2 - z1| + d - h. Step 3 takes 2 L_tA for L_tA.",
        "(10) and (11) lose the signs of the distances. (12) holds in convention U and not with (5) as printed.",
        "(13), (14): the cross product of two directions that are not orthogonal is not a unit vector, and the "
        "transpose is not the inverse. (15) takes its direction from the heights of two targets and fails where they "
        "are equal.",
        "(17): t_z = z_p - z_sR. (18): t_x = x0 - x1 - x_sR, and t_y likewise. (19) is [R T; 0 1].",
        "Step 5: D_B^W = D_M^W (D_M^B)^-1."}) {
    lines.emplace_back(line);
  }
  return lines;
}

/// How a measured error compares with the expected one; within a quarter they are about the same.
const char* yin_size_words(double measured, double expected) {
  constexpr double kAbout = 1.25;
  if (measured > kAbout * expected) return "larger than";
  return measured * kAbout < expected ? "smaller than" : "about";
}

std::vector<std::string> yin_conclusions(const YinResults& r) {
  std::vector<std::string> lines;
  if (r.joint.converged) {
    lines.push_back(fmt::format(
        "One fit of marks at many poses determines the linkage {} than the five steps: the standard uncertainty of the "
        "focus is {:.1f} instead of {:.1f} um.",
        r.joint.focus < r.joint.focus_by_steps ? "better" : "no better", 1e3 * r.joint.focus,
        1e3 * r.joint.focus_by_steps));
  }
  if (!r.positioning.failure.empty()) return lines;
  const YinContour& c = r.contour;
  lines.push_back(
      fmt::format("The contour error of the paper (mean {:.1f} um, largest {:.1f} um) is {} what Table 1 and the "
                  "instruments lead one to expect: {:.1f} and {:.1f} um. The largest contribution, {:.0f} % of the "
                  "variance, is the {}.",
                  kYinMeasured.mean, kYinMeasured.largest, yin_size_words(kYinMeasured.mean, c.across.mean),
                  c.across.mean, c.across.largest, 100 * c.budget.lines.front().share, c.budget.lines.front().cause));
  lines.push_back(fmt::format(
      "L_tA taken as printed, with everything else exact, makes a contour error of up to {:.0f} um.", c.printed_l_ta));
  lines.emplace_back(
      "P1 P2, which the paper calls the contour error, is the rounding of the edge and does not depend on where the "
      "edge is; the contour error is the distance of P2 from the commanded curve.");
  lines.push_back(
      fmt::format("The budgets by sensitivity coefficients and by Monte Carlo differ by at most {:.1f} standard "
                  "uncertainties of the latter.",
                  c.budget.largest_disagreement()));
  return lines;
}

void write_yin_study(const YinResults& r, ResultsFolder& folder) {
  const std::filesystem::path study = "study";
  const YinScanFiles files = yin_scan_files(r.scans, "scans.csv");
  folder.write(study / "scans.csv", files.points);
  folder.write(study / "scanner.positioning.toml", files.positioning);
  if (!r.positioning.failure.empty()) return;
  folder.write(study / "sections.csv", sections_csv(r.sections.sections));
  folder.write(study / "engraved.csv", engraved_csv(r.sections));
}

}  // namespace

Reproduction yin_reproduction(const YinResults& r) {
  Reproduction made;
  made.paper = "yin";
  made.citation = "Yin, Liu, Sun, Ding (2021), Machines 9, 237";
  made.title = "Multi-axis laser engraver: linkage, place of the workpiece, contour error";
  made.facts = {{"machine", "X, Y and C2 carry the workpiece, Z, C1 and A the head (convention U)"}};
  made.tables = yin_tables(r);
  made.published = yin_published(r);
  made.figures = yin_plots(r);
  made.headline = yin_headline(r);
  made.page = yin_page(r);
  made.conclusions = yin_conclusions(r);
  made.corrections = yin_corrections(r.equations);
  made.failures = r.failures;
  made.agrees = r.agrees;
  made.details = yin_details(r);
  made.write_study = [r](ResultsFolder& folder) { write_yin_study(r, folder); };
  return made;
}

int reproduce_yin(const ReproduceOptions& options) {
  return run_reproduction(options, [] { return yin_reproduction(yin_results(yin::kSeed)); });
}

}  // namespace abbe
