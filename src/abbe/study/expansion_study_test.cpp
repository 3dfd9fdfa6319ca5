#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "abbe/errors/expansion.h"
#include "abbe/errors/random_stream.h"
#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/identify/identify.h"
#include "abbe/study/identification/trust.h"
#include "abbe/study/report/found_values.h"
#include "abbe/study/report/summary.h"
#include "abbe/study/run_study.h"
#include "abbe/study/study_steps.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::Not;

const char* const kSlide = R"(name = "slide"
chain = "w b X t"
[axis.X]
travel_mm = [0, 800]
[state.scale_x]
kind = "measured"
unit = "degC"
)";

constexpr double kNoise = 0.4e-3;  // mm, of a length
constexpr double kPrior = 8e-6, kPriorUncertainty = 0.5e-6;

const char* const kKnown = R"([[identify.expansion]]
axis = "X"
state = "scale_x"
coefficient_um_per_m_K = 8
coefficient_standard_uncertainty_um_per_m_K = 0.5
)";

/// A laser along the slide. @param readings  what is simulated or read
std::string slide_study(const std::string& readings, const std::string& plan, const std::string& identify) {
  return fmt::format(R"(machine = "slide.machine.toml"
seed = 3
{}
[[setup]]
name = "laser"
instrument = "interferometer"
components = ["length"]
noise = {{ length_um = {} }}
{}
[[setup.run]]
name = "X"
direction = [1, 0, 0]
optic_mm = [0, 0, 0]
[identify]
held_out_fraction = 0
{}
)",
                     readings, 1e3 * kNoise, plan, identify);
}

std::filesystem::path slide_folder(const char* name) {
  const std::filesystem::path folder = test::empty_folder(name);
  std::ofstream(folder / "slide.machine.toml") << kSlide;
  return folder;
}

Study expansion_study(const std::filesystem::path& folder, const std::string& text) {
  std::ofstream(folder / "slide.study.toml") << text;
  return read_study(folder / "slide.study.toml");
}

/// Readings at some positions and temperatures, with their noise and an error of the scale of 0.
struct SlideReadings {
  std::vector<double> position, temperature, deviation;  // mm, degC, mm

  void add(double x, double degrees, double alpha, double noise) {
    position.push_back(x);
    temperature.push_back(degrees);
    deviation.push_back(alpha * (degrees - 20) * x + noise);
  }
  void write(const std::filesystem::path& path) const {
    std::ofstream file(path);
    file << "X_mm,scale_x_degC,length_mm\n";
    for (std::size_t i = 0; i < position.size(); ++i) {
      file << fmt::format("{},{},{:.12f}\n", position[i], temperature[i], position[i] + deviation[i]);
    }
  }
};

SlideReadings slide_readings(double alpha, double from, double to, std::uint64_t seed) {
  SlideReadings readings;
  RandomStream random(seed);
  for (int series = 0; series < 3; ++series) {
    for (int k = 0; k <= 8; ++k) {
      readings.add(100.0 * k, from + (to - from) * series / 2, alpha, kNoise * random.normal());
    }
  }
  return readings;
}

FoundExpansion identified_expansion(const std::filesystem::path& folder, const SlideReadings& readings,
                                    const std::string& identify, Identification* all = nullptr) {
  readings.write(folder / "readings.csv");
  const Study study = expansion_study(folder, slide_study("", "[[setup.data]]\nfile = \"readings.csv\"", identify));
  StudyResult result;
  result.campaign = gather_readings(study);
  identify_study(study, result, {});
  EXPECT_TRUE(result.usable()) << result.identification.message;
  if (all != nullptr) *all = result.identification;
  const std::vector<FoundExpansion> found = found_expansions(study, result);
  EXPECT_EQ(found.size(), 1U);
  return found.empty() ? FoundExpansion{} : found[0];
}

/// Least squares for alpha and one zero, by hand: alpha and its variance.
std::pair<double, double> by_hand(const SlideReadings& readings) {
  const auto n = static_cast<double>(readings.position.size());
  double mean_f = 0, mean_d = 0;
  std::vector<double> f;
  for (std::size_t i = 0; i < readings.position.size(); ++i) {
    f.push_back((readings.temperature[i] - 20) * readings.position[i]);
    mean_f += f.back() / n;
    mean_d += readings.deviation[i] / n;
  }
  double ff = 0, fd = 0;
  for (std::size_t i = 0; i < f.size(); ++i) {
    ff += (f[i] - mean_f) * (f[i] - mean_f);
    fd += (f[i] - mean_f) * (readings.deviation[i] - mean_d);
  }
  return {fd / ff, kNoise * kNoise / ff};
}

