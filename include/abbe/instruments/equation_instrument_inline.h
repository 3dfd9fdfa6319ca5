#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cassert>
#include <type_traits>

#include "abbe/geometry/dual.h"
#include "abbe/instruments/equation_instrument.h"

/// What the source of an EquationInstrument needs and nobody else: it takes seconds to compile for every instrument.
namespace abbe {

/// Where the body `from` is seen at one pose, in the frame of `to`; S is double or Dual.
template <typename S>
struct SeenBody {
  Eigen::Matrix<S, 3, 3> rotation;
  Eigen::Matrix<S, 3, 1> origin;

  /// A point of the body (its own frame, mm) in the frame of `to`.
  template <typename Vector>
  Eigen::Matrix<S, 3, 1> point(const Vector& own) const {
    return rotation * own.template cast<S>() + origin;
  }
  /// A direction of the body in the frame of `to`.
  template <typename Vector>
  Eigen::Matrix<S, 3, 1> direction(const Vector& own) const {
    return rotation * own.template cast<S>();
  }
};

namespace equation_instrument {

/// Value with the derivatives by the turn of the body.
template <typename S>
S turned(double value, const Eigen::Vector3d& by_turn) {
  S result(value);
  for (std::size_t i = 0; i < 3; ++i) result.slope[3 + i] = by_turn[static_cast<Eigen::Index>(i)];
  return result;
}

/// The body at pose k of the block, with the derivatives by its motion.
template <typename S>
SeenBody<S> seen_body(const ItemBlock& block, std::size_t k) {
  SeenBody<S> seen;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if constexpr (std::is_same_v<S, double>) {
        seen.rotation(i, j) = block.rotation[3 * i + j][k];
      } else {
        // d(R e_j) = w x R e_j.
        const Eigen::Vector3d column(block.rotation[j][k], block.rotation[3 + j][k], block.rotation[6 + j][k]);
        Eigen::Vector3d by_turn = Eigen::Vector3d::Zero();
        by_turn[(i + 1) % 3] = column[(i + 2) % 3];
        by_turn[(i + 2) % 3] = -column[(i + 1) % 3];
        seen.rotation(i, j) = turned<S>(column[i], by_turn);
      }
    }
    if constexpr (std::is_same_v<S, double>) {
      seen.origin[i] = block.origin[i][k];
    } else {
      seen.origin[i] = S::variable(block.origin[i][k], i);
    }
  }
  return seen;
}

inline constexpr int kFew = 4, kSome = 12;
inline constexpr std::size_t kMaxInputs = 16;

}  // namespace equation_instrument

template <typename Derived, int kQuantities, int kRows>
void EquationInstrument<Derived, kQuantities, kRows>::model(const ItemBlock& block, const ModelledBlock& out) const {
  using equation_instrument::kFew, equation_instrument::kSome;
  if (out.by_motion == nullptr && out.by_quantity == nullptr) {
    evaluate<double>(block, out);
    return;
  }
  // Every derivative that is carried costs, and most numbers of a set-up are exact.
  const std::size_t estimated = estimated_quantities(block.item);
  if constexpr (kQuantities > kFew) {
    if (estimated <= kFew) return evaluate<Dual<6 + kFew>>(block, out);
  }
  if constexpr (kQuantities > kSome) {
    if (estimated <= kSome) return evaluate<Dual<6 + kSome>>(block, out);
  }
  evaluate<Dual<6 + kQuantities>>(block, out);
}

template <typename Derived, int kQuantities, int kRows>
std::shared_ptr<const Instrument> EquationInstrument<Derived, kQuantities, kRows>::with_values(
    const std::vector<double>& values) const {
  auto copy = std::make_shared<Derived>(*static_cast<const Derived*>(this));
  copy->set_values(values);
  return copy;
}

template <typename Derived, int kQuantities, int kRows>
std::size_t EquationInstrument<Derived, kQuantities, kRows>::estimated_quantities(std::size_t item) const {
  std::size_t count = 0;
  for (const std::size_t q : items_[item].quantities) count += quantities_[q].knowledge != Knowledge::exact ? 1U : 0U;
  return count;
}

template <typename Derived, int kQuantities, int kRows>
template <typename S>
void EquationInstrument<Derived, kQuantities, kRows>::evaluate(const ItemBlock& block, const ModelledBlock& out) const {
  const std::vector<std::size_t>& used = items_[block.item].quantities;
  assert(used.size() <= static_cast<std::size_t>(kQuantities) &&
         block.inputs.size() <= equation_instrument::kMaxInputs);
  assert(components_.size() <= static_cast<std::size_t>(kRows));
  std::array<S, static_cast<std::size_t>(kQuantities > 0 ? kQuantities : 1)> quantities{};
  std::array<int, static_cast<std::size_t>(kQuantities > 0 ? kQuantities : 1)> variable{};  // -1: exact
  int next = 6;
  for (std::size_t q = 0; q < used.size(); ++q) {
    const double value = block.quantities[used[q]];
    variable[q] = quantities_[used[q]].knowledge != Knowledge::exact ? next++ : -1;
    if constexpr (std::is_same_v<S, double>) {
      quantities[q] = value;
    } else {
      quantities[q] = variable[q] >= 0 ? S::variable(value, variable[q]) : S(value);
    }
  }
  std::array<double, equation_instrument::kMaxInputs> inputs{};
  std::array<S, static_cast<std::size_t>(kRows)> reading;
  for (std::size_t k = 0; k < block.count; ++k) {
    for (std::size_t i = 0; i < block.inputs.size(); ++i) inputs[i] = block.inputs[i][k];
    static_cast<const Derived*>(this)->equation(block.item, equation_instrument::seen_body<S>(block, k),
                                                quantities.data(), inputs.data(), reading.data());
    for (std::size_t row = 0; row < components_.size(); ++row) {
      out.value[row * block.count + k] = value_of(reading[row]);
      if constexpr (!std::is_same_v<S, double>) {
        for (std::size_t j = 0; j < 6 && out.by_motion != nullptr; ++j) {
          out.by_motion[(row * 6 + j) * block.count + k] = reading[row].slope[j];
        }
        for (std::size_t q = 0; q < used.size() && out.by_quantity != nullptr; ++q) {
          out.by_quantity[(row * used.size() + q) * block.count + k] =
              variable[q] >= 0 ? reading[row].slope[static_cast<std::size_t>(variable[q])] : 0.0;
        }
      }
    }
  }
}

}  // namespace abbe
