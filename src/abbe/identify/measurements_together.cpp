#include "abbe/identify/measurements_together.h"

#include <algorithm>

#include "abbe/geometry/decompositions.h"

namespace abbe {
namespace {

using Eigen::Index;
constexpr int kMostTogether = 4;
constexpr double kStillZero = 1e-7;  // of the norm of the rows
constexpr double kSeenAbove = 1;     // standard uncertainties of all readings together
// What leaves more than this part of the best so far is no better.
constexpr double kHelps = 1 - 1e-6;

}  // namespace

std::string clause_of(const PossibleMeasurement& measurement) {
  std::string words = measurement.words;
  if (words.ends_with(',')) words.pop_back();
  return words;
}

double still_unseen(double norm) { return std::max(kStillZero * norm, kSeenAbove); }

Eigen::MatrixXd left_open(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& open) {
  if (open.cols() == 0 || rows.rows() == 0) return open;
  const Eigen::MatrixXd seen = rows * open;
  const SymmetricEigen<> eigen(seen.transpose() * seen);
  const double limit = still_unseen(rows.norm());
  Index left = 0;
  while (left < open.cols() && !(eigen.eigenvalues()[left] > limit * limit)) ++left;
  return open * eigen.eigenvectors().leftCols(left);
}

MeasurementsTogether measurements_together(const std::vector<PossibleMeasurement>& possible,
                                           const std::vector<Eigen::MatrixXd>& rows, const Eigen::MatrixXd& open,
                                           const Eigen::MatrixXd& unseen) {
  MeasurementsTogether result;
  Eigen::MatrixXd left = open;
  double rest = unseen.norm();
  for (int step = 0; step < kMostTogether && !result.enough; ++step) {
    std::size_t best = rows.size();
    double least = rest;
    Eigen::MatrixXd least_left;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      Eigen::MatrixXd after = left_open(rows[k], left);
      const double size = (after.transpose() * unseen).norm();
      if (!(size < kHelps * least)) continue;
      least = size;
      best = k;
      least_left = std::move(after);
    }
    if (best == rows.size()) break;
    result.words += (result.words.empty() ? "" : ", together with ") + clause_of(possible[best]);
    left = std::move(least_left);
    rest = least;
    result.enough = rest <= kLeftUnseen * unseen.norm();
  }
  return result;
}

}  // namespace abbe
