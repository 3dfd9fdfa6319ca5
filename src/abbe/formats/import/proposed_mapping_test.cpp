#include "abbe/formats/import/proposed_mapping.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abbe/formats/import/imported_rows.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const Machine& table_of_import() {
  static const Machine machine = parse_machine(
      "name = \"m\"\nchain = \"w C' X' b Z t\"\n[axis.C]\nendless = true\n"
      "[axis.X]\ntravel_mm = [0, 1400]\n[axis.Z]\ntravel_mm = [0, 600]\n",
      "m.toml");
  return machine;
}

ProposedMapping proposal_for(const std::string& text, std::optional<ImportKind> kind, const ImportHints& hints = {}) {
  return propose_mapping(text, "t.txt", find_layout(text, "t.txt", hints.layout), kind, &table_of_import(), hints);
}

/// Names, units and conventions in one line, for comparison.
std::vector<std::string> columns_of(const ProposedMapping& proposed) {
  std::vector<std::string> words;
  for (const ProposedColumn& column : proposed.columns) {
    std::string word = column.column.name + "=" + std::to_string(column.source + 1);
    if (!column.column.unit.empty()) word += " " + column.column.unit;
    if (column.column.convention != ImportConvention::as_written) {
      word += " " + std::string(convention_name(column.column.convention));
    }
    if (!column.doubts.empty() || !column.sense_doubt.empty()) word += " ?";
    words.push_back(word);
  }
  return words;
}

TEST(ProposedColumns, OfPointsAreFoundByNamesOfSeveralPrograms) {
  const auto points = [](const std::string& text, const ImportHints& hints = {}) {
    return columns_of(proposal_for(text, ImportKind::points, hints));
  };
  EXPECT_THAT(points("x_mm,y_mm,z_mm,point\n1,2,3,a\n"), ElementsAre("point=4", "x_mm=1 mm", "y_mm=2 mm", "z_mm=3 mm"));
  EXPECT_THAT(points("Punkt Nr.;Pos. X [Zoll];Pos. Y [Zoll];Pos. Z [Zoll]\n7;1,5;2;3\n"),
              ElementsAre("point=1", "x_mm=2 inch", "y_mm=3 inch", "z_mm=4 inch"));
  EXPECT_THAT(points("Name;Northing;Easting;Height\n;m;m;m\na;1,5;2;3\n"),
              ElementsAre("point=1", "x_m=3 m", "y_m=2 m", "z_m=4 m"));
  EXPECT_THAT(points("X/um,Y/um,Z/um\n1.5,2,3\n"), ElementsAre("x_um=1 um", "y_um=2 um", "z_um=3 um"));
  EXPECT_THAT(points("X,Y,Z\n1.5,2,3\n"), ElementsAre("x_mm=1 mm ?", "y_mm=2 mm ?", "z_mm=3 mm ?"));
  EXPECT_THAT(points("X,Y,Z\n1.5,2,3\n", {.length_unit = "inch"}),
              ElementsAre("x_mm=1 inch", "y_mm=2 inch", "z_mm=3 inch"));
  EXPECT_THAT(points("x_mm,y_mm,z_mm\n1.5,2,3\n", {.mirrored = "y"}),
              ElementsAre("x_mm=1 mm", "y_mm=2 mm reversed", "z_mm=3 mm"));
  EXPECT_THAT(points("frame: left-handed\nx_mm,y_mm,z_mm\n1.5,2,3\n"),
              ElementsAre("x_mm=1 mm ?", "y_mm=2 mm", "z_mm=3 mm"));
  EXPECT_THAT(points("p1 1.5 2 3\n"), ElementsAre("point=1", "x_mm=2 mm ?", "y_mm=3 mm ?", "z_mm=4 mm ?"));
}

TEST(ProposedColumns, OfATrackerKeepCommandsAndPointsApart) {
  const auto tracker = [](const std::string& text, const ImportHints& hints = {}) {
    return columns_of(proposal_for(text, ImportKind::tracker, hints));
  };
  EXPECT_THAT(tracker("X[mm],Z[mm],C[deg],x[mm],y[mm],z[mm],SMR\n1.5,2,3,4,5,6,T1\n"),
              ElementsAre("C_deg=3 deg", "X_mm=1 mm", "Z_mm=2 mm", "reflector=7", "measured_x_mm=4 mm",
                          "measured_y_mm=5 mm", "measured_z_mm=6 mm"));
  // Twice the same name: the first is taken, and it is said.
  EXPECT_THAT(
      tracker("C_deg,X_mm,Z_mm,X[m],Y[m],Z[m]\n1.5,2,3,4,5,6\n"),
      ElementsAre("C_deg=1 deg", "X_mm=2 mm", "Z_mm=3 mm", "measured_x_m=4 m", "measured_y_m=5 m", "measured_z_m=6 m"));
  EXPECT_THAT(tracker("C,X,Z,X,Y,Z\ndeg,mm,mm,mm,mm,mm\n1.5,2,3,4,5,6\n"),
              ElementsAre("C_deg=1 deg", "X_mm=2 mm ?", "Z_mm=3 mm ?", "measured_x_mm=4 mm", "measured_y_mm=5 mm",
                          "measured_z_mm=6 mm"));
  // In inches X would leave its travel; Z would not, and C is beyond a turn of radians.
  EXPECT_THAT(tracker("X,Z,C,mx_mm,x_mm,y_mm,z_mm\n1390.5,2,-170,0,4,5,6\n"),
              ElementsAre("C_deg=3 deg", "X_mm=1 mm", "Z_mm=2 mm ?", "measured_x_mm=5 mm", "measured_y_mm=6 mm",
                          "measured_z_mm=7 mm"));
  EXPECT_THAT(tracker("1.5 2 3 4 5 6\n"),
              ElementsAre("C_deg=1 deg ?", "X_mm=2 mm ?", "Z_mm=3 mm ?", "measured_x_mm=4 mm ?", "measured_y_mm=5 mm ?",
                          "measured_z_mm=6 mm ?"));
}

