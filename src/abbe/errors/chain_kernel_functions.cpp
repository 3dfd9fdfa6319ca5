#include "abbe/errors/chain_kernel_functions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace abbe::chain {
namespace {

bool is_polynomial(BasisKind kind) {
  return kind == BasisKind::monomial || kind == BasisKind::legendre || kind == BasisKind::chebyshev;
}

/// [h][k]: coefficient of x^k in the Chebyshev polynomial of degree h, of the first or the second kind.
using ChebyshevPowers = std::array<std::array<double, kMostHarmonicPowers + 1>, kMostHarmonicPowers + 1>;

constexpr ChebyshevPowers chebyshev_powers(int kind) {
  ChebyshevPowers powers{};
  powers[0][0] = 1;
  powers[1][1] = kind;
  for (std::size_t h = 2; h <= kMostHarmonicPowers; ++h) {
    for (std::size_t k = 0; k <= h; ++k) powers[h][k] = (k > 0 ? 2 * powers[h - 1][k - 1] : 0) - powers[h - 2][k];
  }
  return powers;
}

/// cos(h q) = T_h(cos q) and sin(h q) = sin(q) U_(h-1)(cos q) turn harmonics into powers of the cosine.
/// @param harmonics  mean, cos1, sin1, cos2, ...
/// @param powers  [number + 1] of P, [number] of Q
void set_harmonic_powers(const double* harmonics, std::size_t number, double* powers) {
  static constexpr ChebyshevPowers kFirst = chebyshev_powers(1), kSecond = chebyshev_powers(2);
  std::fill_n(powers, 2 * number + 1, 0.0);
  powers[0] = harmonics[0];
  for (std::size_t h = number; h > 0; --h) {
    for (std::size_t k = 0; k <= h; ++k) powers[k] += kFirst[h][k] * harmonics[2 * h - 1];
    for (std::size_t k = 0; k < h; ++k) powers[number + 1 + k] += kSecond[h - 1][k] * harmonics[2 * h];
  }
}

std::vector<double> times_argument(const std::vector<double>& series, Form form) {
  const std::size_t n = series.size();
  std::vector<double> product(n, 0.0);
  for (std::size_t k = 0; k < n; ++k) {
    if (series[k] == 0) continue;
    if (form == Form::power) {
      product[k + 1] += series[k];
    } else if (k == 0) {
      product[1] += series[0];
    } else {
      product[k - 1] += 0.5 * series[k];
      product[k + 1] += 0.5 * series[k];
    }
  }
  return product;
}

/// Columns: the basis polynomials as series of the given form; row-major [series_size, size].
std::vector<double> polynomial_conversion(BasisKind kind, std::size_t size, Form form, std::size_t series_size) {
  std::vector<double> matrix(series_size * size, 0.0);
  std::vector<double> now(series_size + 1, 0.0), before(series_size + 1, 0.0);
  now[0] = 1;
  for (std::size_t n = 0; n < size; ++n) {
    for (std::size_t k = 0; k < series_size; ++k) matrix[k * size + n] = now[k];
    if (n + 1 == size) break;
    std::vector<double> next = times_argument(now, form);
    const double j = static_cast<double>(n);
    for (std::size_t k = 0; k < next.size(); ++k) {
      if (kind == BasisKind::legendre) next[k] = ((2 * j + 1) * next[k] - j * before[k]) / (j + 1);
      if (kind == BasisKind::chebyshev && n > 0) next[k] = 2 * next[k] - before[k];
    }
    before = std::move(now);
    now = std::move(next);
  }
  return matrix;
}

/// Finds the group that shares the argument, or adds it.
FunctionGroup& polynomial_group(AxisStep& step, Form form, double centre, double scale, std::size_t state) {
  for (FunctionGroup& group : step.groups) {
    if (group.form == form && group.centre == centre && group.scale == scale && group.state == state) return group;
  }
  FunctionGroup group;
  group.state = state;
  group.form = form;
  group.centre = centre;
  group.scale = scale;
  return step.groups.emplace_back(std::move(group));
}

FunctionGroup make_pieces(const Basis& basis, std::vector<double>& numbers) {
  FunctionGroup group;
  group.form = Form::pieces;
  std::vector<double> breaks = basis.nodes;
  if (basis.kind == BasisKind::bspline) {
    const double range = basis.periodic ? basis.period : basis.to - basis.from;
    group.pieces = static_cast<std::size_t>(basis.order);
    breaks.resize(group.pieces + 1);
    for (std::size_t i = 0; i <= group.pieces; ++i) {
      breaks[i] = basis.from + range * static_cast<double>(i) / static_cast<double>(group.pieces);
    }
  } else {
    if (basis.periodic) breaks.push_back(basis.nodes.front() + basis.period);
    group.pieces = breaks.size() - 1;
  }
  const double range = breaks.back() - breaks.front();
  group.straight = basis.kind == BasisKind::table_linear;
  group.start = breaks.front();
  group.period = basis.periodic ? range : 0;
  const double step = range / static_cast<double>(group.pieces);
  bool uniform = true;
  for (std::size_t i = 0; i < breaks.size(); ++i) {
    if (std::abs(breaks[i] - (group.start + step * static_cast<double>(i))) > 1e-14 * range) uniform = false;
  }
  if (uniform) group.inverse_step = 1.0 / step;
  group.breaks = numbers.size();
  numbers.insert(numbers.end(), breaks.begin(), breaks.end() - 1);
  for (std::size_t i = 0; i < group.pieces; ++i) numbers.push_back(1.0 / (breaks[i + 1] - breaks[i]));
  return group;
}

/// Series of one component in a group, at least `size` long; new ones get their numbers at the end.
std::size_t find_series(FunctionGroup& group, int component) {
  for (std::size_t i = 0; i < group.series.size(); ++i) {
    if (group.series[i].component == component) return i;
  }
  group.series.push_back({component, 0, 0});
  return group.series.size() - 1;
}

/// Numbers of a series from Series::first on.
std::size_t number_count(Form form, std::size_t size) {
  if (form == Form::fourier) return 2 * size + 1;
  return form == Form::pieces ? 4 * size : size;
}

/// Derivatives of a Fritsch-Butland slope by the values at the node before, the node and the node after.
struct SlopeWeights {
  double before = 0, here = 0, after = 0;
};

SlopeWeights monotone_slope_weights(std::span<const double> nodes, std::span<const double> values, std::size_t i) {
  const std::size_t last = nodes.size() - 1;
  if (i == 0) {
    const double h = nodes[1] - nodes[0];
    return {0, -1 / h, 1 / h};
  }
  if (i == last) {
    const double h = nodes[last] - nodes[last - 1];
    return {-1 / h, 1 / h, 0};
  }
  const double h0 = nodes[i] - nodes[i - 1], h1 = nodes[i + 1] - nodes[i];
  const double s0 = (values[i] - values[i - 1]) / h0, s1 = (values[i + 1] - values[i]) / h1;
  if (s0 * s1 <= 0) return {};
  const double w0 = (h0 + 2 * h1) / (3 * (h0 + h1)), w1 = 1 - w0;
  const double mean = w0 * s1 + w1 * s0;
  const double by_s0 = w0 * (s1 / mean) * (s1 / mean) / h0, by_s1 = w1 * (s0 / mean) * (s0 / mean) / h1;
  return {-by_s0, by_s0 - by_s1, by_s1};
}

/// weights[(piece * 4 + function) * 4 + power]
void fill_monotone_weights(std::span<const double> nodes, std::span<const double> values, std::span<double> weights) {
  for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
    const double h = nodes[i + 1] - nodes[i];
    const SlopeWeights a = monotone_slope_weights(nodes, values, i), b = monotone_slope_weights(nodes, values, i + 1);
    const double by_first[4] = {a.before, a.here, a.after, 0};
    const double by_second[4] = {0, b.before, b.here, b.after};
    for (std::size_t j = 0; j < 4; ++j) {
      const double first = h * by_first[j], second = h * by_second[j];
      const double y0 = j == 1 ? 1.0 : 0.0, y1 = j == 2 ? 1.0 : 0.0;
      double* w = &weights[(i * 4 + j) * 4];
      w[0] = y0;
      w[1] = first;
      w[2] = -3 * y0 + 3 * y1 - 2 * first - second;
      w[3] = 2 * y0 - 2 * y1 + first + second;
    }
  }
}

