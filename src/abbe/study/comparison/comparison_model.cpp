#include "abbe/study/comparison/comparison_model.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "abbe/geometry/decompositions.h"
#include "abbe/identify/parameter_words.h"
#include "abbe/machine/coupling.h"
#include "abbe/verify/known_range.h"

namespace abbe {
namespace {

using Index = Eigen::Index;

// A part of a function below this share of it is rounding.
constexpr double kRoundingOfFunctions = 1e-9;

/// Terms of one error motion in a file, and where their coefficients are among its parameters.
struct TermsOfFile {
  std::vector<ErrorMotion> terms;
  std::vector<Index> parameters;

  Index size() const { return static_cast<Index>(parameters.size()); }
};

TermsOfFile terms_of_file(const ErrorSet& errors, std::size_t axis, Component component, std::size_t state) {
  TermsOfFile found;
  Index next = 0;
  for (const ErrorMotion& motion : errors.motions) {
    const Index size = static_cast<Index>(motion.coefficients.size());
    if (motion.axis == axis && motion.component == component && motion.state == state) {
      found.terms.push_back(motion);
      for (Index k = 0; k < size; ++k) found.parameters.push_back(next + k);
    }
    next += size;
  }
  return found;
}

bool is_known_everywhere(const Basis& basis) {
  if (basis.periodic) return true;
  return basis.kind == BasisKind::fourier && basis.to - basis.from >= basis.period * (1 - 1e-9);
}

/// Functions of the same kind over another range within their own. For polynomials, harmonics and straight lines
/// between nodes they are the same functions.
Basis over_range(Basis basis, double from, double to) {
  if (basis.kind == BasisKind::table_monotone) basis.kind = BasisKind::table_linear;
  if (is_known_everywhere(basis) || (basis.from == from && basis.to == to)) return basis;
  if (basis.kind == BasisKind::table_linear) {
    std::vector<double> nodes = {from};
    const double near = 1e-9 * (to - from);
    for (const double node : basis.nodes) {
      if (node > from + near && node < to - near) nodes.push_back(node);
    }
    nodes.push_back(to);
    basis.nodes = nodes;
  } else if (basis.kind == BasisKind::bspline) {
    const double intervals = basis.order * (to - from) / (basis.to - basis.from);
    basis.order = std::max(1, static_cast<int>(std::ceil(intervals - 1e-9)));
  }
  basis.from = from;
  basis.to = to;
  return basis;
}

bool same_functions(const std::vector<ErrorMotion>& a, const std::vector<ErrorMotion>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const ErrorMotion& x, const ErrorMotion& y) { return x.basis == y.basis; });
}

double largest_amount(const Eigen::VectorXd& values) { return values.size() > 0 ? values.cwiseAbs().maxCoeff() : 0; }

/// Fills the model from two files.
class ModelBuilder {
 public:
  ModelBuilder(const Machine& machine, const IdentifiedCampaign& first, const IdentifiedCampaign& second)
      : files_{&first.errors, &second.errors} {
    model_.machine = machine;
    model_.errors.composition = first.errors.errors.composition;
    model_.tools_differ = (first.machine.tool_offset - second.machine.tool_offset).norm() > kSameGeometry ||
                          (first.machine.tool_reference - second.machine.tool_reference).norm() > kSameGeometry;
  }

  ComparisonModel build() {
    add_motions();
    add_constants();
    for (std::size_t c = 0; c < 2; ++c) fill(c);
    return std::move(model_);
  }

 private:
  /// Rows of the linear map from the parameters of each file to those of the model.
  struct Rows {
    Index first = 0;
    std::array<std::vector<Index>, 2> columns;
    std::array<Eigen::MatrixXd, 2> map;  // [rows, columns]
  };

  const ErrorSet& errors(std::size_t c) const { return files_[c]->errors; }

  void add_motions() {
    for (std::size_t c = 0; c < 2; ++c) {
      for (const ErrorMotion& motion : errors(c).motions) {
        const bool seen = std::any_of(model_.list.begin(), model_.list.end(), [&](const ModelledError& one) {
          return one.axis == motion.axis && one.component == motion.component && one.state == motion.state;
        });
        if (!seen) add_motion(motion.axis, motion.component, motion.state);
      }
    }
  }

