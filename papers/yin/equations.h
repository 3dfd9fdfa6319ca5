#pragma once

#include <string>
#include <vector>

namespace abbe {

/// One of the equations (1) to (8), put to a test that does not use what it tests.
struct YinEquation {
  std::string number;                     ///< "(6), A and C1"
  bool is_right = false;                  ///< as printed
  std::string printed, right;             ///< right: the same as printed, or what it must be
  std::string test;                       ///< by which it was found out
  double printed_off = 0, right_off = 0;  ///< by how much each fails the test
  std::string unit;                       ///< "mm" or "deg"
};

/// With the linkage of Table 2 and the beams of Table A4.
std::vector<YinEquation> yin_equations();

}  // namespace abbe
