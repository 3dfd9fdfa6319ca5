// Forms of files that state something beside readings or instead of them, and readings that are no points.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abbe/formats/import/instrument_for_test.h"
#include "abbe/formats/import/known_program.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> facts_of(const InstrumentTable& table) {
  std::vector<std::string> facts;
  for (const InstrumentFact& fact : table.facts) facts.push_back(fact.name + ": " + fact.value);
  return facts;
}

TEST(BallBarResults, AreStatedWithTheirUnits) {
  const std::string text =
      "<?xml version=\"1.0\"?>\n<TEST><TEST_SPEC NAME=\"XY 360\"/><PLANE TEST_PLANE=\"XY\"/>\n"
      "<OPERATOR> A. B. </OPERATOR><MACHINE_TESTED NAME=\"mill\"/>\n"
      "<FEATURE NAME=\"AF_CIRCULARITY\" DT=\"UT_LENGTH_UM\"> 8.4 </FEATURE>\n"
      "<FEATURE NAME=\"AF_SQUARENESS\" DT=\"UT_SQUARENESS\">-12.5</FEATURE>\n"
      "<FEATURE NAME=\"AF_NEW\" DT=\"UT_NEW\">3</FEATURE></TEST>\n";
  EXPECT_EQ(recognise_instrument(text)->format->name, "renishaw-ballbar");
  const InstrumentTable table = read_as("renishaw-ballbar", text);
  EXPECT_EQ(table.kind, ImportKind::circular);
  EXPECT_THAT(table.columns, IsEmpty());
  EXPECT_THAT(facts_of(table),
              ElementsAre("test: XY 360", "plane: XY", "operator: A. B.", "machine: mill", "AF_CIRCULARITY: 8.4 um",
                          "AF_SQUARENESS: -12.5 um/m", "AF_NEW: 3 (UT_NEW)"));
  EXPECT_THAT(table.doubts, ElementsAre(HasSubstr("readings is not publicly described")));
  EXPECT_THAT(refusal_of("renishaw-ballbar", "<TEST/>"), HasSubstr("there are no figures"));
  EXPECT_THAT(refusal_of("renishaw-ballbar", "<TEST><FEATURE"), HasSubstr("results of a Renishaw ball bar"));
}

const std::string kEcmc =
    "TEST_DATA=# Input data file for ISO230-2 calcs derived from: x.log\n#     UNIT : Unit\nREF_PV=IOC:Ref\nUNIT=um\n"
    "CYCLES=1\nPOSITIONS=2\nDEC=5\nTGT_DATA[1]=-20\nREF_DATA_FWD[1,1]=-20.5\nTGT_DATA[2]=0\nREF_DATA_FWD[2,1]=-.25\n"
    "REF_DATA_BWD[1,1]=-19.5\nREF_DATA_BWD[2,1]=.75\n  \n";

TEST(EcmcPositioning, HasTargetsAndReadingsOfBothDirections) {
  EXPECT_EQ(recognise_instrument(kEcmc)->format->name, "ecmc-positioning");
  const InstrumentTable table = read_as("ecmc-positioning", kEcmc);
  EXPECT_EQ(table.kind, ImportKind::positioning);
  EXPECT_EQ(table.rows, "1,+,-20,-20.5\n1,+,0,-.25\n1,-,-20,-19.5\n1,-,0,.75\n");
  EXPECT_THAT(table.lines, ElementsAre(9, 11, 12, 13));
  EXPECT_THAT(facts_of(table), ElementsAre("REF_PV: IOC:Ref", "DEC: 5"));
  ASSERT_EQ(table.columns.size(), 4U);
  EXPECT_EQ(table.columns[2].unit, "um");
  EXPECT_THAT(table.columns[1].doubts, ElementsAre(HasSubstr("FWD")));
  EXPECT_THAT(table.doubts, IsEmpty());
}

