#include "abbe/report/customer/customer_notes.h"

#include <gmock/gmock.h>

#include <set>
#include <string>

#include "abbe/report/customer/customer_note_words.h"
#include "abbe/report/words/volumetric_words.h"
#include "abbe/verify/left_out_poses.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr ReportLanguage kOthers[] = {ReportLanguage::german, ReportLanguage::chinese, ReportLanguage::japanese};

std::string german(std::string_view note) {
  return customer_note(note, ReportLanguage::german).value_or("not known: " + std::string(note));
}

TEST(CustomerNotes, EveryFormatHasItsPlacesInEveryLanguage) {
  std::size_t formats = 0;
  for (const auto words : {evaluation_note_words(), study_note_words(), note_argument_words()}) {
    for (const NoteWord& word : words) {
      ++formats;
      const auto places = static_cast<std::size_t>(std::count(word.english.begin(), word.english.end(), '{'));
      for (const std::string_view text : word.texts) {
        std::set<std::string> found;
        for (std::size_t at = text.find('{'); at != std::string_view::npos; at = text.find('{', at + 1)) {
          found.insert(std::string(text.substr(at, 3)));
        }
        EXPECT_EQ(found.size(), places) << text;
        for (std::size_t k = 0; k < places; ++k) EXPECT_TRUE(found.contains("{" + std::to_string(k) + "}")) << text;
      }
      EXPECT_NE(word.texts[0].empty(), true) << word.english;
    }
  }
  EXPECT_GT(formats, 100U);
}

TEST(CustomerNotes, NumbersAreWrittenAsReadersOfTheLanguageDo) {
  const std::string note =
      "Predicted volumetric error 2.482 um before, 1.24 um (k = 2) after correction, mean over 9 x 9 x 9 poses over X "
      "0 to 760 mm, Y 12.5 mm, C -90 to 90 deg. Residual of the readings: 1.02 times their stated uncertainties.";
  EXPECT_EQ(
      german(note),
      "Vorhergesagte volumetrische Abweichung 2,482 µm vor und 1,24 µm (k = 2) nach der Korrektur, Mittel über "
      "9 × 9 × 9 Posen über X 0 bis 760 mm, Y 12,5 mm, C −90 bis 90°. Residuen der Messwerte: das 1,02-Fache ihrer "
      "angegebenen Unsicherheiten.");
  EXPECT_EQ(customer_note(note, ReportLanguage::chinese),
            "预测体积误差：补偿前 2.482 µm，补偿后 1.24 µm（k = 2），X 0 至 760 mm、Y 12.5 mm、C −90 至 90° 内的 9 × 9 "
            "× 9 个位姿的平均值。读数残差：为所给不确定度的 1.02 倍。");
  EXPECT_EQ(customer_note(note, ReportLanguage::english), note);
}

TEST(CustomerNotes, WordsStandInThePlacesOfOthers) {
  EXPECT_EQ(
      german("The counter-clockwise path is not a full circle, for which alone ISO 230-4 fits the centre."),
      "Die Bahn gegen den Uhrzeigersinn ist kein Vollkreis; nur bei einem solchen passt ISO 230-4 den Mittelpunkt "
      "ein.");
  EXPECT_EQ(german("Section 7 is not evaluated: left edge: fewer than 20 points."),
            "Schnitt 7 ist nicht ausgewertet: linke Kante: weniger als 20 Punkte.");
  EXPECT_EQ(german("air was not read for 2 h 30 min: it is interpolated linearly in between."),
            "air wurde 2 h 30 min lang nicht abgelesen: Der Verlauf dazwischen gilt als gerade Linie.");
  EXPECT_EQ(german("tau_Z: no change beyond the scatter of the readings."),
            "tau_Z: keine Änderung über die Streuung der Messwerte hinaus.");
  EXPECT_EQ(german("before: G_cw: fewer than three readings."), "Vor der Korrektur: G_cw: weniger als drei Messwerte.");
  EXPECT_EQ(german("radial_x1_total: fewer than 2 whole turns."), "radial_x1_total: weniger als 2 ganze Umdrehungen.");
  EXPECT_EQ(german("not identified: EXX, all six error motions of Y, EC0Y. They are taken as zero; the uncertainty of "
                   "the volumetric error does not cover them. Errors of usual size (10 um, 50 urad each) there make "
                   "about 23 um."),
            "Nicht ermittelt: EXX, alle sechs Bewegungsabweichungen von Y, EC0Y. Sie gelten als null; die Unsicherheit "
            "der volumetrischen Abweichung deckt sie nicht ab. Abweichungen üblicher Größe (je 10 µm, 50 µrad) ergeben "
            "dort etwa 23 µm.");
  EXPECT_EQ(customer_note_argument("0 to 1000 mm", ReportLanguage::japanese), "0 ～ 1000 mm");
  EXPECT_EQ(customer_note_argument("Part No. 1.5", ReportLanguage::german), "Part No. 1.5");
}

TEST(CustomerNotes, WhatIsNotKnownStaysEnglish) {
  for (const ReportLanguage language : kOthers) {
    for (const char* note : {"", "Something new.", "station 1: the reflectors are swapped.",
                             "Not stated, taken as exact: --u-x-um. Something new.", "before: something new."}) {
      EXPECT_EQ(customer_note(note, language), std::nullopt) << note;
    }
  }
}

TEST(CustomerNotes, PosesThatAreLeftOutAreSaidAsTheyAre) {
  for (const std::size_t count : {1U, 12U}) {
    for (int reason = 0; reason < 3; ++reason) {
      LeftOutPoses left_out;
      left_out.all = 100;
      (reason == 0 ? left_out.not_covered : reason == 1 ? left_out.outside_travel : left_out.not_reached) = count;
      for (const ReportLanguage language : kOthers) {
        const auto text = customer_note(left_out_words(left_out), language);
        ASSERT_TRUE(text) << left_out_words(left_out);
        EXPECT_THAT(*text, HasSubstr(std::to_string(count)));
      }
    }
  }
  LeftOutPoses left_out{.all = 100, .not_covered = 1, .outside_travel = 2, .not_reached = 3};
  EXPECT_EQ(
      german(left_out_words(left_out)),
      "6 von 100 Posen der Karte sind weggelassen: 1 liegt außerhalb des Bereichs, in dem die Abweichungen bekannt "
      "sind, 2 brauchen korrigierte Befehle außerhalb des Verfahrwegs, 3 nicht zu erreichen mit den korrigierten "
      "Achsen");
}

TEST(CustomerNotes, VolumetricFiguresAreSaidAsTheyAre) {
  SampleStatistics size;
  size.count = 8;
  size.mean = 0.0123;
  for (int given = 0; given < 8; ++given) {
    VolumetricFigures figures;
    figures.poses = 8;
    figures.poses_words = "2 x 2 x 2 poses over X 0 to 1 mm, Y 0 to 1 mm, Z 0 to 1 mm";
    if ((given & 1) != 0) figures.true_before = figures.true_after = size;
    if ((given & 2) != 0) figures.predicted_after = size;
    figures.predicted_before = size;
    const std::string covers =
        (given & 4) != 0 ? "identified errors only, directions that the readings determine only" : "";
    const std::string sentence = volumetric_sentence(figures, covers);
    EXPECT_THAT(german(sentence), HasSubstr("12,3 µm")) << sentence;
    EXPECT_THAT(german(sentence), Not(HasSubstr("only"))) << sentence;
  }
}

}  // namespace
}  // namespace abbe
