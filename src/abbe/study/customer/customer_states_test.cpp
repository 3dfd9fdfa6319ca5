#include "abbe/study/customer/customer_states.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abbe/machine/chain.h"
#include "abbe/report/customer/customer_notes.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Machine mill_of_a_report() {
  Machine machine = parse_chain("w X' Y' b Z t").machine;
  machine.states = {{.name = "ambient", .unit = "degC", .reference = 20},
                    {.name = "ram", .kind = StateKind::axis, .axis = 2}};
  return machine;
}

ErrorsFile errors_of_a_report() {
  const Basis line{.kind = BasisKind::legendre, .order = 1, .from = -250, .to = 250};
  ErrorsFile file;
  file.errors.motions.push_back({0, Component::X, line, {0.001, 0.002}, {}});
  file.errors.motions.push_back({0, Component::X, line, {0, 0.004}, {}, 0});
  file.errors.locations.push_back({1, Component::C, 3e-5, 4e-6});
  file.errors.locations.push_back({1, Component::C, 1e-5, 2e-6, 0});
  file.errors.locations.push_back({2, Component::A, 2e-6, 1e-7, 1});
  const auto count = static_cast<Eigen::Index>(file.errors.parameter_count());
  file.covariance = Eigen::MatrixXd::Identity(count, count);
  file.covered = {{"ambient_degC", 18.2, 24.5}};
  return file;
}

TEST(CustomerStates, ErrorsAreThoseAtTheReferences) {
  const ErrorsFile there = errors_for_customer(mill_of_a_report(), errors_of_a_report());
  ASSERT_EQ(there.errors.locations.size(), 2U);
  EXPECT_EQ(there.errors.locations[0].value, 3e-5);
  EXPECT_EQ(there.errors.locations[0].standard_uncertainty, 4e-6);
  EXPECT_EQ(there.errors.locations[1].state, 1U);
  // What is multiplied with zero adds nothing to the uncertainty.
  EXPECT_EQ(there.covariance(0, 0), 1);
  EXPECT_EQ(there.covariance(3, 3), 0);
  EXPECT_EQ(there.covariance(4, 4), 1);
}

TEST(CustomerStates, NotesSayWhereFiguresHoldAndWhatHappensBeyond) {
  const ErrorsFile file = errors_of_a_report();
  const std::vector<std::string> notes = customer_state_notes(mill_of_a_report(), file);
  EXPECT_THAT(notes, ElementsAre("The figures hold at the state ambient_degC = 20.",
                                 HasSubstr("The readings cover ambient_degC 18.2 to 24.5; beyond, errors are"),
                                 HasSubstr("where the factors of these errors are zero: EA0Z*ram.")));
  EXPECT_EQ(references_not_covered(mill_of_a_report(), file), "");
  for (const std::string& note : notes) {
    for (const ReportLanguage language : {ReportLanguage::german, ReportLanguage::chinese, ReportLanguage::japanese}) {
      EXPECT_TRUE(customer_note(note, language)) << note;
    }
  }
  EXPECT_EQ(*customer_note(notes[0], ReportLanguage::german), "Die Werte gelten im Zustand ambient_degC = 20.");
}

TEST(CustomerStates, AReferenceThatTheReadingsDoNotCoverIsSaid) {
  ErrorsFile file = errors_of_a_report();
  file.covered = {{"ambient_degC", 22, 24.5}};
  EXPECT_EQ(references_not_covered(mill_of_a_report(), file), "ambient_degC = 20 (readings: 22 to 24.5)");
  const std::vector<std::string> notes = customer_state_notes(mill_of_a_report(), file);
  ASSERT_EQ(notes.size(), 4U);
  EXPECT_TRUE(customer_note(notes[2], ReportLanguage::japanese)) << notes[2];
}

TEST(CustomerStates, WithoutStatesThereIsNothingToSay) {
  ErrorsFile file = errors_of_a_report();
  file.errors.motions.resize(1);
  file.errors.locations.resize(1);
  EXPECT_TRUE(customer_state_notes(mill_of_a_report(), file).empty());
}

}  // namespace
}  // namespace abbe
