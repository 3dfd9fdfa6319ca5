#include "abbe/compensate/workpiece_errors.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "abbe/errors/expansion.h"

namespace abbe {
namespace {

constexpr double kAlongAxis = 1e-12;

/// Bodies between one rotary axis of the chain and the next; all vectors are parallel to the machine frame at zero.
struct ChainLink {
  std::size_t nearer = Machine::npos;  ///< rotary axis towards the workpiece; npos: the link begins on the workpiece
  std::size_t farther = Machine::npos;
  Eigen::Vector3d length = Eigen::Vector3d::Zero();  ///< from end to end with the axes at zero, mm
  std::vector<std::size_t> linear{};                 ///< axes within it
};

std::vector<ChainLink> links_of(const Machine& machine, const Eigen::Vector3d& fixed_point) {
  std::vector<ChainLink> links(1);
  Eigen::Vector3d from = machine.bed_from_workpiece * fixed_point;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    if (axis.kind == AxisKind::linear) {
      links.back().linear.push_back(i);
      continue;
    }
    links.back().farther = i;
    links.back().length = axis.point - from;
    from = axis.point;
    links.push_back({.nearer = i});
  }
  links.back().length = machine.tool_reference + machine.tool_offset - from;
  return links;
}

/// Error motions that displace the tool against the workpiece by the negative of every link.
class LinkErrors {
 public:
  explicit LinkErrors(const Machine& machine) : machine_(machine) {}

  void shorten(const ChainLink& link) {
    Eigen::Vector3d rest = link.length;
    for (const std::size_t i : link.linear) shorten_linear(i, rest);
    if (rest.isZero(0)) return;
    if (!link.linear.empty()) {
      move_linear(link.linear.front(), rest);
    } else if (is_on(link.nearer, ChainSide::workpiece)) {
      move_rotary(link.nearer, rest);  // the bearing of a table stands in this link
    } else if (is_on(link.farther, ChainSide::tool)) {
      move_rotary(link.farther, -rest);
    } else if (link.farther == Machine::npos) {
      errors_.tool_offset_error -= rest;
    } else {
      move_table(link.farther, rest);
    }
  }

  const ErrorSet& errors() const { return errors_; }

 private:
  bool is_on(std::size_t axis, ChainSide side) const {
    return axis != Machine::npos && machine_.axes[axis].side == side;
  }
  /// What displaces the body that an axis carries moves the tool against the workpiece by this sign.
  double side_sign(const Axis& axis) const { return axis.side == ChainSide::tool ? 1.0 : -1.0; }

  void add(std::size_t axis, Eigen::Index component, const Basis& basis, std::vector<double> coefficients) {
    errors_.motions.push_back({axis, static_cast<Component>(component), basis, std::move(coefficients), {}, kNoState});
  }

  /// The motion of a linear axis, and what of the rest of the link is along it.
  void shorten_linear(std::size_t i, Eigen::Vector3d& rest) {
    const Axis& axis = machine_.axes[i];
    for (Eigen::Index c = 0; c < 3; ++c) {
      const double along = axis.direction[c];
      if (along == 0) continue;
      double fixed = 0;
      if (std::abs(std::abs(along) - 1) < kAlongAxis) {
        fixed = -rest[c] / (side_sign(axis) * axis.sense() * along);
        rest[c] = 0;
      }
      const Basis basis = expansion_basis(axis, fixed);
      add(i, c, basis, {0, -axis.sense() * along * 0.5 * (basis.to - basis.from)});
    }
  }

  void move_linear(std::size_t i, const Eigen::Vector3d& rest) {
    const Axis& axis = machine_.axes[i];
    for (Eigen::Index c = 0; c < 3; ++c) {
      if (rest[c] != 0) add(i, c, expansion_basis(axis, 0), {-side_sign(axis) * rest[c], 0});
    }
  }