TEST(ExpansionStudy, IsTheWeightedMeanOfKnowledgeAndReadings) {
  const std::filesystem::path folder = slide_folder("expansion_mean");
  const auto closed_form = [&](const SlideReadings& readings) {
    const auto [alpha, variance] = by_hand(readings);
    const double weight = 1 / variance, known = 1 / (kPriorUncertainty * kPriorUncertainty);
    return std::pair((weight * alpha + known * kPrior) / (weight + known), 1 / (weight + known));
  };
  // 0.02 K show nothing, 0.3 K as much as is known, 10 K all.
  for (const double warm : {0.02, 0.3, 10.0}) {
    const SlideReadings readings = slide_readings(9.1e-6, 20 + 0.5 * warm, 20 + warm, 7);
    const FoundExpansion found = identified_expansion(folder, readings, kKnown);
    const auto [alpha, variance] = closed_form(readings);
    EXPECT_NEAR(found.coefficient, alpha, 2e-6 * alpha) << warm;
    EXPECT_NEAR(found.expanded_uncertainty, 2 * std::sqrt(variance), 1e-5 * found.expanded_uncertainty) << warm;
    if (warm < 0.1) {
      EXPECT_NEAR(found.expanded_uncertainty, 2 * kPriorUncertainty, 0.02 * kPriorUncertainty);
    }
    if (warm > 5) {
      EXPECT_NEAR(found.coefficient, by_hand(readings).first, 2e-2 * kPriorUncertainty);
    }
    EXPECT_DOUBLE_EQ(found.stated.value, kPrior);
  }
}

TEST(ExpansionStudy, ReadingsOfAWarmScaleAreCorrectedTo20DegreesWithTheUncertaintyOfThat) {
  // All readings at 26 degC: the slope at 20 degC is the slope less alpha 6 K, and as uncertain as alpha is.
  const std::filesystem::path folder = slide_folder("expansion_slope");
  const SlideReadings readings = slide_readings(8.6e-6, 26, 26, 5);
  Identification all;
  const std::string slope = std::string(kKnown) +
                            "temperature_standard_uncertainty_K = 0.2\n"
                            "[[identify.motion]]\nerrors = \"EXX\"\nbasis = \"legendre\"\norder = 1\n";
  const FoundExpansion found = identified_expansion(folder, readings, slope, &all);
  EXPECT_NEAR(found.coefficient, kPrior, 1e-3 * kPriorUncertainty) << "the readings say nothing of it";
  EXPECT_EQ(found.correlated, "EXX[P1]");
  EXPECT_LT(found.correlation, -0.8);
  const auto [of_six, variance_of_six] = by_hand(readings);  // alpha as if there were no other slope
  double at_20 = 0, variance = 0;
  for (std::size_t i = 0; i < all.parameters.size(); ++i) {
    if (all.parameters[i].name != "EXX[P1]") continue;
    at_20 = all.estimates[static_cast<Eigen::Index>(i)] / 400;  // P1 goes from -1 to 1 over 800 mm
    variance = all.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) / (400 * 400);
  }
  EXPECT_NEAR(at_20, 6 * (of_six - kPrior), 1e-9);
  // ISO/TR 16015: expansion and temperature, beside what the readings scatter.
  const double of_alpha = 6 * kPriorUncertainty, of_temperature = std::hypot(kPrior, kPriorUncertainty) * 0.2;
  EXPECT_NEAR(std::sqrt(variance),
              std::sqrt(36 * variance_of_six + of_alpha * of_alpha + of_temperature * of_temperature),
              1e-4 * std::sqrt(variance));
}

