#include "abbe/identify/measurements_together.h"

#include <gtest/gtest.h>

namespace abbe {
namespace {

/// Five open directions; the k-th measurement shows the k-th of them and nothing else.
struct OneEach {
  OneEach() {
    for (Eigen::Index k = 0; k < 5; ++k) {
      rows.emplace_back(100 * Eigen::VectorXd::Unit(5, k).transpose());
      possible.emplace_back();
      possible.back().words = std::string("measurement ") + static_cast<char>('A' + k) + ",";
    }
  }
  std::vector<PossibleMeasurement> possible;
  std::vector<Eigen::MatrixXd> rows;
  Eigen::MatrixXd open = Eigen::MatrixXd::Identity(5, 5);
};

TEST(MeasurementsTogether, NamesFirstWhatTakesMostAway) {
  const OneEach each;
  const Eigen::VectorXd unseen = Eigen::VectorXd::Unit(5, 1) + 2 * Eigen::VectorXd::Unit(5, 3);
  const MeasurementsTogether together = measurements_together(each.possible, each.rows, each.open, unseen);
  EXPECT_EQ(together.words, "measurement D, together with measurement B");
  EXPECT_TRUE(together.enough);
}

TEST(MeasurementsTogether, SaysWhenFourDoNotSuffice) {
  const OneEach each;
  const MeasurementsTogether together =
      measurements_together(each.possible, each.rows, each.open, Eigen::VectorXd::Ones(5));
  EXPECT_EQ(together.words,
            "measurement A, together with measurement B, together with measurement C, "
            "together with measurement D");
  EXPECT_FALSE(together.enough);
}

TEST(MeasurementsTogether, HasNoWordsWhereNothingHelps) {
  const OneEach each;
  const std::vector<Eigen::MatrixXd> nothing(5, Eigen::MatrixXd::Zero(1, 5));
  const MeasurementsTogether together =
      measurements_together(each.possible, nothing, each.open, Eigen::VectorXd::Ones(5));
  EXPECT_EQ(together.words, "");
  EXPECT_FALSE(together.enough);
}

TEST(MeasurementsTogether, CountsWhatTheyShowTogetherExactly) {
  // Two rows a hundredth of a radian apart: one after the other they take a plane away, though each of them leaves
  // nearly the same.
  const OneEach each;
  std::vector<Eigen::MatrixXd> rows(2, Eigen::MatrixXd::Zero(1, 5));
  rows[0](0, 0) = rows[1](0, 0) = 1e4;
  rows[1](0, 1) = 1e2;
  const Eigen::VectorXd unseen = Eigen::VectorXd::Unit(5, 1);
  const MeasurementsTogether together = measurements_together(each.possible, rows, each.open, unseen);
  EXPECT_EQ(together.words, "measurement B, together with measurement A");
  EXPECT_TRUE(together.enough);
}

TEST(LeftOpen, KeepsWhatNoRowSeesAboveNoise) {
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3, 4);
  rows(0, 0) = 50;
  rows(1, 1) = 0.5;  // half a standard uncertainty
  rows(2, 2) = 2;
  const Eigen::MatrixXd left = left_open(rows, Eigen::MatrixXd::Identity(4, 4));
  ASSERT_EQ(left.cols(), 2);
  EXPECT_NEAR((left * left.transpose() - Eigen::Vector4d(0, 1, 0, 1).asDiagonal().toDenseMatrix()).norm(), 0, 1e-14);
}

}  // namespace
}  // namespace abbe
