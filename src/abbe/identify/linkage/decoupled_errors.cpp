#include "abbe/identify/linkage/decoupled_errors.h"

#include <stdexcept>

namespace abbe {

DecoupledErrors decoupled_errors(const std::vector<DecoupledAxis>& axes) {
  DecoupledErrors result;
  for (const DecoupledAxis& entry : axes) {
    const Decoupling& found = entry.decoupling;
    if (found.status != DecouplingStatus::ok) throw std::invalid_argument("errors of an axis that was not decoupled");
    Basis basis{.kind = BasisKind::table_linear};
    basis.nodes = found.positions;
    basis.from = found.positions.front();
    basis.to = found.positions.back();
    for (std::size_t c = 0; c < kComponentCount; ++c) {
      if (!found.seen[c]) continue;
      ErrorMotion motion{entry.axis, static_cast<Component>(c), basis, {}, {}};
      for (std::size_t i = 0; i < found.positions.size(); ++i) {
        motion.coefficients.push_back(found.errors(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(c)));
        motion.standard_uncertainty.push_back(found.standard_uncertainty(motion.component, i));
      }
      result.errors.motions.push_back(std::move(motion));
    }
  }
  const Eigen::Index p = static_cast<Eigen::Index>(result.errors.parameter_count());
  result.covariance = Eigen::MatrixXd::Zero(p, p);
  Eigen::Index start = 0;
  for (const DecoupledAxis& entry : axes) {
    const Decoupling& found = entry.decoupling;
    const Eigen::Index m = static_cast<Eigen::Index>(found.positions.size());
    std::vector<Eigen::Index> seen;
    for (Eigen::Index c = 0; c < kComponentCount; ++c) {
      if (found.seen[static_cast<std::size_t>(c)]) seen.push_back(c);
    }
    for (std::size_t a = 0; a < seen.size(); ++a) {
      for (std::size_t b = 0; b < seen.size(); ++b) {
        result.covariance.block(start + static_cast<Eigen::Index>(a) * m, start + static_cast<Eigen::Index>(b) * m, m,
                                m) = found.covariance.block(seen[a] * m, seen[b] * m, m, m);
      }
    }
    start += static_cast<Eigen::Index>(seen.size()) * m;
  }
  return result;
}

}  // namespace abbe