TEST(EcmcPositioning, RefusesWhatIsNotWhole) {
  const auto refused = [](const std::string& text) { return refusal_of("ecmc-positioning", text); };
  EXPECT_EQ(refused("TGT_DATA[1]=1\nREF_DATA_FWD[1,1]=x\n"),
            "t:2: REF_DATA_FWD[1,1]: 'x' is not a number; expected a position in the unit of the file");
  EXPECT_EQ(refused("TGT_DATA[1]=1\nREF_DATA_FWD[2,1]=2\n"),
            "t:2: position 2 has no target; expected a line TGT_DATA[2]=");
  EXPECT_THAT(refused("TGT_DATA[1]=1\nTGT_DATA[1]=1\n"), HasSubstr("t:2: TGT_DATA[1]: it is there twice"));
  EXPECT_THAT(refused("TGT_DATA[1]=1\nREF_DATA_FWD[1]=1\n"), HasSubstr("has 1 number in brackets"));
  EXPECT_THAT(refused("TGT_DATA[1]=1\nREF_DATA_FWD[1,1=1\n"), HasSubstr("the bracket is not closed"));
  EXPECT_THAT(refused("TGT_DATA[1]=1\n"), HasSubstr("there are no readings"));
  EXPECT_THAT(refused("TGT_DATA[1]=1\nREF_DATA\n"), HasSubstr("'REF_DATA' has no '='"));
  EXPECT_THAT(refused("UNIT=furlong\n"), HasSubstr("t:1: UNIT: 'furlong' is not a unit"));
  const InstrumentTable cut = read_as("ecmc-positioning", kEcmc.substr(0, kEcmc.find("REF_DATA_BWD[2")));
  EXPECT_THAT(cut.doubts, ElementsAre("the file states 2 positions and 1 cycles, 4 readings in both directions, and "
                                      "has 3"));
}

TEST(MtconnectTemperatures, AreOfASensorAndATime) {
  const std::string text =
      "<MTConnectStreams><Streams><DeviceStream name=\"mill\"><ComponentStream name=\"X\"><Samples>\n"
      "<Temperature dataItemId=\"t1\" timestamp=\"2026-05-04T10:00:00Z\">22.5</Temperature>\n"
      "<Temperature dataItemId=\"t1\" timestamp=\"2026-05-04T10:01:00Z\">UNAVAILABLE</Temperature>\n"
      "<Load dataItemId=\"l\" timestamp=\"2026-05-04T10:01:00Z\">3</Load>\n"
      "</Samples></ComponentStream></DeviceStream></Streams></MTConnectStreams>\n";
  EXPECT_EQ(recognise_instrument(text)->format->name, "mtconnect-temperatures");
  const InstrumentTable table = read_as("mtconnect-temperatures", text);
  EXPECT_EQ(table.kind, ImportKind::temperatures);
  EXPECT_EQ(table.rows, "2026-05-04T10:00:00Z,X t1,22.5\n");
  EXPECT_THAT(table.lines, ElementsAre(2));
  EXPECT_THAT(table.not_read, ElementsAre("Load", "Temperature UNAVAILABLE"));
  const std::string begin = "<MTConnectStreams><Samples><Temperature dataItemId=\"t\"",
                    end = "</Samples></MTConnectStreams>";
  EXPECT_THAT(refusal_of("mtconnect-temperatures", begin + ">5</Temperature>" + end), HasSubstr("it has no timestamp"));
  EXPECT_THAT(refusal_of("mtconnect-temperatures", begin + " timestamp=\"t\">hot</Temperature>" + end),
              HasSubstr("'hot' is not a number"));
  EXPECT_THAT(refusal_of("mtconnect-temperatures", "<MTConnectStreams/>"), HasSubstr("there are no temperatures"));
  // With positions it is read as these.
  EXPECT_EQ(
      recognise_instrument("<MTConnectStreams><Samples><PathPosition/><Temperature /></Samples></MTConnectStreams>")
          ->format->name,
      "mtconnect");
}