void fill_constant_weights(BasisKind kind, std::span<double> weights) {
  static constexpr double kSpline[16] = {1. / 6, -.5, .5, -1. / 6, 4. / 6, 0, -1, .5,
                                         1. / 6, .5,  .5, -.5,     0,      0, 0,  1. / 6};
  static constexpr double kLinear[16] = {1, -1, 0, 0, 0, 1, 0, 0};
  const double* pattern = kind == BasisKind::bspline ? kSpline : kLinear;
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = pattern[i % 16];
}

std::size_t wrapped(std::size_t piece, int first_function, std::size_t function, std::size_t size) {
  return (piece + size + function + static_cast<std::size_t>(first_function + 1) - 1) % size;
}

}  // namespace

void FunctionCompiler::add_terms(CompiledChain& chain, std::size_t step_index, const ErrorSet& errors,
                                 std::span<const std::size_t> compiled_state) {
  AxisStep& step = chain.steps[step_index];
  add_terms_of_state(chain, step, errors, kNoState, kNoState);
  step.plain_groups = step.groups.size();
  for (std::size_t state = 0; state < compiled_state.size(); ++state) {
    add_terms_of_state(chain, step, errors, state, compiled_state[state]);
  }
}

void FunctionCompiler::add_terms_of_state(CompiledChain& chain, AxisStep& step, const ErrorSet& errors,
                                          std::size_t state, std::size_t compiled) {
  // Those of pieces groups and of uses, same index; empty for others and for those of other states.
  std::vector<Basis> group_bases(step.groups.size()), use_bases(step.bases.size());
  const std::size_t first_group = step.groups.size(), first_use = step.bases.size();
  const auto polynomial_size = [&](const Basis& basis) {
    std::size_t size = 0;
    for (const ErrorMotion& other : errors.motions) {
      if (other.axis == step.axis && other.state == state && is_polynomial(other.basis.kind) &&
          other.basis.from == basis.from && other.basis.to == basis.to) {
        size = std::max(size, other.basis.size());
      }
    }
    return size;
  };

  std::size_t parameter = 0;
  for (const ErrorMotion& motion : errors.motions) {
    const std::size_t first_parameter = parameter;
    parameter += motion.coefficients.size();
    if (motion.axis != step.axis || motion.state != state) continue;
    const Basis& basis = motion.basis;
    const int component = static_cast<int>(motion.component);
    step.has_errors = true;
    step.has_angles = step.has_angles || is_rotation(motion.component);
    Term term{basis.kind, basis.size(), first_parameter, 0, 0, {}, 0, 0, 0, {}};
    BasisUse use;
    use.kind = basis.kind;
    use.size = basis.size();
    use.state = compiled;

    if (is_polynomial(basis.kind) || basis.kind == BasisKind::fourier) {
      FunctionGroup* group = nullptr;
      std::size_t numbers = 0, size = 0;
      if (basis.kind == BasisKind::fourier) {
        use.scale = 2 * std::numbers::pi / basis.period;
        use.shares_turn = step.rotary && use.scale == 1.0;
        group = &polynomial_group(step, Form::fourier, 0, use.scale, compiled);
        group->shares_turn = use.shares_turn;
        for (const ErrorMotion& other : errors.motions) {
          if (other.axis == step.axis && other.state == state && other.basis.kind == basis.kind &&
              other.basis.period == basis.period) {
            numbers = std::max(numbers, other.basis.size());
          }
        }
        size = numbers / 2;
      } else {
        use.centre = 0.5 * (basis.from + basis.to);
        use.scale = 2.0 / (basis.to - basis.from);
        size = numbers = polynomial_size(basis);
        const Form form = numbers > kLargestPowerSize ? Form::chebyshev : Form::power;
        group = &polynomial_group(step, form, use.centre, use.scale, compiled);
        term.conversion = polynomial_conversion(basis.kind, basis.size(), form, numbers);
      }
      Series& series = group->series[find_series(*group, component)];
      if (series.size == 0 && series.first == 0) {
        series.size = size;
        series.first = chain.numbers.size();
        chain.numbers.resize(chain.numbers.size() + numbers);
        if (group->form == Form::fourier && size <= kMostHarmonicPowers) {
          series.powers = chain.numbers.size();
          chain.numbers.resize(chain.numbers.size() + numbers);
        }
      }
      term.first_number = series.first;
      term.series_size = numbers;
      group_bases.resize(step.groups.size());
    } else {
      std::size_t g = first_group;
      while (g < group_bases.size() && !(step.groups[g].form == Form::pieces && group_bases[g] == basis)) ++g;
      if (g == group_bases.size()) {
        step.groups.push_back(make_pieces(basis, chain.numbers));
        step.groups.back().state = compiled;
        group_bases.push_back(basis);
      }
      FunctionGroup& group = step.groups[g];
      Series& series = group.series[find_series(group, component)];
      if (series.size == 0) {
        series.size = group.pieces;
        series.first = chain.numbers.size();
        chain.numbers.resize(chain.numbers.size() + 4 * group.pieces);
      }
      term.first_number = series.first;
      term.series_size = 4 * group.pieces;
      term.pieces = group.pieces;
      term.first_function = basis.kind == BasisKind::table_monotone ? -1 : 0;
      if (basis.kind == BasisKind::table_monotone) term.nodes = basis.nodes;
      use.group = g;
      use.first_function = term.first_function;
    }

    std::size_t u = first_use;
    while (u < use_bases.size() && (basis.kind == BasisKind::table_monotone || !(use_bases[u] == basis))) ++u;
    if (u == use_bases.size()) {
      if (term.pieces > 0) {
        use.weights = chain.numbers.size();
        chain.numbers.resize(chain.numbers.size() + 16 * term.pieces);
        fill_constant_weights(basis.kind, {&chain.numbers[use.weights], 16 * term.pieces});
      }
      step.bases.push_back(std::move(use));
      use_bases.push_back(basis);
    }
    step.bases[u].terms.push_back({component, first_parameter});
    term.weights = step.bases[u].weights;
    terms_.push_back(std::move(term));
  }
}

