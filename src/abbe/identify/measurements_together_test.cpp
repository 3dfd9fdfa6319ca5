#include "abbe/identify/measurements_together.h"

#include <gtest/gtest.h>

namespace abbe {
namespace {

/// Five open directions; the k-th measurement shows the k-th of them and nothing else.
struct OneEach {
  OneEach() {
    for (Eigen::Index k = 0; k < 5; ++k) {
      Eigen::MatrixXd others(5, 4);
      for (Eigen::Index i = 0, column = 0; i < 5; ++i) {
        if (i != k) others.col(column++) = Eigen::VectorXd::Unit(5, i);
      }
      left.push_back(others);
      possible.emplace_back();
      possible.back().words = std::string("measurement ") + static_cast<char>('A' + k) + ",";
    }
  }
  std::vector<PossibleMeasurement> possible;
  std::vector<Eigen::MatrixXd> left;
};

TEST(MeasurementsTogether, NamesFirstWhatTakesMostAway) {
  const OneEach each;
  const Eigen::VectorXd unseen = Eigen::VectorXd::Unit(5, 1) + 2 * Eigen::VectorXd::Unit(5, 3);
  const MeasurementsTogether together = measurements_together(each.possible, each.left, unseen);
  EXPECT_EQ(together.words, "measurement D, together with measurement B");
  EXPECT_TRUE(together.enough);
}

TEST(MeasurementsTogether, SaysWhenThreeDoNotSuffice) {
  const OneEach each;
  const MeasurementsTogether together = measurements_together(each.possible, each.left, Eigen::VectorXd::Ones(5));
  EXPECT_EQ(together.words, "measurement A, together with measurement B, together with measurement C");
  EXPECT_FALSE(together.enough);
}

TEST(MeasurementsTogether, HasNoWordsWhereNothingHelps) {
  const OneEach each;
  const std::vector<Eigen::MatrixXd> all(5, Eigen::MatrixXd::Identity(5, 5));
  const MeasurementsTogether together = measurements_together(each.possible, all, Eigen::VectorXd::Ones(5));
  EXPECT_EQ(together.words, "");
  EXPECT_FALSE(together.enough);
}

}  // namespace
}  // namespace abbe
