#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "abbe/geometry/angle_units.h"
#include "liu/results.h"

namespace abbe {
namespace {

std::string clamping_words(const LiuClampingStudy& s) {
  const LiuClampingErrors &steps = s.spread.steps.deviation, &joint = s.spread.joint.deviation;
  double low = 1e9, high = 0, apart = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const double ratio = steps[i] / s.noisy.clamping.uncertainty[i];
    low = std::min(low, ratio);
    high = std::max(high, ratio);
    apart = std::max(apart, std::abs(joint[i] / s.joint.uncertainty[i] - 1));
  }
  return fmt::format(
      "Clamping: from exact readings all four errors are found; with the noise of Table 2 they spread by {:.1f} and "
      "{:.1f} arcsec, {:.2f} and {:.2f} um over {} campaigns, {:.1f} to {:.1f} times what the last step states, since "
      "it takes the calibrated axes for exact. One joint fit of the same readings spreads by {:.1f} and {:.1f} arcsec, "
      "{:.2f} and {:.2f} um, which differs from what it states by at most {:.0f} %.",
      steps[0] / kArcsec, steps[1] / kArcsec, 1e3 * steps[2], 1e3 * steps[3], s.spread.steps.campaigns, low, high,
      joint[0] / kArcsec, joint[1] / kArcsec, 1e3 * joint[2], 1e3 * joint[3], 100 * apart);
}

std::string taper_words(const LiuClampingStudy& s) {
  const LiuClampingCalibration& clamping = s.tapered.clamping;
  double left = 0;
  for (std::size_t q = 0; q < kLiuQuarters; ++q) left = std::max(left, largest_magnitude(clamping.places.remaining(q)));
  return fmt::format(
      "A standard with 14 um of taper puts the tilt of the clamping about x wrong by {:.0f} arcsec while {:.1f} um are "
      "left at most in its calibration: what is left does not show it.",
      std::abs(clamping.found[0] - s.truth[0]) / kArcsec, 1e3 * left);
}

std::string shape_words(const LiuFigureStudy& study) {
  const auto words = [](const LiuProfile& p) {
    return fmt::format("lean {:.3f} degrees, radius changes by {:.1f} um from bottom to top", p.lean / kDegree,
                       23.5e3 * p.growth);
  };
  const LiuProfile &stages = study.corrected[0], &clamping = study.corrected[2];
  const bool stages_cone = std::abs(stages.growth) > stages.lean,
             clamping_oblique = clamping.lean > std::abs(clamping.growth);
  return fmt::format(
      "Figure 9: the paper has, in this order, an oblique cylinder from the static errors of the stages and a frustum "
      "of a cone from clamping errors. Here the static errors make {} ({}; cylinder on the true axis of C) and the "
      "clamping errors {} ({}){}.",
      stages_cone ? "the cone" : "the oblique cylinder", words(stages),
      clamping_oblique ? "the oblique cylinder" : "the cone", words(clamping),
      stages_cone && clamping_oblique ? ": the other way round" : "");
}

std::string repeat_words(const LiuFigureStudy& study) {
  const LiuRepeats &taper = study.repeats[1], &lobes = study.repeats[2];
  return fmt::format(
      "Figure 11b: the paper calls its four distributions basically the same. The random deviations of Table 2 alone "
      "do not make them so: the repeatability is {:.2f} um, and the correlation of the runs is {:.2f}, or {:.2f} with "
      "a taper. With three lobes of 14 um peak to valley it is {:.2f}. Something that repeats is needed; which form or "
      "motion it was cannot be told from the paper. A form within 14 um alone cannot reach its 12.42 um about the best "
      "cylinder, as no root mean square exceeds half of the peak-to-valley value.",
      1e3 * study.repeats[0].repeatability, study.repeats[0].correlation, taper.correlation, lobes.correlation);
}

}  // namespace

double liu_exact_remainder(const LiuFigureStudy& study, bool stages) {
  double largest = 0;
  for (const LiuClampingStudy& s : study.clampings) {
    for (std::size_t q = 0; q < kLiuQuarters; ++q) {
      if (stages) {
        largest = std::max({largest, largest_magnitude(s.exact.a.places.remaining(q)),
                            largest_magnitude(s.exact.c.places.remaining(q))});
      } else {
        largest = std::max(largest, largest_magnitude(s.exact.clamping.places.remaining(q)));
      }
    }
  }
  return largest;
}