void FunctionCompiler::set_values(CompiledChain& chain, std::span<const double> values) const {
  for (const Term& term : terms_) {
    std::fill_n(&chain.numbers[term.first_number], term.series_size, 0.0);
  }
  for (const Term& term : terms_) {
    const std::span<const double> coefficients = values.subspan(term.first_parameter, term.size);
    double* series = &chain.numbers[term.first_number];
    if (term.pieces > 0) {
      double* weights = &chain.numbers[term.weights];
      if (!term.nodes.empty()) fill_monotone_weights(term.nodes, coefficients, {weights, 16 * term.pieces});
      for (std::size_t i = 0; i < term.pieces; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
          const double value = coefficients[wrapped(i, term.first_function, j, term.size)];
          for (std::size_t k = 0; k < 4; ++k) series[4 * i + k] += weights[(i * 4 + j) * 4 + k] * value;
        }
      }
    } else if (term.kind == BasisKind::fourier) {
      for (std::size_t k = 0; k < term.size; ++k) series[k] += coefficients[k];
    } else {
      for (std::size_t k = 0; k < term.series_size; ++k) {
        double sum = 0;
        for (std::size_t n = 0; n < term.size; ++n) sum += term.conversion[k * term.size + n] * coefficients[n];
        series[k] += sum;
      }
    }
  }
  for (const AxisStep& step : chain.steps) {
    for (const FunctionGroup& group : step.groups) {
      for (const Series& series : group.series) {
        const std::span<double> of_series(&chain.numbers[series.first], number_count(group.form, series.size));
        if (series.gives_half()) {
          for (double& number : of_series) number *= 0.5;
        }
        if (group.form == Form::fourier && series.size <= kMostHarmonicPowers) {
          set_harmonic_powers(of_series.data(), series.size, &chain.numbers[series.powers]);
        }
      }
    }
  }
}

}  // namespace abbe::chain