TEST(ExpansionStudy, AKnownCoefficientIsSubtractedAndAnOpenOneFound) {
  const std::filesystem::path folder = slide_folder("expansion_exact");
  const SlideReadings readings = slide_readings(8.4e-6, 22, 27, 2);
  const std::string place = "[[identify.expansion]]\naxis = \"X\"\nstate = \"scale_x\"\n";
  const std::string line = "[[identify.motion]]\nerrors = \"EXX\"\nbasis = \"legendre\"\norder = 1\n";
  const FoundExpansion exact =
      identified_expansion(folder, readings, place + "fixed_point_mm = 250\ncoefficient_um_per_m_K = 8.4\n" + line);
  EXPECT_DOUBLE_EQ(exact.coefficient, 8.4e-6);
  EXPECT_EQ(exact.expanded_uncertainty, 0);
  EXPECT_FALSE(exact.is_fixed);
  EXPECT_EQ(exact.fixed_point, 250);
  const FoundExpansion open = identified_expansion(folder, readings, place + "estimate_coefficient = true\n");
  EXPECT_GT(open.expanded_uncertainty, 0);
  EXPECT_NEAR(open.coefficient, 8.4e-6, 2 * open.expanded_uncertainty);
}

TEST(ExpansionStudy, IsTheSameAsAnErrorMotionWithAStateAndAPrior) {
  const std::filesystem::path folder = slide_folder("expansion_motion");
  slide_readings(8.4e-6, 21, 23, 9).write(folder / "readings.csv");
  const Study study = expansion_study(folder, slide_study("", "[[setup.data]]\nfile = \"readings.csv\"", kKnown));
  Campaign campaign = gather_readings(study);
  find_start_values(study.machine, campaign);
  Problem of_expansion = build_model(study, campaign).problem;
  // The same line as a Legendre polynomial, 8 um/K over a metre; its constant is no part of the estimates.
  ErrorSet errors;
  const Basis line{.kind = BasisKind::legendre, .order = 1, .from = -1000, .to = 1000};
  errors.motions.push_back({0, Component::X, line, {0, 0.008}, {}, 0});
  Problem of_motion =
      estimate_everything(study.machine, errors, {campaign.setups[0].observations(study.machine, errors)});
  of_motion.machine_parameters = {1};
  of_motion.priors.push_back({{ParameterId::kMachine, 1}, 0.008, 0.0005});
  const Identification one = identify(of_expansion, {}), other = identify(of_motion, {});
  ASSERT_EQ(one.estimates.size(), other.estimates.size());
  EXPECT_NEAR(one.estimates[0], other.estimates[0], 1e-12);
  EXPECT_NEAR(one.covariance(0, 0), other.covariance(0, 0), 1e-12 * other.covariance(0, 0));
  EXPECT_NEAR(one.estimates[1], other.estimates[1], 1e-10) << "zero of the laser, mm";
}

TEST(ExpansionStudy, CoversTheTruthOfManyDraws) {
  const std::filesystem::path folder = slide_folder("expansion_draws");
  std::ofstream poses(folder / "poses.csv");
  poses << "X_mm,scale_x_degC\n";
  for (int series = 0; series < 3; ++series) {
    for (int k = 0; k <= 16; ++k) poses << fmt::format("{},{}\n", 50 * k, 20.1 + 0.35 * series);
  }
  poses.close();
  Study study = expansion_study(folder, slide_study("[simulate.generator]\nlinear_order = 2\nmean_volumetric_um = 20\n",
                                                    "[[setup.plan]]\nkind = \"poses\"\nfile = \"poses.csv\"",
                                                    std::string(kKnown) + "[[identify.motion]]\nerrors = \"EXX\"\n"
                                                                          "basis = \"legendre\"\norder = 2\n"));
  constexpr int kDraws = 200;
  double squares = 0, spread = 0;
  int within = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    study.seed = study.simulation->generator->seed = static_cast<std::uint64_t>(100 + draw);
    StudyResult result;
    result.campaign = gather_readings(study);
    find_start_values(study.machine, result.campaign);
    result.model = build_model(study, result.campaign);
    result.identification = identify(result.model.problem, {});
    const FoundExpansion found = found_expansions(study, result).at(0);
    const std::optional<ScaleExpansion> real = expansion_of(study.machine, result.campaign.truth->motions.back());
    ASSERT_TRUE(real);
    spread += std::pow((real->coefficient - kPrior) / kPriorUncertainty, 2) / kDraws;
    const double off = 2 * (found.coefficient - real->coefficient) / found.expanded_uncertainty;
    squares += off * off / kDraws;
    within += std::abs(off) < 2 ? 1 : 0;
    EXPECT_LT(found.expanded_uncertainty, 0.9 * 2 * kPriorUncertainty) << "the readings contribute";
  }
  // Chi-square of 200: 1 +- 0.1, and 95.4 % of 200.
  EXPECT_NEAR(spread, 1, 0.3);
  EXPECT_NEAR(squares, 1, 0.3);
  EXPECT_NEAR(within, 191, 9);
}