TEST(ProposedColumns, OfAnglesHaveASenseAndAnOrigin) {
  const auto polar = [](const std::string& names, const std::string& angles, const ImportHints& hints = {}) {
    const std::string text = "C_deg;X_mm;Z_mm;range_mm;" + names + "\n1;2;3;1000,5;" + angles + "\n";
    const std::vector<std::string> all = columns_of(proposal_for(text, ImportKind::tracker, hints));
    return std::vector<std::string>(all.end() - 2, all.end());
  };
  EXPECT_THAT(polar("azimuth_deg;elevation_deg", "30;-10"), ElementsAre("azimuth_deg=5 deg", "elevation_deg=6 deg"));
  EXPECT_THAT(polar("Hz [gon];V [gon]", "30;110"),
              ElementsAre("azimuth_deg=5 gon clockwise ?", "elevation_deg=6 gon zenith"));
  EXPECT_THAT(polar("Hz [gon];V [gon]", "30;-10", {.clockwise = true}),
              ElementsAre("azimuth_deg=5 gon clockwise", "elevation_deg=6 gon"));
  EXPECT_THAT(polar("Azimut [deg];V [deg]", "30;80", {.clockwise = false}),
              ElementsAre("azimuth_deg=5 deg", "elevation_deg=6 deg zenith ?"));
  EXPECT_THAT(polar("Azimut [deg];V [deg]", "30;80", {.clockwise = false, .zenith = false}),
              ElementsAre("azimuth_deg=5 deg", "elevation_deg=6 deg"));
  EXPECT_THAT(polar("azimuth clockwise [deg];zenith angle [deg]", "30;80"),
              ElementsAre("azimuth_deg=5 deg clockwise", "elevation_deg=6 deg zenith"));
  // A name that the numbers contradict.
  EXPECT_THAT(polar("azimuth_deg;elevation_deg", "30;100"), ElementsAre("azimuth_deg=5 deg", "elevation_deg=6 deg ?"));
  EXPECT_THAT(polar("Hz;Zenit", "30°10'20\";80°00'00\"", {.clockwise = true}),
              ElementsAre("azimuth_arcsec=5 deg-min-sec clockwise", "elevation_arcsec=6 deg-min-sec zenith"));
  EXPECT_THAT(polar("Hz [grad];Zenit [gon]", "30;80", {.clockwise = true}),
              ElementsAre("azimuth_deg=5 deg clockwise ?", "elevation_deg=6 gon zenith"));
  // Without a unit: radians below a whole turn, degrees or gon above, all in doubt.
  EXPECT_THAT(polar("azimuth;elevation", "3,5;0,1"), ElementsAre("azimuth_rad=5 rad ?", "elevation_rad=6 rad ?"));
  EXPECT_THAT(polar("azimuth;zenith", "300;80", {.angle_unit = "gon", .clockwise = false}),
              ElementsAre("azimuth_deg=5 gon", "elevation_deg=6 gon zenith"));
}

TEST(ProposedColumns, OfPositioningKnowDirectionsInTwoLanguages) {
  const ProposedMapping proposed =
      proposal_for("Lauf;Richtung;Soll [mm];Abweichung [µm]\n1;vor;5,5;1\n1;zurück;5,5;2\n", ImportKind::positioning);
  EXPECT_THAT(columns_of(proposed), ElementsAre("run=1", "direction=2", "target_mm=3 mm", "deviation_um=4 um"));
  EXPECT_THAT(proposed.columns[1].column.positive, ElementsAre("vor"));
  EXPECT_THAT(proposed.columns[1].column.negative, ElementsAre("zurück"));
  const ProposedMapping rotary =
      proposal_for("dir,target [deg],error\n+,5.5,1\n-,5.5,2\n", ImportKind::positioning, {.angle_unit = "arcsec"});
  EXPECT_THAT(columns_of(rotary), ElementsAre("direction=1", "target_deg=2 deg", "deviation_arcsec=3 arcsec"));
  EXPECT_THAT(rotary.columns[0].column.positive, IsEmpty());
  EXPECT_THAT(columns_of(proposal_for("run,direction,target_mm,actual_mm,deviation_um\n1,+,5.5,6,2\n",
                                      ImportKind::positioning)),
              ElementsAre("run=1", "direction=2", "target_mm=3 mm", "deviation_um=5 um"));
  const auto sign = [](const std::string& rows) {
    const std::string text = "direction;target_mm;actual_mm;deviation_um\n" + rows;
    return proposal_for(text, ImportKind::positioning).columns.back();
  };
  EXPECT_THAT(sign("+;10,5;10,503;3\n+;20;19,998;-2\n").reason, HasSubstr("it is actual less target by column 3"));
  EXPECT_EQ(sign("+;10,5;10,503;-3\n+;20;19,998;2\n").column.convention, ImportConvention::reversed);
  // Positions of too few digits tell nothing.
  EXPECT_THAT(sign("+;10,5;10,50;-3\n+;20;20,00;2\n").reason, Not(HasSubstr("less")));
}

