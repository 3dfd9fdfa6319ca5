#include "abbe/identify/measurements_together.h"

namespace abbe {
namespace {

constexpr int kMostTogether = 3;

}  // namespace

std::string clause_of(const PossibleMeasurement& measurement) {
  std::string words = measurement.words;
  if (words.ends_with(',')) words.pop_back();
  return words;
}

MeasurementsTogether measurements_together(const std::vector<PossibleMeasurement>& possible,
                                           const std::vector<Eigen::MatrixXd>& left, const Eigen::MatrixXd& unseen) {
  MeasurementsTogether result;
  Eigen::MatrixXd rest = unseen;
  for (int step = 0; step < kMostTogether && !result.enough; ++step) {
    std::size_t best = 0;
    double least = rest.norm();
    for (std::size_t k = 0; k < left.size(); ++k) {
      const double after = (left[k].transpose() * rest).norm();
      if (after < 0.999 * least) {
        least = after;
        best = k;
      }
    }
    if (!(least < rest.norm())) break;
    result.words += (result.words.empty() ? "" : ", together with ") + clause_of(possible[best]);
    rest = left[best] * (left[best].transpose() * rest).eval();
    result.enough = rest.norm() <= kLeftUnseen * unseen.norm();
  }
  return result;
}

}  // namespace abbe
