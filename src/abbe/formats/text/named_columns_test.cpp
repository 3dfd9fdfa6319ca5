#include "abbe/formats/text/named_columns.h"

#include <gtest/gtest.h>

#include <limits>

#include "abbe/formats/evaluations/evaluation_circular_file.h"
#include "abbe/formats/evaluations/evaluation_line_file.h"
#include "abbe/formats/evaluations/evaluation_positioning.h"
#include "abbe/formats/evaluations/evaluation_rotation_file.h"
#include "abbe/formats/evaluations/section_file.h"
#include "abbe/formats/machine/linkage_file.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using Numbers = std::vector<double>;
using Words = std::vector<std::string>;

std::string refused_columns(const NamedColumns& columns) {
  return message_of([&] { parse_positioning(columns); });
}

TEST(NamedColumns, GiveTheSameNumbersAsAFile) {
  const PositioningFile file = parse_positioning(
      "run,direction,target_mm,deviation_um\n1,+,0.1,2.7\n1,-,0.1,-1e-3\n2,+,0.1,0.30000000000000004\n", "p.csv");
  const PositioningFile given = parse_positioning({{"target_mm", Numbers(3, 0.1)},
                                                   {"run", Numbers{1, 1, 2}},
                                                   {"deviation_um", Numbers{2.7, -1e-3, 0.1 + 0.2}},
                                                   {"direction", Words{"+", "-", " + "}}});
  ASSERT_EQ(given.readings.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(given.readings[i].target, file.readings[i].target);
    EXPECT_EQ(given.readings[i].deviation, file.readings[i].deviation) << i;
    EXPECT_EQ(given.readings[i].direction, file.readings[i].direction);
  }
}

TEST(NamedColumns, AreRefusedWithTheirNameAndIndex) {
  const NamedColumn plus{"direction", Words{"+", "+"}}, target{"target_mm", Numbers{0, 100}};
  EXPECT_EQ(refused_columns({}), "there are no columns; expected columns named as in a file");
  EXPECT_EQ(refused_columns({plus, target, {"deviation_um", Numbers{0, std::numeric_limits<double>::quiet_NaN()}}}),
            "deviation_um[1]: 'nan' is not a finite number; expected a length in um");
  EXPECT_EQ(refused_columns({plus, target, {"deviation_um", Numbers{0}}}),
            "deviation_um: has 1 value; expected 2 as in direction");
  EXPECT_EQ(refused_columns({{"direction", Words{}}, {"target_mm", Numbers{}}, {"deviation_um", Numbers{}}}),
            "direction: there are no rows; expected at least one row");
  EXPECT_EQ(refused_columns({plus, target, {"deviation_um", Words{"a", "b"}}}),
            "deviation_um: is not an array of numbers; expected a length in um");
  EXPECT_EQ(refused_columns({plus, target, {"deviation_kg", Numbers{0, 0}}}).substr(0, 62),
            "deviation_kg: 'kg' is not a unit of a length or an angle; expe");
  EXPECT_EQ(
      refused_columns({plus, {"target_mm", Numbers{0, 0}}, {"deviation_um", Numbers{0, 0}}, {"run", Words{"a", "a"}}}),
      "run[1]: run a approaches this target twice from the same side, first in row 0; expected one reading per "
      "run, direction and target");
  EXPECT_EQ(refused_columns({{"direction", Numbers{1, -1}}, target, {"deviation_um", Numbers{0, 0}}}),
            "direction[0]: '1' is not a direction of approach; expected + or -");
  EXPECT_EQ(refused_columns({plus, plus, target}), "direction: this column is given twice");
  EXPECT_EQ(refused_columns({{"direction", Words{"+", ""}}, target, {"deviation_um", Numbers{0, 0}}}),
            "direction[1]: is empty; expected a name");
}

TEST(NamedColumns, OfTheOtherKindsAreThoseOfTheirFiles) {
  const CircularFile circle =
      parse_circular({{"direction", Words{"cw"}}, {"angle_deg", Numbers{90}}, {"deviation_um", Numbers{3}}}, 100);
  EXPECT_EQ(circle.paths[0].radius, Numbers{100 + 0.003});
  EXPECT_EQ(message_of([] {
              parse_circular({{"direction", Words{"cw"}}, {"X_mm", Numbers{0}}, {"Y_mm", Numbers{0}}}, 100);
            }),
            "X_mm[0]: the point is the centre; expected coordinates from the centre of the nominal circle");
  EXPECT_EQ(message_of([] {
              parse_straightness({{"position_mm", Numbers{0, 1e-9, 2}}, {"deviation_um", Numbers(3)}});
            }),
            "position_mm[1]: this position is nearly the same as that of row 0: 1e-09 mm from it; expected the same "
            "position, or at least 1e-6 mm between positions");
  EXPECT_EQ(message_of([] {
              parse_squareness({{"line", Words{"X"}}, {"position_mm", Numbers{0}}, {"deviation_um", Numbers{0}}});
            }),
            "line: 1 line is named; expected two lines, such as X and Y");
  EXPECT_EQ(parse_rotation({{"angle_deg", Numbers{350, 10}}, {"x1_um", Numbers{1, 2}}}).x1, (Numbers{0.001, 0.002}));
  EXPECT_EQ(message_of([] {
              parse_rotation({{"angle_deg", Numbers{10, 10}}, {"x1_um", Numbers{1, 2}}});
            }).substr(0, 12),
            "angle_deg[1]");
  EXPECT_EQ(parse_sections({{"section", Words{"A"}}, {"across_um", Numbers{1}}, {"height_mm", Numbers{2}}})
                .front()
                .points(0, 0),
            0.001);
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message_of([&] {
              parse_linkage({{"mark", Words{"exit", "exit"}}, {"Z_mm", Numbers{1, 2}}, {"X_mm", Numbers{none, none}}});
            }),
            "mark[1]: 'exit' is already in row 0; expected one such row");
}

}  // namespace
}  // namespace abbe
