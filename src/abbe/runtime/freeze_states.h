#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"
#include "abbe/runtime/freeze.h"
#include "abbe/runtime/frozen_functions.h"

namespace abbe {

/// Which states a frozen compensation needs, and how the factor of every error is made of them: a product of given
/// states, put in when they change, times a product of states that are computed at the pose.
struct FrozenStatePlan {
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  /// Product of one or two states of the machine.
  struct Product {
    std::size_t first = kNoState, second = kNoState;
    bool operator==(const Product&) const = default;
  };
  std::vector<std::size_t> states;      ///< of the machine, in its order
  std::vector<std::size_t> given;       ///< those of them that are measured or a lag
  std::vector<Product> factors, poses;  ///< given; computed at the pose
  std::vector<std::size_t> pose_state;  ///< [poses] the state of the machine that is this product
  /// Of each state of the machine that errors have, indices into factors and poses; kNone: it has none.
  struct Parts {
    std::size_t factor = kNone, pose = kNone;
  };
  std::vector<Parts> parts;        ///< [states of the machine]
  std::vector<StateRange> ranges;  ///< [states of the machine] of given states, in their units
  bool any() const { return !states.empty(); }
  Parts of(std::size_t state) const { return state == kNoState ? Parts{} : parts[state]; }
};

/// @param problem  out: why the errors cannot be frozen; not changed if they can
FrozenStatePlan plan_states(const Machine& machine, const ErrorSet& errors, const FreezeOptions& options,
                            std::string& problem);

/// Error motions with a factor of the pose (kNone: without one) as plain ones. Those with another given factor than
/// `factor` have zeros for coefficients, so that all sets of one pose have the same functions.
ErrorSet motions_of(const FrozenStatePlan& plan, const ErrorSet& errors, std::size_t factor, std::size_t pose);

/// Errors per unit of a given factor; what is computed at the pose remains.
ErrorSet errors_per_unit(const FrozenStatePlan& plan, const ErrorSet& errors, std::size_t factor);

/// Location errors that depend on nothing, and no others.
ErrorSet constant_locations(const ErrorSet& errors);

/// Corners of the ranges of given states, as state_factor() takes them; one without entries if there are none. Errors
/// are linear in every given state, so that variances, which are convex, are largest at a corner.
std::vector<std::vector<double>> corners(const Machine& machine, const FrozenStatePlan& plan);

/// Numbers behind the groups of a file of format 3 (frozen_layout.h).
/// @param groups   functions of the motions without a factor of the pose
/// @param largest  [factors] mm per unit
/// @param problem  out: not changed if everything has room
std::vector<double> state_values(const Machine& machine, const ErrorSet& errors, const FrozenStatePlan& plan,
                                 const std::vector<FrozenFunctions>& groups, const std::vector<double>& largest,
                                 std::string& problem);

/// Numbers of a group of functions.
std::vector<double> group_values(const FrozenFunctions& functions);

}  // namespace abbe
