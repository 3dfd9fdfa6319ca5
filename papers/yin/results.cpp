#include "yin/results.h"

#include <fmt/format.h>

namespace abbe {
namespace {

constexpr double kYinAgreement = 1e-9;  // mm

}  // namespace

void judge(YinResults& r) {
  r.failures.clear();
  const auto failed = [&](const std::string& what, const std::string& why) {
    r.failures.push_back(why.empty() ? what : what + ": " + why);
  };
  for (const YinSteps* const steps : {&r.table_moves, &r.head_moves}) {
    if (steps->found.status == LinkageStatus::ok) continue;
    failed(steps == &r.table_moves ? "five steps, U" : "five steps, P", steps->found.reason);
  }
  if (!r.joint.converged) failed("joint fit of marks", r.joint.message);
  if (!r.positioning.failure.empty()) failed("positioning from the reference's scans", r.positioning.failure);
  if (!r.located.positioning.failure.empty()) failed("simulated scanner", r.located.positioning.failure);
  for (std::size_t i = 0; i < r.sections.fits.size(); ++i) {
    const EdgeFit& fit = r.sections.fits[i];
    if (fit.status != EdgeStatus::ok) failed("edge of section " + r.sections.sections[i].name, fit.reason);
  }
  r.agrees = r.failures.empty();
  for (const double difference :
       {r.table_moves.largest_difference, r.head_moves.largest_difference, r.positioning.largest_difference}) {
    r.agrees = r.agrees && difference < kYinAgreement;  // what is no number does not agree
  }
}

YinResults yin_results(std::uint64_t seed) {
  YinResults r;
  r.table_moves = yin_steps(LinkageConvention::table_moves);
  r.head_moves = yin_steps(LinkageConvention::head_moves);
  r.equations = yin_equations();
  r.joint = yin_joint_fit(r.table_moves.found);
  r.positioning = yin_positioning();
  r.scans = yin_simulated_scans(seed);
  r.located = yin_locate(r.scans);
  if (r.positioning.failure.empty()) {
    r.commands = yin_axis_commands(r.positioning);
    BudgetOptions options;
    options.seed = seed;
    r.contour = yin_contour(r.positioning, options);
    r.sections = yin_sections(r.positioning, seed);
  }
  judge(r);
  return r;
}

}  // namespace abbe
