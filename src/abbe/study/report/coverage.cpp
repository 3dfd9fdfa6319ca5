#include "abbe/study/report/coverage.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/identify/trust/prediction.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/study/study_result.h"

namespace abbe {
namespace {

/// Mm and rad: less is rounding.
constexpr double kNoUncertainty = 1e-9;

std::string range_words(const Axis& axis, const PositionRange& range) {
  const double unit = position_unit(axis);
  return fmt::format("{:.8g} to {:.8g} {}", range.from / unit, range.to / unit, position_suffix(axis));
}

/// Largest expanded uncertainty (k = 2) of an error motion of an axis where it is stated beyond the readings.
struct EndUncertainty {
  double translation = 0;  ///< mm
  double rotation = 0;     ///< rad
};

EndUncertainty end_uncertainty(const StudyResult& result, const AxisCoverage& coverage) {
  const ErrorSet& errors = result.identification.errors;
  const Eigen::MatrixXd covariance = machine_covariance(result.identification, errors.parameter_count());
  EndUncertainty largest;
  const auto look_at = [&](double position) {
    // Several terms of one component add up, so that their correlations count.
    std::array<Eigen::VectorXd, kComponentCount> functional;
    functional.fill(Eigen::VectorXd::Zero(covariance.rows()));
    Eigen::Index first = 0;
    for (const ErrorMotion& motion : errors.motions) {
      const Eigen::Index size = static_cast<Eigen::Index>(motion.coefficients.size());
      if (motion.axis == coverage.axis && motion.state == kNoState) {
        Eigen::VectorXd functions(size);
        motion.basis.values(position, motion.coefficients, {functions.data(), motion.coefficients.size()});
        functional[static_cast<std::size_t>(motion.component)].segment(first, size) = functions;
      }
      first += size;
    }
    for (std::size_t c = 0; c < functional.size(); ++c) {
      const double u = std::sqrt(std::max(functional[c].dot(covariance * functional[c]), 0.0));
      double& value = is_rotation(static_cast<Component>(c)) ? largest.rotation : largest.translation;
      value = std::max(value, 2 * u);
    }
  };
  if (coverage.stated.from < coverage.measured.from) look_at(coverage.stated.from);
  if (coverage.stated.to > coverage.measured.to) look_at(coverage.stated.to);
  return largest;
}

}  // namespace

PositionRange stated_range(const Basis& wanted, const PositionRange& measured, double margin) {
  double reach = margin * (measured.to - measured.from);
  const bool has_intervals = wanted.kind == BasisKind::bspline || wanted.kind == BasisKind::table_linear;
  if (has_intervals) reach = std::min(reach, 0.5 * (wanted.to - wanted.from) / wanted.order);
  // A reading at the very margin stays within it whatever rounding does.
  reach *= 1 + 1e-12;
  return {measured.from - wanted.from <= reach ? wanted.from : measured.from,
          wanted.to - measured.to <= reach ? wanted.to : measured.to};
}

std::vector<std::string> coverage_sentences(const Study& study, const StudyResult& result) {
  std::vector<std::string> sentences;
  for (const AxisCoverage& coverage : result.model.coverage) {
    const Axis& axis = study.machine.axes[coverage.axis];
    if (coverage.is_extended()) {
      std::string text = fmt::format(
          "Error motions of {} were measured from {} and are stated for {}: the gap is within {:g} % of the measured "
          "range (coverage_margin_percent).",
          axis.name, range_words(axis, coverage.measured), range_words(axis, coverage.stated),
          study.identification->coverage_margin_percent);
      const EndUncertainty end = result.usable() ? end_uncertainty(result, coverage) : EndUncertainty{};
      // At a reference position they are zero by convention.
      if (end.translation > kNoUncertainty || end.rotation > kNoUncertainty) {
        text += fmt::format(" Their expanded uncertainty at the end of the range is at most {:.3g} um and {:.3g} urad.",
                            1e3 * end.translation, 1e6 * end.rotation);
      }
      sentences.push_back(text);
    }
    if (coverage.is_part()) {
      sentences.push_back(
          fmt::format("Error motions of {} are known from {} only, not over the whole of {}: nothing is stated where "
                      "nothing was measured.",
                      axis.name, range_words(axis, coverage.stated), range_words(axis, coverage.wanted)));
    }
  }
  return sentences;
}

std::string moved_range_sentence(const Axis& axis, const AxisRange& wanted, const AxisRange& known) {
  return fmt::format("The map was asked for {} from {} and runs from {}, where the errors are known.", axis.name,
                     range_words(axis, {wanted.from, wanted.to}), range_words(axis, {known.from, known.to}));
}

nlohmann::ordered_json coverage_json(const Study& study, const StudyResult& result) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const AxisCoverage& coverage : result.model.coverage) {
    const Axis& axis = study.machine.axes[coverage.axis];
    const double unit = position_unit(axis);
    const auto pair = [&](const PositionRange& range) {
      return nlohmann::ordered_json{range.from / unit, range.to / unit};
    };
    nlohmann::ordered_json entry;
    const std::string suffix = std::string("_") + position_suffix(axis);
    entry["axis"] = axis.name;
    entry["wanted" + suffix] = pair(coverage.wanted);
    entry["measured" + suffix] = pair(coverage.measured);
    entry["stated" + suffix] = pair(coverage.stated);
    if (coverage.is_extended()) {
      entry["margin_percent"] = study.identification->coverage_margin_percent;
      if (result.usable()) {
        const EndUncertainty end = end_uncertainty(result, coverage);
        entry["expanded_uncertainty_at_end_um"] = 1e3 * end.translation;
        entry["expanded_uncertainty_at_end_urad"] = 1e6 * end.rotation;
      }
    }
    list.push_back(entry);
  }
  return list;
}

}  // namespace abbe
