#include "abbe/formats/machine/transform_file.h"

#include <gmock/gmock.h>

#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

using testing::HasSubstr;

std::string message_of_transform(const std::string& text) {
  return message_of([&] { parse_transform(text, "t.csv"); });
}

TEST(TransformFile, ReadsBackToTheSameBits) {
  const RigidTransform pose{rotation_from_vector({0.4, -1.1, 2.0}), {12.123456789, -4e5, 1e-9}};
  const RigidTransform back = parse_transform(transform_csv(pose), "t.csv");
  EXPECT_EQ(back.rotation, pose.rotation);
  EXPECT_EQ(back.translation, pose.translation);
}

TEST(TransformFile, KeepsTheStatusOfTheRegistration) {
  const RigidTransform pose{rotation_from_vector({0.4, -1.1, 2.0}), {12, -4, 1}};
  const TransformFile back = parse_transform_file(transform_csv(pose, "not_converged"), "t.csv");
  EXPECT_EQ(back.status, "not_converged");
  EXPECT_EQ(back.transform.translation, pose.translation);
  EXPECT_EQ(parse_transform_file(transform_csv(pose), "t.csv").status, "");
  const std::string elsewhere = "# from a drawing\r\n\r\n# status: ambiguous\r\n" + transform_csv(pose);
  EXPECT_EQ(parse_transform_file(elsewhere, "t.csv").status, "ambiguous");
}

TEST(TransformFile, TakesTheNearestRotationOfRoundedDigitsAndOtherUnits) {
  const RigidTransform read = parse_transform(
      "rotation_x,rotation_y,rotation_z,translation_m\n0.866025,-0.5,0,1\n0.5,0.866025,0,2\n0,0,1,3\n", "t.csv");
  EXPECT_LT((read.rotation.transpose() * read.rotation - Eigen::Matrix3d::Identity()).norm(), 1e-15);
  EXPECT_NEAR(rotation_vector(read.rotation).z(), 0.523599, 1e-5);
  EXPECT_EQ(read.translation, Eigen::Vector3d(1000, 2000, 3000));
}

TEST(TransformFile, WhatIsNoRotationIsRefused) {
  const std::string header = "rotation_x,rotation_y,rotation_z,translation_mm\n";
  EXPECT_THAT(message_of_transform(header + "1,0,0,1\n0,1,0,2\n"),
              HasSubstr("2 rows below the header; expected three"));
  EXPECT_THAT(message_of_transform(header + "1,0,0,1\n0,1,0,2\n0,0.1,1,3\n"), HasSubstr("not a rotation matrix"));
  EXPECT_THAT(message_of_transform(header + "0,0,0,1\n0,0,0,2\n0,0,0,3\n"), HasSubstr("not a rotation matrix"));
  EXPECT_THAT(message_of_transform(header + "1,0,0,1\n0,1,0,2\n0,0,-1,3\n"), HasSubstr("a mirrored matrix"));
  EXPECT_THAT(message_of_transform(header + "1,0,0,1\n0,1,0,2\n0,0,one,3\n"), HasSubstr("t.csv:4"));
  EXPECT_THAT(message_of_transform("rotation_x,rotation_y,rotation_z,translation\n"), HasSubstr("translation"));
}

}  // namespace
}  // namespace abbe
