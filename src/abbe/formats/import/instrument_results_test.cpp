// QIF, MTConnect and DMIS.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abbe/formats/import/instrument_for_test.h"
#include "abbe/formats/text/replaced_text_for_test.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kQif =
    "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>\n"
    "<QIFDocument xmlns=\"http://qifstandards.org/xsd/qif3\" versionQIF=\"3.0.0\">\n"
    "<FileUnits><PrimaryUnits><LinearUnit><SIUnitName>meter</SIUnitName><UnitName>mm</UnitName>\n"
    "<UnitConversion><Factor>0.001</Factor></UnitConversion></LinearUnit></PrimaryUnits></FileUnits>\n"
    "<Features><FeatureItems><PointFeatureItem id=\"7\"><FeatureName>P, 1</FeatureName></PointFeatureItem>\n"
    "</FeatureItems></Features>\n"
    "<Results><MeasurementResultsSet><MeasurementResults id=\"9\"><MeasuredFeatures>\n"
    "<PointFeatureMeasurement id=\"11\"><FeatureItemId>7</FeatureItemId>\n"
    "<Location>\n1.50 -2 3e1\n</Location></PointFeatureMeasurement>\n"
    "<PointFeatureMeasurement id=\"12\"><FeatureItemId>8</FeatureItemId><Location>4 5 6</Location>\n"
    "</PointFeatureMeasurement>\n"
    "<CircleFeatureMeasurement id=\"13\"><Location>0 0 0</Location></CircleFeatureMeasurement>\n"
    "</MeasuredFeatures><MeasuredPointSets><MeasuredPointSet id=\"29\" count=\"2\"><Points>\n"
    "1 2 3\n4 5 6\n</Points><Compensated>false</Compensated><ProbeRadius>2.5</ProbeRadius></MeasuredPointSet>\n"
    "</MeasuredPointSets></MeasurementResults></MeasurementResultsSet></Results>\n"
    "</QIFDocument>\n";

std::string qif_refusal(const std::string& from, const std::string& to) {
  return refusal_of("qif", test::replaced(kQif, from, to));
}

/// Without its points; then the sets of points are read.
std::string qif_of_sets() {
  std::string text = kQif;
  for (int i = 0; i < 2; ++i) {
    const std::size_t begin = text.find("<PointFeatureMeasurement");
    const std::string end = "</PointFeatureMeasurement>";
    text.erase(begin, text.find(end) + end.size() - begin);
  }
  return text;
}

TEST(QifResults, HaveMeasuredPointsWithTheNamesOfTheirFeatures) {
  const InstrumentTable table = read_as("qif", kQif);
  EXPECT_EQ(table.kind, ImportKind::points);
  EXPECT_EQ(table.rows, "\"P, 1\",1.50,-2,3e1\n8,4,5,6\n");
  EXPECT_THAT(table.lines, ElementsAre(10, 12));
  EXPECT_EQ(table.columns[1].unit, "mm");
  EXPECT_TRUE(table.columns[1].unit_is_stated);
  EXPECT_THAT(table.doubts, IsEmpty());
  EXPECT_THAT(table.not_read, ElementsAre("CircleFeatureMeasurement", "MeasuredPointSet"));
  EXPECT_THAT(table.reasons, ElementsAre("2 measured points"));
}

TEST(QifResults, OfVersionTwoHaveActuals) {
  std::string text = kQif;
  for (int i = 0; i < 2; ++i) {
    text = test::replaced(text, "<PointFeatureMeasurement", "<PointFeatureActual");
    text = test::replaced(text, "</PointFeatureMeasurement", "</PointFeatureActual");
  }
  EXPECT_EQ(read_as("qif", text).rows, read_as("qif", kQif).rows);
}

TEST(QifResults, WithoutPointFeaturesHaveSetsOfPoints) {
  const InstrumentTable table = read_as("qif", qif_of_sets());
  EXPECT_EQ(table.rows, "set 29,1,2,3\nset 29,4,5,6\n");
  EXPECT_EQ(table.lines[1], table.lines[0] + 1);
  EXPECT_THAT(table.doubts,
              ElementsAre("the points of set 29 are centres of a probe of radius 2.5, not on the surface"));
  EXPECT_THAT(read_as("qif", test::replaced(qif_of_sets(), ">false<", ">true<")).doubts, IsEmpty());
  EXPECT_THAT(refusal_of("qif", test::replaced(qif_of_sets(), "count=\"2\"", "count=\"3\"")),
              HasSubstr("Points: 6 numbers, and the count is 3; expected three coordinates for each point"));
}