TEST(ExpansionStudy, IsReportedAndWritten) {
  const std::filesystem::path folder = slide_folder("expansion_report");
  slide_readings(8.4e-6, 26, 26, 2).write(folder / "readings.csv");
  const Study study = expansion_study(
      folder,
      slide_study("", "[[setup.data]]\nfile = \"readings.csv\"",
                  std::string(kKnown) + "[[identify.motion]]\nerrors = \"EXX\"\nbasis = \"legendre\"\norder = 1\n"));
  const StudyResult result = run_study(study);
  ASSERT_TRUE(result.usable()) << result.identification.message;
  for (const std::string& warning : result.warnings) {
    EXPECT_THAT(warning, Not(HasSubstr("how they are divided is a convention")));
  }
  const nlohmann::ordered_json json = study_summary(study, result)["identified"]["expansions"][0];
  EXPECT_EQ(json["axis"], "X");
  EXPECT_EQ(json["state"], "scale_x");
  EXPECT_NEAR(json["coefficient_um_per_m_K"].get<double>(), 8, 0.01);
  EXPECT_NEAR(json["expanded_uncertainty_um_per_m_K"].get<double>(), 1, 0.01);
  EXPECT_NEAR(json["stated_standard_uncertainty_um_per_m_K"].get<double>(), 0.5, 1e-9);
  const ErrorsFile file = identified_errors_file(study, result);
  const std::string text = errors_text(study.machine, file);
  EXPECT_THAT(text, HasSubstr("# scale of X: 8"));
  const ErrorsFile again = parse_errors(text, "e.errors.toml", study.machine, StatesOfErrors::allowed);
  EXPECT_EQ(again.errors.motions, result.identification.errors.motions);
}

TEST(ExpansionStudy, WhatDoesNotFitIsRefused) {
  const std::filesystem::path folder = slide_folder("expansion_refused");
  const auto refusal = [&](const std::string& identify, const std::string& simulate = "") {
    const std::string plan = simulate.empty() ? "[[setup.data]]\nfile = \"readings.csv\""
                                              : "[[setup.plan]]\nkind = \"line\"\npoints = 5\naxis.X = {}";
    return message_of([&] { expansion_study(folder, slide_study(simulate, plan, identify)); });
  };
  const std::string place = "[[identify.expansion]]\naxis = \"X\"\nstate = \"scale_x\"\n";
  EXPECT_THAT(refusal(place), HasSubstr("coefficient_um_per_m_K: missing; expected a coefficient of expansion"));
  EXPECT_THAT(refusal(place + "coefficient_um_per_m_K = 8\ncoefficient_standard_uncertainty_um_per_m_K = 0\n"),
              HasSubstr("is not above zero"));
  EXPECT_THAT(refusal(place + "estimate_coefficient = true\ntemperature_standard_uncertainty_K = 1\n"),
              HasSubstr("has an effect of unknown size"));
  EXPECT_THAT(refusal(place + "coefficient_um_per_m_K = 8\ntrue_coefficient_um_per_m_K = 8\n"),
              HasSubstr("belongs to a simulation only"));
  EXPECT_THAT(
      refusal(std::string(kKnown) + "true_coefficient_um_per_m_K = 8\n", "[simulate]\nerrors = \"t.errors.toml\""),
      HasSubstr("is given beside a file of true errors"));
  EXPECT_THAT(refusal(std::string(kKnown) + kKnown), HasSubstr("EXX*scale_x has an expansion already"));
  EXPECT_THAT(refusal(std::string(kKnown) + "[[identify.motion]]\nerrors = \"EXX\"\nstate = \"scale_x\"\n"
                                            "basis = \"monomial\"\norder = 2\n"),
              HasSubstr("EXX*scale_x is identified as \"monomial\" too"));
  EXPECT_THAT(refusal(place + "coefficient_um_per_m_K = 8\n"), HasSubstr("nothing is to be identified"));
  // Readings without the temperature.
  std::ofstream(folder / "readings.csv") << "X_mm,length_mm\n0,0\n400,400\n800,800\n";
  const Study study = expansion_study(folder, slide_study("", "[[setup.data]]\nfile = \"readings.csv\"", kKnown));
  EXPECT_THAT(message_of([&] { run_study(study); }), HasSubstr("a column scale_x_degC in the readings"));
}

}  // namespace
}  // namespace abbe
