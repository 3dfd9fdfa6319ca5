#include "abbe/formats/controls/table_siemens.h"

#include <gmock/gmock.h>

#include "abbe/formats/controls/table_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

const std::vector<TableAxisName> kAxes = {{0, "X1", false}, {1, "Z1", false}, {2, "C1", true}};

TEST(SiemensTable, SagOfOneAxisForAnotherIsWrittenAsTheManualShowsIt) {
  AxisTable table;
  table.input = 0;
  table.output = 1;
  table.positions = {-400, 0, 400};
  table.forward = table.reverse = {0, 0.01, 0.012};
  EXPECT_EQ(siemens_cec_text({table}, kAxes, 3),
            "%_N_NC_CEC_INI\nCHANDATA(1)\n"
            "$AN_CEC[3,0]=0\n$AN_CEC[3,1]=0.01\n$AN_CEC[3,2]=0.012\n"
            "$AN_CEC_INPUT_AXIS[3]=(X1)\n$AN_CEC_OUTPUT_AXIS[3]=(Z1)\n"
            "$AN_CEC_STEP[3]=400\n$AN_CEC_MIN[3]=-400\n$AN_CEC_MAX[3]=400\n"
            "$AN_CEC_DIRECTION[3]=0\n$AN_CEC_MULT_BY_TABLE[3]=0\n$AN_CEC_IS_MODULO[3]=0\nM17\n");
}

TEST(SiemensTable, EncoderCompensationHoldsTheErrorBecauseItIsAddedToTheActualPosition) {
  AxisTable table;
  table.positions = {-200, 400};
  table.forward = table.reverse = {-0.003, 0.01};
  EXPECT_EQ(siemens_eec_text({table}, kAxes, 0),
            "%_N_AX_EEC_INI\nCHANDATA(1)\n"
            "$AA_ENC_COMP[0,0,X1]=0.003\n$AA_ENC_COMP[0,1,X1]=-0.01\n"
            "$AA_ENC_COMP_STEP[0,X1]=600\n$AA_ENC_COMP_MIN[0,X1]=-200\n$AA_ENC_COMP_MAX[0,X1]=400\n"
            "$AA_ENC_COMP_IS_MODULO[0,X1]=0\nM17\n");
}

TEST(SiemensTable, WhatIsWrittenIsReadBackToItsDigits) {
  std::vector<AxisTable> tables = {test::some_table(0, 0, 38, 1), test::some_table(0, 1, 77, 2),
                                   test::some_table(1, 1, 5, 3)};
  tables.push_back(test::some_turn(2, 36));
  tables.back().modulo = true;
  const std::vector<AxisTable> read = parse_siemens_cec(siemens_cec_text(tables, kAxes, 0), "CEC.INI", kAxes);
  ASSERT_EQ(read.size(), tables.size());
  for (std::size_t t = 0; t < read.size(); ++t) test::expect_near(read[t], tables[t], 1e-8, 0.51e-6);
  tables.erase(tables.begin() + 1);
  const std::vector<AxisTable> own = parse_siemens_eec(siemens_eec_text(tables, kAxes, 1), "EEC.INI", kAxes);
  ASSERT_EQ(own.size(), tables.size());
  for (std::size_t t = 0; t < own.size(); ++t) test::expect_near(own[t], tables[t], 1e-8, 0.51e-6);
}

TEST(SiemensTable, DirectionsThatDifferBecomeTwoTables) {
  AxisTable table = test::some_table(0, 0, 11, 4);
  for (double& value : table.reverse) value += 0.002;
  const std::vector<AxisTable> read = parse_siemens_cec(siemens_cec_text({table}, kAxes, 0), "CEC.INI", kAxes);
  ASSERT_EQ(read.size(), 2U);
  for (const double q : {-100.0, 3.0, 333.3}) EXPECT_NEAR(read[0].at(q) + read[1].at(q), table.at(q), 1e-6);
}

TEST(SiemensTable, CommentsAndTheManualsBlanksAreRead) {
  const std::string text =
      "%_N_NC_CEC_INI\r\nCHANDATA(1)\r\n$AN_CEC [0,0] =0 ; 1. compensation value\r\n$an_cec[0,1]=0.01\r\n"
      "$AN_CEC_INPUT_AXIS[0] =(X1) ; basic axis\n$AN_CEC_OUTPUT_AXIS[0]=\"Z1\"\n$AN_CEC_STEP[0]=6.73\n"
      "$AN_CEC_MIN[0]=-400.0\n$AN_CEC_MAX[0]=-393.27\nM17\n";
  const std::vector<AxisTable> read = parse_siemens_cec(text, "CEC.INI", kAxes);
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].output, 1U);
  EXPECT_EQ(read[0].forward[1], 0.01);
}

TEST(SiemensTable, WhatIsWrongIsRefusedWithItsPlace) {
  const auto refused = [](const std::string& text) {
    return test::refusal([&] { parse_siemens_cec(text, "CEC.INI", kAxes); });
  };
  const std::string head = "$AN_CEC[0,0]=0\n$AN_CEC[0,1]=0\n$AN_CEC_INPUT_AXIS[0]=(X1)\n$AN_CEC_OUTPUT_AXIS[0]=(Z1)\n";
  const std::string ends = "$AN_CEC_STEP[0]=1\n$AN_CEC_MIN[0]=0\n$AN_CEC_MAX[0]=1\n";
  EXPECT_NO_THROW(parse_siemens_cec(head + ends, "CEC.INI", kAxes));
  EXPECT_THAT(refused(head), HasSubstr("step or ends are missing"));
  EXPECT_THAT(refused(head + ends + "$AN_CEC[0,5]=0\n"), HasSubstr("a value for every point"));
  EXPECT_THAT(refused(head + ends + "$AN_CEC[0,2]=0\n"), HasSubstr("a last point at _MAX"));
  EXPECT_THAT(refused(head + ends + "$AN_CEC[0,1]=0\n"), HasSubstr("CEC.INI:8: $AN_CEC: is given twice"));
  EXPECT_THAT(refused(head + ends + "$AN_CEC_MULT_BY_TABLE[0]=2\n"), HasSubstr("products of tables are not read"));
  EXPECT_THAT(refused("$AN_CEC_INPUT_AXIS[0]=(Q9)\n"), HasSubstr("X1, Z1 or C1"));
  EXPECT_THAT(refused("$AN_CEC[0,1e300]=0\n"), HasSubstr("$AN_CEC"));
  EXPECT_THAT(refused("G1 X0\n"), HasSubstr("CEC.INI:1"));
  EXPECT_THAT(refused("$AN_CEC[0]\n"), HasSubstr("is not an assignment"));
  EXPECT_THAT(refused(""), HasSubstr("no tables"));
  EXPECT_THAT(test::refusal([&] { parse_siemens_eec("$AA_ENC_COMP[0,0,Y1]=1\n", "EEC.INI", kAxes); }),
              HasSubstr("unknown axis 'Y1'"));
}

}  // namespace
}  // namespace abbe