TEST(QifResults, AreInTheUnitThatTheyState) {
  EXPECT_EQ(read_as("qif", test::replaced(kQif, "0.001", "0.0254")).columns[1].unit, "inch");
  EXPECT_EQ(read_as("qif", test::replaced(kQif, "<UnitConversion><Factor>0.001</Factor></UnitConversion>", ""))
                .columns[1]
                .unit,
            "m");
  EXPECT_EQ(qif_refusal("0.001", "0.5"),
            "t:4: LinearUnit: 'mm' of 0.5 meter is not read; expected a unit of 1, 0.01, 0.001, 0.000001, 0.0254 or "
            "0.3048 meter");
  EXPECT_THAT(qif_refusal("0.001", "x"), HasSubstr("t:4: Factor: 'x' is not a number; expected a number of metres"));
  const std::string unitless =
      test::replaced(test::replaced(kQif, "<LinearUnit>", "<LengthUnit>"), "</LinearUnit>", "</LengthUnit>");
  EXPECT_THAT(read_as("qif", unitless).columns[1].doubts, ElementsAre(HasSubstr("metres are assumed")));
  ImportHints hints;
  hints.length_unit = "mm";
  EXPECT_THAT(read_as("qif", unitless, hints).columns[1].doubts, IsEmpty());
}

TEST(QifResults, OfSeveralPartsAreInDoubt) {
  EXPECT_THAT(read_as("qif", test::replaced(kQif, "<MeasurementResults id=\"9\">",
                                            "<MeasurementResults id=\"8\"/><MeasurementResults id=\"9\">"))
                  .doubts,
              ElementsAre("the points are of 2 MeasurementResults, which need not be of one part"));
}

TEST(QifResults, AreRefusedWhereTheyAreNotWhole) {
  EXPECT_EQ(qif_refusal("1.50 -2 3e1", "1.50 -2"),
            "t:9: Location: it has 2 numbers; expected three coordinates in the LinearUnit of the file");
  EXPECT_EQ(qif_refusal("1.50 -2 3e1", "1.50 -2 north"),
            "t:10: Location: 'north' is not a number; expected three coordinates in the LinearUnit of the file");
  EXPECT_THAT(
      qif_refusal("</QIFDocument>", ""),
      HasSubstr("t:21:1: the document ends within QIFDocument, so it is incomplete; expected a document of QIF"));
  EXPECT_THAT(qif_refusal("?>\n", "?>\n<!DOCTYPE a [<!ENTITY b \"c\">]>\n"), HasSubstr("a DOCTYPE"));
  EXPECT_EQ(refusal_of("qif", "<a/>"), "t:1: the root is a; expected QIFDocument");
  EXPECT_EQ(refusal_of("qif", "<QIFDocument/>"),
            "t: there are no measured points; expected PointFeatureMeasurement with Location, or MeasuredPointSet with "
            "Points");
  for (std::size_t length = 0; length + 1 < kQif.size(); ++length) {
    const std::string message = refusal_of("qif", kQif.substr(0, length));
    EXPECT_THAT(message, HasSubstr("expected a document of QIF")) << length;
  }
}

const std::string kStreams =
    "<m:MTConnectStreams xmlns:m=\"urn:mtconnect.org:MTConnectStreams:1.8\">\n"
    "<m:Header creationTime=\"2026-05-04T10:20:00Z\" version=\"1.8.0\"/>\n"
    "<m:Streams><m:DeviceStream name=\"mill\"><m:ComponentStream component=\"Path\"><m:Samples>\n"
    "<m:PathPosition dataItemId=\"p\" subType=\"ACTUAL\" timestamp=\"10:00\">1.5 -2 3</m:PathPosition>\n"
    "<m:PathPosition dataItemId=\"p\" subType=\"ACTUAL\" timestamp=\"10:01\">UNAVAILABLE</m:PathPosition>\n"
    "<m:PathPosition dataItemId=\"p\" subType=\"ACTUAL\" timestamp=\"10:02\">\n 4 5 6\n</m:PathPosition>\n"
    "<m:PathPosition dataItemId=\"q\" subType=\"COMMANDED\" timestamp=\"10:02\">4 5 7</m:PathPosition>\n"
    "<m:PathPosition dataItemId=\"x\" timestamp=\"10:02\">4</m:PathPosition>\n"
    "<m:Temperature dataItemId=\"t\" timestamp=\"10:02\">22.5</m:Temperature>\n"
    "</m:Samples></m:ComponentStream></m:DeviceStream></m:Streams></m:MTConnectStreams>\n";

