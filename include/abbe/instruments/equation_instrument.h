#pragma once

#include <memory>
#include <vector>

#include "abbe/instruments/instrument.h"

namespace abbe {

/// Where a body is seen at one pose; S is double or Dual. See equation_instrument_inline.h.
template <typename S>
struct SeenBody;

/// An instrument whose measurement equation is written once, for any scalar; derivatives follow by themselves.
///
/// Derived has a const member function template
///
///     template <typename S>
///     void equation(std::size_t item, const SeenBody<S>& seen, const S* quantities, const double* inputs,
///                   S* reading) const;
///
/// and is compiled once for all scalars: its source includes equation_instrument_inline.h, defines equation() and ends
/// with
///
///     template class EquationInstrument<Derived, kQuantities, kRows>;
///
/// @tparam kQuantities  largest number of quantities of an item; `quantities` are the item's, in its order
/// @tparam kRows        largest number of components; `reading` is filled for those of components(), in their order
template <typename Derived, int kQuantities, int kRows>
class EquationInstrument : public Instrument {
 public:
  void model(const ItemBlock& block, const ModelledBlock& out) const final;
  std::shared_ptr<const Instrument> with_values(const std::vector<double>& values) const final;

 protected:
  using Instrument::Instrument;

 private:
  template <typename S>
  void evaluate(const ItemBlock& block, const ModelledBlock& out) const;
  std::size_t estimated_quantities(std::size_t item) const;
};

}  // namespace abbe
