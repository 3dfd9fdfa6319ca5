#include "abbe/study/identification/streamed_identification.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/formats/readings/streamed_observations.h"
#include "abbe/formats/study/study_instrument.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/digest.h"
#include "abbe/identify/distributions.h"
#include "abbe/identify/normal_equations.h"
#include "abbe/study/identification/streamed_norms.h"
#include "abbe/study/identification/streamed_sums.h"

namespace abbe {
namespace {

/// @param count  of the readings of the set-up, more than may be in memory
/// @throws InputError where the study asks for something that needs all readings in memory
void require_streamable(const Study& study, const Setup& setup, std::size_t count) {
  const IdentificationPlan& plan = *study.identification;
  const auto refuse_if = [&](bool asked, const std::string& key, const char* what, const char* expected) {
    if (!asked) return;
    throw InputError(
        {.file = study.name, .field = key},
        fmt::format("{} needs all readings in memory, and set-up {} has {}, more than readings_in_memory = "
                    "{}",
                    what, setup.name, count, plan.readings_in_memory),
        expected);
  };
  refuse_if(plan.held_out_fraction > 0 && !plan.held_out_file, "identify.held_out_fraction", "holding out readings",
            "held_out_fraction = 0, or held_out_file with readings of their own");
  refuse_if(plan.loss != LossKind::none, "identify.loss", "a robust loss", "loss = \"none\"");
  refuse_if(plan.strategy != Strategy::joint, "identify.strategy", "a strategy in stages", "strategy = \"joint\"");
  refuse_if(plan.estimate_variance_factor, "identify.variance_factor", "estimating it", "variance_factor = \"stated\"");
  refuse_if(plan.estimate_pose_noise, "identify.pose_noise", "estimating it", "pose_noise = \"none\"");
  refuse_if(plan.estimate_block_noise, "identify.block_noise", "estimating it", "block_noise = \"none\"");
  refuse_if(plan.select_order, "identify.motion.orders", "a choice of orders", "`order` instead of `orders`");
  refuse_if(plan.select_terms, "identify.motion.optional", "a choice of terms", "terms that are all identified");
  refuse_if(plan.rank_sensors, "identify.rank_sensors", "ranking sensors", "rank_sensors = false");
  refuse_if(plan.monte_carlo > 0, "identify.monte_carlo", "Monte Carlo", "monte_carlo = 0");
  refuse_if(setup.drift.has_value(), "setup.drift", "a drift of the set-up", "set-ups that stand still");
  refuse_if(!study.channels.files.empty(), "channels", "reading recorded channels",
            "columns of the states in the files of readings");
  refuse_if(!setup.channels.files.empty(), "setup.channels", "reading recorded channels",
            "columns of the states in the files of readings");
}

void list_kept_outliers(const Problem& kept, double quantile, Identification& identified) {
  for (std::size_t o = 0; o < kept.observations.size(); ++o) {
    const Observations& own = *kept.observations[o].observations;
    const std::size_t rows = static_cast<std::size_t>(own.rows());
    const double limit = std::sqrt(chi_square_quantile(quantile, own.rows()));
    const std::vector<double> residuals = residuals_by_reading(own);
    for (std::size_t k = 0; k < own.reading_count(); ++k) {
      double square = 0;
      for (std::size_t row = 0; row < rows; ++row) square += residuals[k * rows + row] * residuals[k * rows + row];
      if (std::sqrt(square) > limit) identified.outliers.push_back({o, k, std::sqrt(square), 1});
    }
  }
  std::stable_sort(identified.outliers.begin(), identified.outliers.end(),
                   [](const Outlier& a, const Outlier& b) { return a.norm > b.norm; });
}

void tell_streamed(const Problem& streamed, double quantile, int threads, const WorkDriver& driver,
                   StudyResult& result) {
  const Eigen::VectorXd& estimates = result.identification.estimates;
  for (std::size_t s = 0; s < result.campaign.setups.size(); ++s) {
    const CampaignSetup& setup = result.campaign.setups[s];
    if (!setup.shards) continue;
    Digest digest;
    digest.add_text(vector_instructions());
    digest.add_text(setup.name);
    digest.add(setup.shards->fingerprint());
    digest.add_numbers({estimates.data(), static_cast<std::size_t>(estimates.size())});
    const Observations& all = *streamed.observations[s].observations;
    const NormTally tally =
        tally_norms(all, std::sqrt(chi_square_quantile(quantile, all.rows())), digest.value(), threads, driver);
    result.warnings.push_back(fmt::format(
        "{}: {} of all {} readings are outliers ({:.0f} by chance); the largest residual is {:.3g} standard "
        "uncertainties, {}",
        setup.name, static_cast<std::size_t>(tally.beyond), setup.shards->count(),
        quantile * static_cast<double>(setup.shards->count()), tally.largest,
        setup.shards->place(static_cast<std::size_t>(tally.reading))));
  }
}

}  // namespace

std::shared_ptr<const ReadingShards> shards_too_large(const Study& study, const Setup& setup,
                                                      const JobOptions& options) {
  if (!study.identification || study.identification->readings_in_memory == 0) return nullptr;
  if (std::any_of(setup.data.begin(), setup.data.end(), [](const SetupData& data) { return bool(data.readings); })) {
    return nullptr;
  }
  ShardSource source{.files = {},
                     .form = instrument_form(setup.instrument).readings,
                     .machine = study.machine,
                     .device = setup.device,
                     .setup = setup.name,
                     .noise_from_data = setup.noise_from_data,
                     .drawn = study.identification->readings_in_memory,
                     .threads = study.threads,
                     .work = options.work,
                     .stop = options.stop,
                     .progress = options.progress};
  for (const SetupData& data : setup.data) source.files.push_back({data.file, data.mapping});
  auto shards = std::make_shared<const ReadingShards>(std::move(source));
  if (shards->count() <= study.identification->readings_in_memory) return nullptr;
  require_streamable(study, setup, shards->count());
  return shards;
}

void take_shards(CampaignSetup& setup, std::vector<std::string>& warnings) {
  setup.device = setup.shards->device();
  setup.readings = setup.shards->drawn();
  const std::vector<std::string>& told = setup.shards->contradictions();
  setup.contradictions.insert(setup.contradictions.end(), told.begin(), told.end());
  warnings.push_back(fmt::format(
      "{}: the {} readings of {} file{} are read again for every sum of an identification, which is from all of them; "
      "start values, residual figures, plots, the list of outliers, the search for patterns and everything else are "
      "those of {} readings drawn from them",
      setup.name, setup.shards->count(), setup.shards->file_count(), setup.shards->file_count() == 1 ? "" : "s",
      setup.readings.count()));
}

std::size_t all_reading_count(const CampaignSetup& setup) {
  return setup.shards ? setup.shards->count() : setup.reading_count();
}

std::size_t all_reading_count(const Campaign& campaign) {
  std::size_t count = 0;
  for (const CampaignSetup& setup : campaign.setups) count += all_reading_count(setup);
  return count;
}

bool is_streamed(const Campaign& campaign) {
  return std::any_of(campaign.setups.begin(), campaign.setups.end(),
                     [](const CampaignSetup& setup) { return setup.shards != nullptr; });
}

void identify_streamed(const Study& study, const IdentifyOptions& given, const IdentificationJob& job,
                       StudyResult& result) {
  Problem& kept = result.model.problem;
  Problem streamed = kept, elsewhere = kept;
  std::uint64_t readings = 0;
  for (std::size_t s = 0; s < streamed.observations.size(); ++s) {
    const CampaignSetup& setup = result.campaign.setups[s];
    if (!setup.shards) continue;
    readings = readings * 31 + setup.shards->fingerprint();
    for (Problem* problem : {&streamed, &elsewhere}) {
      problem->observations[s].observations =
          std::make_shared<StreamedObservations>(kept.machine, kept.errors, setup.start, setup.shards);
    }
  }
  auto sums = std::make_shared<StreamedSums>(std::move(elsewhere), readings, study.threads, job);
  IdentifyOptions options = given;
  options.list_outliers = false;
  options.solver.summation =
      Summation([sums](const SumRequest& request, const std::stop_token& stop) { return sums->sum(request, stop); },
                [sums](const ReadingPoint& reference, const std::stop_token& stop) {
                  return sums->fingerprints(reference, stop);
                });
  result.identification = identify(streamed, options);
  if (result.identification.estimates.size() > 0) {
    keep_estimates(kept, result.identification.estimates);
    list_kept_outliers(kept, options.outlier_norm_quantile, result.identification);
    tell_streamed(streamed, options.outlier_norm_quantile, study.threads, job.work, result);
  }
}

}  // namespace abbe
