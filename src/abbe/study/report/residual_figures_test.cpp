#include "abbe/study/report/residual_figures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "abbe/study/example_file_for_test.h"
#include "abbe/study/run_study.h"

namespace abbe {
namespace {

bool is_outlier(const StudyResult& result, std::size_t observations, std::size_t reading) {
  const std::vector<Outlier>& all = result.identification.outliers;
  return std::any_of(all.begin(), all.end(),
                     [&](const Outlier& one) { return one.observations == observations && one.reading == reading; });
}

/// Blocks of readings, the last of them not full, against the same readings one by one.
TEST(ResidualFigures, AreThoseOfSingleReadings) {
  int outliers = 0, without_length = 0;
  for (const char* const file : {"three_axis/level-and-autocollimator.study.toml", "aguado/aguado.study.toml"}) {
    const Study study = read_study(test::example_file(file));
    const StudyResult result = run_study(study, {.map = false});
    ASSERT_TRUE(result.usable()) << result.identification.message;
    std::vector<double> all, good;
    for (std::size_t o = 0; o < result.model.problem.observations.size(); ++o) {
      const SelectedObservations& selected = result.model.problem.observations[o];
      const Observations& observations = *selected.observations;
      const std::size_t rows = static_cast<std::size_t>(observations.rows());
      const std::vector<double> deviations = deviations_by_reading(observations, 2);
      const std::vector<double> lengths = lengths_by_reading(observations, 2);
      ASSERT_EQ(deviations.size(), rows * observations.reading_count());
      for (std::size_t k = 0; k < observations.reading_count(); ++k) {
        const std::vector<double> single = observations.deviation(k);
        for (std::size_t row = 0; row < rows; ++row) ASSERT_NEAR(deviations[rows * k + row], single[row], 1e-12) << k;
        const std::optional<double> length = observations.length_of_deviation(k);
        ASSERT_NEAR(lengths[k], length.value_or(-1), 1e-12) << k;
        if (!length) ++without_length;
        if (!length || (!selected.use.empty() && selected.use[k] == 0)) continue;
        all.push_back(*length);
        if (is_outlier(result, o, k))
          ++outliers;
        else
          good.push_back(*length);
      }
    }
    const ResidualFigures figures = residual_figures(study, result);
    EXPECT_EQ(figures.outliers, result.identification.outliers.size());
    EXPECT_EQ(figures.length.count, all.size());
    EXPECT_EQ(figures.length_without_outliers.count, good.size());
    EXPECT_NEAR(figures.length.rms, sample_statistics(all).rms, 1e-12);
    EXPECT_NEAR(figures.length_without_outliers.p95, sample_statistics(good).p95, 1e-12);
    EXPECT_EQ(noise_figures(study, result).times_noise, figures.times_noise);
  }
  // Otherwise the examples no longer contain both cases.
  EXPECT_GT(outliers, 0);
  EXPECT_GT(without_length, 0);
}

}  // namespace
}  // namespace abbe
