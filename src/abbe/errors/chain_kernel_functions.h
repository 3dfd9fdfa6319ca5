#pragma once

#include <span>
#include <vector>

#include "abbe/errors/chain_kernel.h"

namespace abbe::chain {

/// Turns error motions into the merged series of the compiled chain, once for the structure and again for new values.
class FunctionCompiler {
 public:
  /// Adds all terms of the step's axis to the step, reserving their numbers in the chain.
  /// @param compiled_state  [states of the machine] index into CompiledChain::states
  void add_terms(CompiledChain& chain, std::size_t step, const ErrorSet& errors,
                 std::span<const std::size_t> compiled_state);

  /// Writes new coefficients into chain.numbers; does not allocate.
  /// @param values  all parameters, in the order of ErrorSet::parameters()
  void set_values(CompiledChain& chain, std::span<const double> values) const;

 private:
  struct Term {
    BasisKind kind;
    std::size_t size;  ///< coefficients
    std::size_t first_parameter;
    std::size_t first_number;  ///< of its series
    std::size_t series_size;
    std::vector<double> conversion;  ///< polynomials: [series_size, size], row-major, coefficients to series
    std::size_t weights;             ///< pieces
    std::size_t pieces;
    int first_function;
    std::vector<double> nodes;  ///< table_monotone: its weights follow the values
  };
  /// Those of one state (a machine's), or of none.
  void add_terms_of_state(CompiledChain& chain, AxisStep& step, const ErrorSet& errors, std::size_t state,
                          std::size_t compiled);
  std::vector<Term> terms_;
};

}  // namespace abbe::chain
