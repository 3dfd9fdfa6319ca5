#include "abbe/errors/factored_columns.h"

#include <algorithm>

namespace abbe {
namespace {

/// True if function k of both motions is the same function for every k that both have.
bool share_functions(const ErrorMotion& a, const ErrorMotion& b) {
  if (a.axis != b.axis || a.state != b.state || a.basis.kind != b.basis.kind) return false;
  switch (a.basis.kind) {
    case BasisKind::monomial:
    case BasisKind::legendre:
    case BasisKind::chebyshev:
      return a.basis.from == b.basis.from && a.basis.to == b.basis.to;
    case BasisKind::fourier:
      return a.basis.period == b.basis.period;
    case BasisKind::bspline:
    case BasisKind::table_linear:
      return a.basis == b.basis;
    case BasisKind::table_monotone:
      return false;
  }
  return false;
}

/// Numbers of the factors of one error motion; kOne: not needed yet.
struct MotionFactors {
  std::size_t first_parameter = 0;
  std::size_t family = 0;   ///< first motion with the same functions
  std::size_t channel = 0;  ///< first motion of the same component
};

}  // namespace

void FactoredColumns::add_whole_column() {
  carrier_first.push_back(columns.size());
  columns.push_back({carrier_first.size() - 1, kOne});
}

FactoredColumns factored_columns(const ErrorSet& errors, std::span<const std::size_t> parameters) {
  constexpr std::size_t kNone = FactoredColumns::kOne;
  const std::size_t motions = errors.motions.size();
  std::vector<MotionFactors> factors(motions);
  std::vector<std::size_t> carrier(motions, kNone);      // of channels
  std::vector<std::vector<std::size_t>> basis(motions);  // of families, per function
  std::size_t coefficients = 0;
  for (std::size_t m = 0; m < motions; ++m) {
    const ErrorMotion& motion = errors.motions[m];
    factors[m] = {coefficients, m, m};
    for (std::size_t other = 0; other < m; ++other) {
      const ErrorMotion& before = errors.motions[other];
      if (factors[m].family == m && share_functions(motion, before)) factors[m].family = factors[other].family;
      if (before.axis == motion.axis && before.component == motion.component)
        factors[m].channel = factors[other].channel;
    }
    std::vector<std::size_t>& functions = basis[factors[m].family];
    functions.resize(std::max(functions.size(), motion.coefficients.size()), kNone);
    coefficients += motion.coefficients.size();
  }
  FactoredColumns form;
  for (const std::size_t parameter : parameters) {
    if (parameter >= coefficients) {
      form.add_whole_column();
      continue;
    }
    const auto after =
        std::upper_bound(factors.begin(), factors.end(), parameter,
                         [](std::size_t value, const MotionFactors& motion) { return value < motion.first_parameter; });
    const MotionFactors& motion = *(after - 1);
    const std::size_t column = form.columns.size();
    std::size_t& own_carrier = carrier[motion.channel];
    if (own_carrier == kNone) {
      own_carrier = form.carriers();
      form.carrier_first.push_back(column);
    }
    std::size_t& own_basis = basis[motion.family][parameter - motion.first_parameter];
    if (own_basis == kNone) {
      own_basis = form.bases();
      form.basis_first.push_back(column);
    }
    form.columns.push_back({own_carrier, own_basis});
  }
  return form;
}

}  // namespace abbe