TEST(MTConnectPositions, AreWhereTheMachineWas) {
  const InstrumentTable table = read_as("mtconnect", kStreams);
  EXPECT_EQ(table.rows, "10:00,1.5,-2,3\n10:02,4,5,6\n");
  EXPECT_THAT(table.lines, ElementsAre(4, 7));
  EXPECT_EQ(table.columns[1].unit, "mm");
  EXPECT_TRUE(table.columns[1].unit_is_stated);
  EXPECT_THAT(table.doubts, IsEmpty());
  EXPECT_THAT(table.not_read, ElementsAre("PathPosition 'p', ACTUAL UNAVAILABLE", "PathPosition 'q', COMMANDED",
                                          "PathPosition 'x' of one coordinate", "Temperature"));
  EXPECT_THAT(table.reasons, ElementsAre("PathPosition 'p', ACTUAL, device 'mill': 2 positions in work coordinates"));
}

TEST(MTConnectPositions, OfAProbeComeFirst) {
  EXPECT_EQ(read_as("mtconnect", test::replaced(kStreams, "COMMANDED", "PROBE")).rows, "10:02,4,5,7\n");
}

TEST(MTConnectPositions, ThatOnlyWereCommandedOrAreTwiceAreInDoubt) {
  EXPECT_THAT(read_as("mtconnect", test::replaced(kStreams, "COMMANDED", "ACTUAL")).doubts,
              ElementsAre("PathPosition 'p', ACTUAL of 'mill' is read, and there is PathPosition 'q', ACTUAL of 'mill' "
                          "too"));
  std::string commanded = kStreams;
  for (int i = 0; i < 3; ++i) commanded = test::replaced(commanded, "ACTUAL", "TARGET");
  const InstrumentTable table = read_as("mtconnect", test::replaced(commanded, "COMMANDED", "ACTUAL"));
  EXPECT_EQ(table.rows, "10:02,4,5,7\n");
  EXPECT_THAT(read_as("mtconnect", commanded).doubts,
              testing::Contains("PathPosition 'p', TARGET is the commanded position, not the actual one"));
}

TEST(MTConnectPositions, AreRefusedWhereTheyAreNotThree) {
  EXPECT_EQ(refusal_of("mtconnect", test::replaced(kStreams, "1.5 -2 3", "1.5 -2")),
            "t:4: PathPosition: it has 2 numbers; expected three coordinates in mm, or UNAVAILABLE");
  EXPECT_EQ(refusal_of("mtconnect", test::replaced(kStreams, "1.5 -2 3", "1.5 -2 NaN")),
            "t:4: PathPosition: 'NaN' is not a finite number; expected three coordinates in mm, or UNAVAILABLE");
  EXPECT_THAT(refusal_of("mtconnect", "<MTConnectStreams/>"),
              HasSubstr("t: there are no positions; expected elements"));
  EXPECT_THAT(refusal_of("mtconnect", kStreams.substr(0, 300)), HasSubstr("expected an answer of an MTConnect agent"));
  EXPECT_EQ(refusal_of("mtconnect", "<MTConnectDevices/>"),
            "t:1: the root is MTConnectDevices; expected MTConnectStreams");
}

const std::string kDmis =
    "FILNAM/'a, b',5.3\n$$ FA(P0)=FEAT/POINT,CART,9,9,9,0,0,1\nUNITS/MM,ANGDEC\n"
    "F(P1)=FEAT/POINT,CART,1,2,3,0,0,1\nFA(P1)=FEAT/POINT,CART,1.5,-2,3,0,0,1\n"
    "fa(P 2) = feat/point, cart, 4, 5, $\n6,0,1,0\nFA(C)=FEAT/CIRCLE,INNER,CART,0,0,0,0,0,1,12\n"
    "OUTPUT/FA(C),TA(D)\nENDFIL\n";

TEST(DmisOutput, HasMeasuredPointsWithNormals) {
  const InstrumentTable table = read_as("dmis", kDmis);
  EXPECT_EQ(table.rows, "P1,1.5,-2,3,0,0,1\nP 2,4,5,6,0,1,0\n");
  EXPECT_THAT(table.lines, ElementsAre(5, 6));
  ASSERT_EQ(table.columns.size(), 7U);
  EXPECT_EQ(table.columns[1].unit, "mm");
  EXPECT_TRUE(table.columns[1].unit_is_stated);
  EXPECT_EQ(table.columns[6].base, "nz");
  EXPECT_THAT(table.doubts, IsEmpty());
  EXPECT_THAT(table.not_read, ElementsAre("F FEAT/POINT", "FA FEAT/CIRCLE", "OUTPUT"));
  ASSERT_EQ(table.facts.size(), 1U);
  EXPECT_EQ(table.facts[0].value, "'a, b',5.3");
}

