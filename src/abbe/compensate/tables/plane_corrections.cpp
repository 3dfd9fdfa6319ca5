#include "abbe/compensate/tables/plane_corrections.h"

#include <cassert>
#include <utility>

namespace abbe {
namespace {

/// Adds `sign` times what a function says.
void add_part(double sign, const CommandCorrection& function, const PoseList& commands, PoseList& sum) {
  PoseList part;
  function.evaluate(commands, part);
  for (std::size_t i = 0; i < sum.axis.size(); ++i) {
    for (std::size_t k = 0; k < sum.axis[i].size(); ++k) sum.axis[i][k] += sign * part.axis[i][k];
  }
}

}  // namespace

std::vector<std::array<std::size_t, 2>> axis_pairs(const std::vector<std::size_t>& axes) {
  std::vector<std::array<std::size_t, 2>> pairs;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    for (std::size_t j = i + 1; j < axes.size(); ++j) pairs.push_back({axes[i], axes[j]});
  }
  return pairs;
}

PlaneCorrection::PlaneCorrection(const Machine& machine, const ErrorSet& errors, const LatticeOptions& options,
                                 std::size_t pair) {
  assert(options.inputs.size() == 2 || options.inputs.size() == 3);
  const auto add = [&](double sign, std::vector<std::size_t> inputs) {
    LatticeOptions of_term = options;
    of_term.inputs = std::move(inputs);
    terms_.push_back({sign, std::make_unique<LatticeFunction>(machine, errors, std::move(of_term))});
  };
  const std::array<std::size_t, 2> axes = axis_pairs(options.inputs)[pair];
  add(1, {axes[0], axes[1]});
  // The first pair has both of its axes by themselves, the second its second one, the third none.
  if (pair >= 1) add(-1, {axes[0]});
  if (pair == 2) {
    add(-1, {axes[1]});
    add(1, {});
  }
}

void PlaneCorrection::evaluate(const PoseList& commands, PoseList& correction) const {
  NoCorrection().evaluate(commands, correction);
  for (const Term& term : terms_) add_part(term.sign, *term.function, commands, correction);
}

void CorrectionSum::evaluate(const PoseList& commands, PoseList& correction) const {
  NoCorrection().evaluate(commands, correction);
  for (const std::unique_ptr<CommandCorrection>& part : parts_) add_part(1, *part, commands, correction);
}

}  // namespace abbe