  static Basis over_a_turn() {
    Basis basis;
    basis.kind = BasisKind::fourier;
    basis.order = 1;
    basis.from = -std::numbers::pi;
    basis.to = std::numbers::pi;
    basis.period = 2 * std::numbers::pi;
    return basis;
  }

  void move_rotary(std::size_t i, const Eigen::Vector3d& by) {
    for (Eigen::Index c = 0; c < 3; ++c) {
      if (by[c] != 0) add(i, c, over_a_turn(), {by[c], 0, 0});
    }
  }

  /// A link that turns with the table which carries it: seen from its bearing it is a vector of the first harmonic.
  void move_table(std::size_t i, const Eigen::Vector3d& by) {
    const Axis& axis = machine_.axes[i];
    const Eigen::Vector3d& u = axis.direction;
    const Eigen::Vector3d along = by.dot(u) * u, across = by - along, turned = axis.sense() * u.cross(by);
    for (Eigen::Index c = 0; c < 3; ++c) {
      if (along[c] != 0 || across[c] != 0 || turned[c] != 0) {
        add(i, c, over_a_turn(), {along[c], across[c], turned[c]});
      }
    }
  }

  const Machine& machine_;
  ErrorSet errors_;
};

ErrorSet times(ErrorSet errors, double factor) {
  std::vector<double> values = errors.parameters();
  for (double& value : values) value *= factor;
  errors.set_parameters(values);
  return errors;
}

Eigen::Index motion_parameters(const ErrorSet& errors) {
  std::size_t count = 0;
  for (const ErrorMotion& motion : errors.motions) count += motion.coefficients.size();
  return static_cast<Eigen::Index>(count);
}

}  // namespace

WorkpieceErrors::WorkpieceErrors(const Machine& machine, const WorkpieceExpansion& expansion, double factor) {
  const double strain = expansion.coefficient * factor;
  shrinkage_ = strain / (1 + strain);
  uncertainty_ = std::sqrt(strain_variance(expansion, factor)) / ((1 + strain) * (1 + strain));
  LinkErrors links(machine);
  for (const ChainLink& link : links_of(machine, expansion.fixed_point)) links.shorten(link);
  of_unit_ = links.errors();
}

ErrorSet WorkpieceErrors::with(const ErrorSet& errors) const {
  ErrorSet result = errors;
  const ErrorSet own = times(of_unit_, shrinkage_);
  result.motions.insert(result.motions.end(), own.motions.begin(), own.motions.end());
  result.tool_offset_error += own.tool_offset_error;
  return result;
}

Eigen::MatrixXd WorkpieceErrors::covariance_with(const ErrorSet& errors, const Eigen::MatrixXd& covariance,
                                                 const std::array<double, 3>& tool_length) const {
  if (covariance.size() == 0 && uncertainty_ == 0) return {};
  const auto before = static_cast<Eigen::Index>(errors.parameter_count());
  const Eigen::Index first = motion_parameters(errors), own = motion_parameters(of_unit_), after = before + own;
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(after, after);
  const auto place = [&](Eigen::Index p) { return p < first ? p : p + own; };
  if (covariance.size() > 0) {
    for (Eigen::Index i = 0; i < before; ++i) {
      for (Eigen::Index j = 0; j < before; ++j) result(place(i), place(j)) = covariance(i, j);
    }
  }
  const std::vector<double> of_unit = of_unit_.parameters();
  Eigen::VectorXd by_shrinkage = Eigen::VectorXd::Zero(after);
  for (Eigen::Index k = 0; k < own; ++k) by_shrinkage[first + k] = of_unit[static_cast<std::size_t>(k)];
  const Eigen::Vector3d longer(tool_length[0], tool_length[1], tool_length[2]);
  by_shrinkage.tail<3>() = of_unit_.tool_offset_error + longer;
  result += uncertainty_ * uncertainty_ * by_shrinkage * by_shrinkage.transpose();
  return result;
}

}  // namespace abbe
