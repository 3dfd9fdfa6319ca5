#include "abbe/errors/factored_columns.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "abbe/errors/chain_plan_cases.h"
#include "abbe/errors/chain_plan_differences.h"

namespace abbe {
namespace {

using chain_cases::add_random_states;
using chain_cases::all_parameters;
using chain_cases::Batch;
using chain_cases::Case;
using chain_cases::Derivatives;
using chain_cases::differentiate;
using chain_cases::kBodies;
using chain_cases::random_case;
using chain_cases::Rows;

/// The factors of a plan, multiplied, against its columns.
void expect_products_equal_columns(const Case& c, const std::vector<std::size_t>& parameters, Body from, Body to,
                                   RandomStream& random) {
  const ChainPlan plan(c.machine, c.errors, from, to);
  constexpr std::size_t kCount = 21, kRowCount = 8;  // more rows than one sweep takes
  Batch batch(c.machine, kCount, random);
  batch.transform(plan);
  const Rows rows(kRowCount, kCount, random);
  const Derivatives whole = differentiate(plan, batch, rows, parameters, c.machine.axes.size());
  const FactoredColumns form = factored_columns(c.errors, parameters);
  ASSERT_EQ(form.columns.size(), parameters.size());
  constexpr std::size_t kStride = kRowCount * kCount + 3, kBasisStride = kCount + 5;
  std::vector<double> carriers(form.carriers() * kStride, 1e300), bases(form.bases() * kBasisStride, 1e300);
  std::vector<double> by_position(c.machine.axes.size() * kRowCount * kCount);
  plan.differentiate_factored(batch.positions(), batch.const_seen(), rows.arrays, parameters, form, carriers.data(),
                              kStride, bases.data(), kBasisStride, nullptr, by_position.data());
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    const auto [carrier, basis] = form.columns[j];
    for (std::size_t i = 0; i < kRowCount * kCount; ++i) {
      const double function = basis == FactoredColumns::kOne ? 1.0 : bases[basis * kBasisStride + i % kCount];
      ASSERT_EQ(carriers[carrier * kStride + i] * function, whole.jacobian[j * whole.stride + i])
          << parameter_names(c.machine, c.errors)[parameters[j]];
    }
  }
  EXPECT_EQ(by_position, whole.by_position);
}

TEST(FactoredColumns, multiply_to_the_columns_for_all_bodies_states_and_orders_of_parameters) {
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    Case c = random_case(seed, 0.1);
    if (seed % 2 == 1) add_random_states(c, seed, 0.1);
    RandomStream random(seed, 3);
    std::vector<std::size_t> parameters = all_parameters(c.errors);
    if (seed % 4 >= 2) {
      for (std::size_t i = parameters.size(); i > 1; --i) std::swap(parameters[i - 1], parameters[random.bits() % i]);
      parameters.resize(parameters.size() / 2 + 1);
      parameters.push_back(parameters.front());
    }
    for (const Body from : kBodies)
      for (const Body to : kBodies) expect_products_equal_columns(c, parameters, from, to, random);
  }
}

TEST(FactoredColumns, of_an_axis_are_its_components_and_its_functions) {
  Case c = random_case(4, 0.1);
  c.errors = {};
  const Basis five{.kind = BasisKind::legendre, .order = 4, .from = -10, .to = 10};
  Basis three = five;
  three.order = 2;
  for (int k = 0; k < kComponentCount; ++k) {
    const Basis& basis = k == 2 ? three : five;
    c.errors.motions.push_back({0, static_cast<Component>(k), basis, std::vector<double>(basis.size()), {}});
  }
  c.errors.locations.push_back({0, Component::A, 0, 0});
  const FactoredColumns form = factored_columns(c.errors, all_parameters(c.errors));
  EXPECT_EQ(form.columns.size(), 28 + 1 + 3U);
  EXPECT_EQ(form.carriers(), 6 + 1 + 3U);
  EXPECT_EQ(form.bases(), 5U);
  EXPECT_EQ(form.columns[5], (FactoredColumns::Column{1, 0})) << "the first function of the second component";
  EXPECT_EQ(form.columns[13], (FactoredColumns::Column{3, 0})) << "a shorter series has the same functions";
  EXPECT_EQ(form.columns[28].basis, FactoredColumns::kOne);

  // Another range, another state, and every monotone table have functions of their own.
  Basis shifted = five;
  shifted.to = 11;
  const Basis table{.kind = BasisKind::table_monotone, .from = -10, .to = 10, .nodes = {-10, 0, 10}};
  c.errors.motions = {{0, Component::X, five, std::vector<double>(5), {}},
                      {0, Component::X, shifted, std::vector<double>(5), {}},
                      {0, Component::X, five, std::vector<double>(5), {}, 0},
                      {0, Component::Y, table, std::vector<double>(3), {}},
                      {0, Component::Z, table, std::vector<double>(3), {}}};
  const FactoredColumns other = factored_columns(c.errors, all_parameters(c.errors));
  EXPECT_EQ(other.carriers(), 3 + 1 + 3U);
  EXPECT_EQ(other.bases(), 15 + 6U);
}

}  // namespace
}  // namespace abbe