TEST(ProposedColumns, TellTheKindAndWhatIsNotRead) {
  const std::string text = "x_mm,y_mm,z_mm,Temperatur,\n1.5,2,3,20,\n";
  const ProposedMapping points = propose_mapping(text, "t.txt", find_layout(text, "t.txt"), std::nullopt, nullptr);
  EXPECT_EQ(points.kind, ImportKind::points);
  EXPECT_THAT(points.not_read, ElementsAre("column 4 'Temperatur'"));
  const auto message = [](const std::string& of) {
    return message_of([&] { propose_mapping(of, "t.txt", find_layout(of, "t.txt"), std::nullopt, nullptr); });
  };
  EXPECT_THAT(message("a,b\n1.5,2\n"),
              HasSubstr("t.txt:1: the columns do not tell what the table is: 'a', 'b'; expected "
                        "--as points, --as positioning, --as circular, or --as tracker with --machine"));
  EXPECT_THAT(message("1.5,2\n"), HasSubstr("2 columns without names"));
}

TEST(ProposedColumns, ThatAreMissingAreNamed) {
  const auto message = [](const std::string& text, ImportKind kind, const ImportHints& hints = {}) {
    return message_of([&] { proposal_for(text, kind, hints); });
  };
  EXPECT_EQ(message("x,y,h\n1.5,2,3\n", ImportKind::points),
            "t.txt:1: z: no column for it was found in 'x', 'y', 'h'; expected a name such as measured z, z measured, "
            "meas z, z meas, or a mapping file that says which column it is (--mapping)");
  EXPECT_THAT(message("kg,y,z\n1.5,2,3\n", ImportKind::points), HasSubstr("x: no column for it"));
  EXPECT_THAT(message("x,y,z\n1.5,2,three\n", ImportKind::points), HasSubstr("z: no column for it"));
  EXPECT_THAT(message("C,X,Z,x,y\n1.5,2,3,4,5\n", ImportKind::tracker), HasSubstr("measured_x: no column for it"));
  EXPECT_THAT(message("1.5 2 3\n", ImportKind::tracker),
              HasSubstr("expected columns of numbers for C, X, Z, measured_x, measured_y, measured_z, in their order"));
  EXPECT_THAT(message("direction,target_mm,deviation_um\neast,1.5,2\n", ImportKind::positioning),
              HasSubstr("direction: no column for it"));
  EXPECT_THAT(message("x_mm,y_mm,z_mm\n1.5,2,3\n", ImportKind::points, {.clockwise = true}),
              HasSubstr("--azimuth: the table has no azimuth"));
  EXPECT_THAT(message("direction,target_mm,deviation_um\n+,1.5,2\n", ImportKind::positioning, {.mirrored = "x"}),
              HasSubstr("--mirrored: the table has no such coordinate"));
}

TEST(ProposedColumns, WithAUnitOfAnotherQuantityAreNamed) {
  const auto message = [](const std::string& text, ImportKind kind) {
    return message_of([&] { proposal_for(text, kind); });
  };
  const std::string lengths = "is not a unit of a length; expected one of ";
  EXPECT_THAT(message("x [kg],y,z\n1.5,2,3\n", ImportKind::points), HasSubstr("'kg' " + lengths));
  EXPECT_THAT(message("x_mm,y_mm,z_furlong\n1.5,2,3\n", ImportKind::points), HasSubstr("'furlong' " + lengths));
  EXPECT_THAT(message("x,y,z\nmm,mm,deg\n1.5,2,3\n", ImportKind::points), HasSubstr("'deg' " + lengths));
  EXPECT_THAT(message("C,X,Z,range [m],azimuth [mm],elevation [deg]\n1.5,2,3,4,5,6\n", ImportKind::tracker),
              HasSubstr("'mm' is not a unit of an angle; expected one of "));
  EXPECT_THAT(message("direction,target,actual [kg]\n+,1.5,2\n", ImportKind::positioning),
              HasSubstr("'kg' is not a unit of "));
}

}  // namespace
}  // namespace abbe