std::string devices(const std::string& axes) {
  return "<MTConnectDevices><Devices><Device id=\"d\"><Components><Axes id=\"a\"><Components>\n" + axes +
         "</Components></Axes></Components></Device></Devices></MTConnectDevices>\n";
}

TEST(MtconnectDevices, StateTheirAxesAndTheirChain) {
  const std::string text = devices(
      "<Linear id=\"y\" name=\"Y\"><Configuration><Motion id=\"my\" type=\"PRISMATIC\" actuation=\"DIRECT\">"
      "<Axis>0 1 0</Axis></Motion></Configuration></Linear>\n"
      "<Rotary id=\"c\" name=\"C\"><Configuration><Motion id=\"mc\" parentIdRef=\"my\" type=\"CONTINUOUS\">"
      "<Origin>10 0 -50.5</Origin><Axis>0 0 1</Axis></Motion></Configuration></Rotary>\n"
      "<Linear id=\"z\" name=\"Z\"/>\n");
  EXPECT_EQ(recognise_instrument(text)->format->name, "mtconnect-devices");
  const InstrumentTable table = read_as("mtconnect-devices", text);
  EXPECT_THAT(table.columns, IsEmpty());
  EXPECT_THAT(facts_of(table),
              ElementsAre("Linear Y: linear axis, along or about (0, 1, 0), carried by nothing",
                          "Rotary C: endless rotary axis, along or about (0, 0, 1), at (10, 0, -50.5) mm, carried by "
                          "Linear Y",
                          "chain: Linear Y, Rotary C", "axes without Motion: Linear Z"));
  EXPECT_THAT(table.doubts, ElementsAre(HasSubstr("it describes a machine and has no readings")));
}

TEST(MtconnectDevices, RefuseChainsThatHaveNoBeginning) {
  const auto refused = [](const std::string& motions) {
    std::string axes;
    for (const char* const name : {"X", "Y"}) {
      axes += std::string("<Linear name=\"") + name + "\"><Configuration>" + motions + "</Configuration></Linear>";
    }
    return refusal_of("mtconnect-devices", devices(axes));
  };
  EXPECT_THAT(refused("<Motion id=\"a\" type=\"FIXED\"/>"), HasSubstr("the id 'a' is there twice"));
  EXPECT_THAT(refused("<Motion parentIdRef=\"b\"/>"), HasSubstr("there is no Motion 'b'"));
  EXPECT_THAT(refused("<Motion><Axis>0 1</Axis></Motion>"), HasSubstr("Axis: it has 2 numbers"));
  EXPECT_THAT(
      refusal_of("mtconnect-devices",
                 devices("<Linear><Configuration><Motion id=\"a\" parentIdRef=\"b\"/></Configuration></Linear>"
                         "<Linear><Configuration><Motion id=\"b\" parentIdRef=\"a\"/></Configuration></Linear>")),
      HasSubstr("the motions carry each other"));
  EXPECT_THAT(refusal_of("mtconnect-devices", devices("")), HasSubstr("no axes are described"));
}

TEST(KnownPrograms, AreRecognisedBySight) {
  const auto what = [](const std::string& text) {
    const std::optional<KnownProgram> known = known_program(text);
    return known ? std::string(known->what) : std::string();
  };
  EXPECT_THAT(what("// SA\nA::grp::p1 1.0 2.0 3.0\n"), HasSubstr("SpatialAnalyzer"));
  EXPECT_THAT(what("Rapport METROLOG X4\n"), HasSubstr("Metrolog"));
  EXPECT_THAT(what("SINUMERIK 840D\nMesszyklen\n"), HasSubstr("Siemens"));
  EXPECT_EQ(what("std::vector\n::\nx::y\n"), "");
  EXPECT_EQ(what(""), "");
}

}  // namespace
}  // namespace abbe