  void add_motion(std::size_t axis, Component component, std::size_t state) {
    const std::array<TermsOfFile, 2> of = {terms_of_file(errors(0), axis, component, state),
                                           terms_of_file(errors(1), axis, component, state)};
    ErrorSet both;
    for (const TermsOfFile& one : of) both.motions.insert(both.motions.end(), one.terms.begin(), one.terms.end());
    AxisRange range = full_ranges(model_.machine, 2)[axis];
    if (is_coupled(model_.machine, axis) && !model_.machine.axes[axis].endless) {
      const PositionLimits limits = position_limits(model_.machine, axis);
      range.from = limits.from;
      range.to = limits.to;
    }
    const double travel = range.to - range.from;
    narrow_to_known_positions(both, axis, range);
    if (!(range.to - range.from > 1e-9 * travel)) {
      const std::string name = error_motion_name(model_.machine, axis, component, state);
      if (std::find(model_.apart.begin(), model_.apart.end(), name) == model_.apart.end()) model_.apart.push_back(name);
      return;
    }
    ModelledError error{
        .kind = ModelledError::Kind::motion, .axis = axis, .component = component, .state = state, .first = next_};
    error.is_in = {!of[0].terms.empty(), !of[1].terms.empty()};
    error.from = range.from;
    error.to = range.to;
    const bool takes_second = !error.is_in[0] || (error.is_in[1] && of[1].size() < of[0].size());
    std::vector<ErrorMotion> terms = (takes_second ? of[1] : of[0]).terms;
    std::size_t functions = 0;
    for (ErrorMotion& term : terms) {
      term.basis = over_range(term.basis, range.from, range.to);
      term.coefficients.assign(term.basis.size(), 0);
      term.standard_uncertainty.clear();
      functions += term.basis.size();
    }
    error.size = static_cast<Index>(functions);
    // In the middle of equal parts: sums over them are integrals over the range, nearly.
    const std::size_t parts = 16 * functions + 64;
    const double half = (range.to - range.from) / static_cast<double>(2 * parts);
    const std::vector<double> positions = evenly_spaced(range.from + half, range.to - half, parts);
    const std::vector<double> places = evenly_spaced(range.from, range.to, parts);
    const Eigen::MatrixXd sampled = sampled_functions(terms, positions);
    const Eigen::MatrixXd shown = sampled_functions(terms, places);
    Rows rows{.first = next_, .columns = {}, .map = {}};
    for (std::size_t c = 0; c < 2; ++c) {
      if (!error.is_in[c]) continue;
      rows.columns[c] = of[c].parameters;
      if (same_functions(of[c].terms, terms)) {
        rows.map[c] = Eigen::MatrixXd::Identity(error.size, error.size);
        continue;
      }
      rows.map[c] = CompleteOrthogonal(sampled).solve_columns(sampled_functions(of[c].terms, positions));
      Eigen::VectorXd coefficients(of[c].size());
      Index k = 0;
      for (const ErrorMotion& term : of[c].terms) {
        for (const double value : term.coefficients) coefficients[k++] = value;
      }
      const Eigen::VectorXd function = sampled_functions(of[c].terms, places) * coefficients;
      const double left = largest_amount(function - shown * (rows.map[c] * coefficients));
      if (left > kRoundingOfFunctions * largest_amount(function)) error.beyond[c] = left;
    }
    model_.errors.motions.insert(model_.errors.motions.end(), terms.begin(), terms.end());
    add(error, std::move(rows));
  }

  void add(const ModelledError& error, Rows rows) {
    model_.list.push_back(error);
    rows_.push_back(std::move(rows));
    next_ += error.size;
  }

  /// An error of one parameter. @param at  where it is among the parameters of the files that have it
  void add_single(ModelledError error, const std::array<std::optional<Index>, 2>& at) {
    error.first = next_;
    Rows rows{.first = next_, .columns = {}, .map = {}};
    for (std::size_t c = 0; c < 2; ++c) {
      error.is_in[c] = at[c].has_value();
      if (!at[c]) continue;
      rows.columns[c] = {*at[c]};
      rows.map[c] = Eigen::MatrixXd::Identity(1, 1);
    }
    add(error, std::move(rows));
  }

  /// Index of the first parameter behind the error motions.
  static Index behind_motions(const ErrorSet& errors) {
    Index count = 0;
    for (const ErrorMotion& motion : errors.motions) count += static_cast<Index>(motion.coefficients.size());
    return count;
  }

