#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "abbe/compensate/tables/axis_table.h"
#include "abbe/formats/controls/table_axis_names.h"
#include "abbe/formats/text/input_error.h"

namespace abbe::test {

inline const std::vector<TableAxisName> kXYC = {{0, "X", false}, {1, "Y", false}, {2, "C", true}};

/// A table with numbers of many digits.
inline AxisTable some_table(std::size_t input, std::size_t output, std::size_t nodes, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> size(-0.03, 0.03);
  AxisTable table;
  table.input = input;
  table.output = output;
  for (std::size_t k = 0; k < nodes; ++k) {
    table.positions.push_back(-100 + 760.0 * static_cast<double>(k) / static_cast<double>(nodes - 1));
    table.forward.push_back(size(generator));
  }
  table.reverse = table.forward;
  return table;
}

/// A whole turn of an axis for itself in steps of 10 degrees; values repeat themselves after `repeat` nodes.
inline AxisTable some_turn(std::size_t axis, int repeat) {
  AxisTable turn;
  turn.input = turn.output = axis;
  for (int k = 0; k <= 36; ++k) {
    turn.positions.push_back(2 * std::numbers::pi * k / 36);
    turn.forward.push_back(1e-5 * (k % repeat));
  }
  turn.reverse = turn.forward;
  return turn;
}

inline void expect_near(const AxisTable& read, const AxisTable& table, double position, double value) {
  ASSERT_EQ(read.positions.size(), table.positions.size());
  EXPECT_EQ(read.input, table.input);
  EXPECT_EQ(read.output, table.output);
  EXPECT_EQ(read.modulo, table.modulo);
  for (std::size_t k = 0; k < table.positions.size(); ++k) {
    EXPECT_NEAR(read.positions[k], table.positions[k], position);
    EXPECT_NEAR(read.forward[k], table.forward[k], value);
    EXPECT_NEAR(read.reverse[k], table.reverse[k], value);
  }
}

/// The message of the InputError that reading gives; fails the test if there is none.
template <class Read>
std::string refusal(const Read& read) {
  try {
    read();
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "was read";
  return "";
}

}  // namespace abbe::test
