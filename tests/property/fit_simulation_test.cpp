// Ten thousand small sets of points of every shape, size, noise and place have their shape, and each is an optimum.
#include <gtest/gtest.h>

#include "abbe/geometry/fits/simulated_fits_for_test.h"

namespace abbe {
namespace {

TEST(FitSimulation, TenThousandSmallSetsHaveTheirLeastSquaresShape) { test::simulate_least_squares(1250, 2026); }
TEST(FitSimulation, ThousandsOfSmallSetsHaveTheirCircumscribedShape) {
  test::simulate_extreme(ExtremeKind::circumscribed, 1000, 2026);
}
TEST(FitSimulation, ThousandsOfSmallSetsHaveTheirInscribedShape) {
  test::simulate_extreme(ExtremeKind::inscribed, 1000, 2026);
}
TEST(FitSimulation, HundredsOfSmallSetsHaveTheirMinimumZone) {
  test::simulate_extreme(ExtremeKind::minimum_zone, 50, 2026);
}
TEST(FitSimulation, HundredsOfSmallSetsHaveTheirRobustShape) { test::simulate_robust(100, 2026); }

}  // namespace
}  // namespace abbe