std::vector<PublishedNumber> liu_published(const LiuResults& r) {
  std::vector<PublishedNumber> numbers;
  for (const LiuGroup& g : r.sensitivity.groups) {
    numbers.push_back({"Table 1, " + g.name, "%", g.paper, g.stated, "stated ranges, not registered", 3});
  }
  const LiuFigureStudy& study = r.figures;
  if (study.complete()) {
    const LiuClampingStudy& s = study.micrometres();
    const auto unread = [&](const char* where, const char* unit, double here, const char* note, int decimals) {
      numbers.push_back({where, unit, {}, here, note, decimals});
    };
    unread("Figure 4b, shift of 0.1 mm", "um", 1e3 * study.clamped[0].deviation, "largest deviation; the paper: large",
           1);
    unread("Figure 4b, tilt of 1 degree", "um", 1e3 * study.clamped[2].deviation, "the same, 10 mm above the middle",
           1);
    numbers.push_back({"Figure 7, largest distance", "nm", 10.0, 1e6 * liu_exact_remainder(study, true),
                       "the paper states a limit; exact readings, both stages", 3});
    numbers.push_back({"Figure 8, largest error", "nm", 1.0, 1e6 * liu_exact_remainder(study, false),
                       "the paper states a limit; exact readings", 3});
    constexpr const char* kNames[] = {"tilt 1", "tilt 2", "shift x", "shift z"};
    for (std::size_t i = 0; i < 4; ++i) {
      numbers.push_back({fmt::format("Table 3, workholding, {}", kNames[i]), i < 2 ? "deg" : "um",
                         kLiuTable3Clamping[i], s.noisy.clamping.found[i] / (i < 2 ? kDegree : 1e-3),
                         "set in the simulation, found with the noise of Table 2", 4});
    }
  }
  for (const LiuMeasuredPart& p : r.units.back().parts) {
    const LiuMeasurement& m = p.measurement;
    if (p.paper_before > 0) {
      numbers.push_back({"5.2, " + m.part + ", before", "um", p.paper_before, 1e3 * m.before.rms, "shifts in um"});
    }
    if (p.paper_after > 0) {
      numbers.push_back({"5.2, " + m.part + ", after", "um", p.paper_after, 1e3 * m.after.rms, "shifts in um"});
    }
  }
  numbers.push_back({"5.2, sphere 50 % by a CMM", "um", 26.51, {}, "nothing is known of the CMM"});
  numbers.push_back({"5.2, fitted radius of the sphere", "mm", 12.682,
                     r.variants.back().spheres.back().after.fitted_radius,
                     "standard cylinder 21 um larger than assumed", 4});
  if (study.complete()) {
    numbers.push_back({"Figure 11b, correlation of four runs",
                       "",
                       {},
                       study.repeats[0].correlation,
                       "noise of Table 2 alone; the paper: basically the same",
                       2});
  }
  return numbers;
}

std::vector<EvaluationFigure> liu_headline(const LiuFigureStudy& study) {
  if (!study.complete()) return {};
  constexpr const char* kSymbols[] = {"tilt_x", "tilt_z", "shift_x", "shift_z"};
  constexpr const char* kWords[] = {"tilt of the clamping about x", "tilt of the clamping about z",
                                    "shift of the clamping along x", "shift of the clamping along z"};
  const LiuClampingStudy& s = study.micrometres();
  std::vector<EvaluationFigure> figures;
  for (std::size_t i = 0; i < 4; ++i) {
    EvaluationFigure figure;
    figure.symbol = kSymbols[i];
    figure.name = std::string(kWords[i]) + ", found with the noise of Table 2";
    figure.quantity = i < 2 ? Quantity::angle : Quantity::length;
    figure.unit = i < 2 ? "deg" : "um";
    figure.decimals = i < 2 ? 4 : 3;
    figure.value = s.noisy.clamping.found[i];
    figure.uncertainty = 2 * s.spread.steps.deviation[i];
    figures.push_back(figure);
  }
  return figures;
}

std::vector<std::string> liu_conclusions(const LiuResults& r) {
  std::vector<std::string> words;
  const LiuFigureStudy& study = r.figures;
  if (study.complete()) {
    words = {
        fmt::format(
            "Figure 4b: small clamping errors make large deviations, as the paper says: {:.0f} um from a shift of 0.1 "
            "mm. They come from the place of the part more than from its form: the section stays round after a shift, "
            "and with the tilts of Table 3 it is an ellipse, {:.1f} um out of round of {:.0f} um.",
            1e3 * study.clamped[0].deviation, 1e3 * study.clamped[4].out_of_round, 1e3 * study.clamped[4].deviation),
        clamping_words(study.micrometres()), taper_words(study.micrometres()), shape_words(study), repeat_words(study)};
  }
  words.emplace_back(
      "Table 1's ratios do not follow from the stated ranges: a tilt of up to 5 degrees outweighs everything. After "
      "registration clamping errors are gone, and what matters are the axis average lines of the stages.");
  words.push_back(fmt::format(
      "The paper's fitted radius of the sphere is 21 um short, as it would be with a standard cylinder 21 um larger "
      "than assumed: the fitted radius is then {:.4f} mm here, and the deviations grow with the share of the sphere.",
      r.variants.back().spheres.back().after.fitted_radius));
  double here = 0, paper_least = std::numeric_limits<double>::infinity(), paper_most = 0;  // um
  for (const LiuMeasuredPart& p : r.units.back().parts) {
    here = std::max(here, 1e3 * p.measurement.after.rms);
    if (!(p.paper_after > 0)) continue;
    paper_least = std::min(paper_least, p.paper_after);
    paper_most = std::max(paper_most, p.paper_after);
  }
  words.push_back(
      fmt::format("With the stages and the probe of Table 2 alone at most {:.1f} um remain of a part, in the "
                  "paper {} to {} um{}.",
                  here, paper_least, paper_most, here < paper_least ? ": Tables 2 and 3 do not explain them" : ""));
  words.emplace_back(
      "The paper publishes no data, and its text gives no numbers with Figures 4b, 6, 9 and 11b. They are compared "
      "with its words; the curves were not read off the pictures. Figures 7 and 8 are compared with the limits that "
      "it states.");
  return words;
}

std::vector<std::string> liu_corrections() {
  return {
      "(6) the sign of h m; (7) O is 3 x 1, the increment's weight 0; (10) the middle entry of row 3 is z_y'.",
      "(8), (9) as worded are centimetres off; the right form is R_C R_A with negative increments and A where C has "
      "brought it.",
      "(13) is a plane; the distance in (14) is |(M - N1) x (N2 - N1)| / |N2 - N1|.",
      "(15) is a sum of magnitudes, not least squares; (16) is a root mean square about zero.",
      "Table 3: the unit of the shifts is doubtful; the deviation before compensation agrees with micrometres."};
}

}  // namespace abbe