TEST(DmisOutput, StatesItsUnitOrIsInDoubt) {
  EXPECT_EQ(read_as("dmis", test::replaced(kDmis, "UNITS/MM", "UNITS/INCH")).columns[1].unit, "inch");
  const std::string unitless = test::replaced(kDmis, "UNITS/MM,ANGDEC\n", "");
  EXPECT_THAT(read_as("dmis", unitless).columns[1].doubts, ElementsAre(HasSubstr("millimetres are assumed")));
  ImportHints hints;
  hints.length_unit = "um";
  EXPECT_EQ(read_as("dmis", unitless, hints).columns[1].unit, "um");
  EXPECT_EQ(refusal_of("dmis", test::replaced(kDmis, "UNITS/MM", "UNITS/YARD")),
            "t:3: UNITS: 'YARD' is not a unit of DMIS; expected MM, CM, M, INCH or FEET");
  EXPECT_EQ(refusal_of("dmis", test::replaced(kDmis, "OUTPUT/FA(C),TA(D)", "UNITS/CM")),
            "t:9: UNITS: the unit becomes cm behind points in mm; expected one unit for all points");
}

TEST(DmisOutput, OfNominalPointsOrOfTwoCoordinateSystemsIsInDoubt) {
  const InstrumentTable nominal = read_as("dmis", "UNITS/MM\nF(P1)=FEAT/POINT,CART,1,2,3,0,0,1\nENDFIL\n");
  EXPECT_EQ(nominal.rows, "P1,1,2,3,0,0,1\n");
  EXPECT_THAT(nominal.doubts, ElementsAre(HasSubstr("which are nominal, and none FA(...)")));
  EXPECT_THAT(read_as("dmis", test::replaced(kDmis, "fa(P 2)", "D(B)=TRANS/XORIG,10\nfa(P 2)")).doubts,
              ElementsAre("line 6 changes the coordinate system between points"));
  EXPECT_THAT(read_as("dmis", test::replaced(kDmis, "fa(P 2)", "RECALL/D(B)\nfa(P 2)")).doubts,
              ElementsAre("line 6 changes the coordinate system between points"));
  EXPECT_THAT(read_as("dmis", test::replaced(kDmis, "UNITS", "D(B)=DATSET/MCS\nUNITS")).doubts, IsEmpty());
  EXPECT_THAT(read_as("dmis", test::replaced(kDmis, "ENDFIL\n", "")).doubts,
              ElementsAre("the file does not end in ENDFIL, so it may be cut short"));
}

TEST(DmisOutput, RefusesPointsThatAreNotWhole) {
  const std::string expected = "; expected FEAT/POINT,CART,x,y,z,i,j,k with coordinates in mm";
  EXPECT_EQ(refusal_of("dmis", test::replaced(kDmis, "1.5,-2,3,0,0,1", "1.5,-2,3")),
            "t:5: FA(P1): the point has 3 numbers" + expected);
  EXPECT_EQ(refusal_of("dmis", test::replaced(kDmis, "1.5,-2,3", "1.5,-2,")),
            "t:5: FA(P1): '' is not a number" + expected);
  EXPECT_EQ(refusal_of("dmis", test::replaced(kDmis, "1.5,-2,3", "1.5,-2,Q")),
            "t:5: FA(P1): 'Q' is not a number" + expected);
  EXPECT_EQ(refusal_of("dmis", test::replaced(kDmis, "POINT,CART,1.5", "POINT,POL,1.5")),
            "t:5: FA(P1): the point is not in Cartesian coordinates" + expected);
  EXPECT_EQ(refusal_of("dmis", test::replaced(kDmis, "FA(P1)", "FB(P1)")),
            "t:5: FEAT: 'FB(P1)' is no label of a feature; expected FA(NAME) or F(NAME)");
  EXPECT_EQ(refusal_of("dmis", "FILNAM/'a'\nFEAT/\n"),
            "t:2: FEAT: '' is no label of a feature; expected FA(NAME) or "
            "F(NAME)");
  EXPECT_EQ(refusal_of("dmis", "FILNAM/'a'\nENDFIL\n"),
            "t: FEAT: there are no points; expected FA(NAME)=FEAT/POINT,CART,x,y,z,i,j,k");
  EXPECT_EQ(refusal_of("dmis", "UNITS/MM\nFA(P1)=FEAT/POINT,$"),
            "t:2: the last statement continues in a line that is missing; expected a line below '$'");
}

}  // namespace
}  // namespace abbe