  std::optional<Index> location_at(std::size_t c, const LocationError& wanted) const {
    const std::vector<LocationError>& all = errors(c).locations;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].axis == wanted.axis && all[i].component == wanted.component && all[i].state == wanted.state) {
        return behind_motions(errors(c)) + static_cast<Index>(i);
      }
    }
    return {};
  }

  std::optional<Index> reversal_at(std::size_t c, const Reversal& wanted) const {
    const std::vector<Reversal>& all = errors(c).reversals;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].axis == wanted.axis) {
        return behind_motions(errors(c)) + static_cast<Index>(errors(c).locations.size() + i);
      }
    }
    return {};
  }

  void add_constants() {
    for (std::size_t c = 0; c < 2; ++c) {
      for (const LocationError& location : errors(c).locations) {
        if (c == 1 && location_at(0, location)) continue;
        const ModelledError error{.kind = ModelledError::Kind::location,
                                  .axis = location.axis,
                                  .component = location.component,
                                  .state = location.state};
        add_single(error, {location_at(0, location), location_at(1, location)});
        model_.errors.locations.push_back(
            {.axis = location.axis, .component = location.component, .state = location.state});
      }
    }
    for (std::size_t c = 0; c < 2; ++c) {
      for (const Reversal& reversal : errors(c).reversals) {
        if (c == 1 && reversal_at(0, reversal)) continue;
        const ModelledError error{.kind = ModelledError::Kind::reversal, .axis = reversal.axis};
        add_single(error, {reversal_at(0, reversal), reversal_at(1, reversal)});
        model_.errors.reversals.push_back({.axis = reversal.axis});
      }
    }
    Rows rows{.first = next_, .columns = {}, .map = {}};
    for (std::size_t c = 0; c < 2; ++c) {
      const Index at = static_cast<Index>(errors(c).parameter_count()) - 3;
      rows.columns[c] = {at, at + 1, at + 2};
      rows.map[c] = model_.tools_differ ? Eigen::MatrixXd(Eigen::MatrixXd::Zero(3, 3))
                                        : Eigen::MatrixXd(Eigen::MatrixXd::Identity(3, 3));
    }
    add({.kind = ModelledError::Kind::tool_offset, .first = next_, .size = 3, .is_in = {true, true}}, std::move(rows));
  }

  void fill(std::size_t c) {
    const std::vector<double> parameters = errors(c).parameters();
    const Index p = static_cast<Index>(parameters.size());
    const Eigen::Map<const Eigen::VectorXd> values(parameters.data(), p);
    Eigen::MatrixXd map = Eigen::MatrixXd::Zero(next_, p);
    for (const Rows& rows : rows_) {
      for (std::size_t k = 0; k < rows.columns[c].size(); ++k) {
        map.col(rows.columns[c][k]).segment(rows.first, rows.map[c].rows()) = rows.map[c].col(static_cast<Index>(k));
      }
    }
    CampaignInModel& campaign = model_.campaigns[c];
    campaign.values = map * values;
    const Eigen::MatrixXd covariance = covariance_of(*files_[c]);
    if (covariance.size() > 0) campaign.covariance = map * covariance * map.transpose();
  }

  std::array<const ErrorsFile*, 2> files_;
  ComparisonModel model_;
  std::vector<Rows> rows_;
  Index next_ = 0;
};

}  // namespace

bool ModelledError::is_angle(const Machine& machine) const {
  switch (kind) {
    case Kind::motion:
    case Kind::location:
      return is_rotation(component);
    case Kind::reversal:
      return machine.axes[axis].kind == AxisKind::rotary;
    case Kind::tool_offset:
      break;
  }
  return false;
}

std::string ModelledError::name(const Machine& machine) const {
  switch (kind) {
    case Kind::motion:
      return error_motion_name(machine, axis, component, state);
    case Kind::location:
      return location_error_name(machine, axis, component, state);
    case Kind::reversal:
      return reversal_name(machine, axis);
    case Kind::tool_offset:
      break;
  }
  return "tool_offset";
}

std::string ModelledError::words(const Machine& machine) const {
  switch (kind) {
    case Kind::motion:
    case Kind::location:
      return error_words(machine, axis, component, kind == Kind::location) +
             (state == kNoState ? std::string() : " with " + machine.states[state].name);
    case Kind::reversal:
      return "reversal value of " + machine.axes[axis].name;
    case Kind::tool_offset:
      break;
  }
  return "error of the tool offset";
}

std::vector<ErrorMotion> ComparisonModel::terms(const ModelledError& error) const {
  return terms_of_file(errors, error.axis, error.component, error.state).terms;
}

std::vector<double> as_list(const Eigen::VectorXd& values) { return {values.data(), values.data() + values.size()}; }

Eigen::MatrixXd sampled_functions(const std::vector<ErrorMotion>& terms, const std::vector<double>& positions) {
  std::size_t functions = 0;
  for (const ErrorMotion& term : terms) functions += term.basis.size();
  Eigen::MatrixXd sampled(static_cast<Index>(positions.size()), static_cast<Index>(functions));
  std::vector<double> row;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    Index column = 0;
    for (const ErrorMotion& term : terms) {
      row.assign(term.basis.size(), 0.0);
      term.basis.values(positions[i], term.coefficients, row);
      for (const double value : row) sampled(static_cast<Index>(i), column++) = value;
    }
  }
  return sampled;
}

ComparisonModel comparison_model(const Machine& machine, const IdentifiedCampaign& first,
                                 const IdentifiedCampaign& second) {
  return ModelBuilder(machine, first, second).build();
}

}  // namespace abbe
