#include "abbe/study/streamed_identification.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "abbe/formats/files/sum_journal.h"
#include "abbe/formats/readings/streamed_observations.h"
#include "abbe/formats/study/study_instrument.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/parallel_blocks.h"
#include "abbe/geometry/stopped.h"
#include "abbe/identify/distributions.h"
#include "abbe/identify/normal_equations.h"

namespace abbe {
namespace {

/// @throws InputError where the study asks for something that needs all readings in memory
void require_streamable(const Study& study, const Setup& setup) {
  const IdentificationPlan& plan = *study.identification;
  const auto refuse_if = [](bool asked, const char* field, const char* what, const char* expected) {
    if (!asked) return;
    throw InputError({.field = field},
                     fmt::format("{} needs all readings in memory, and they are more than `readings_in_memory`", what),
                     expected);
  };
  refuse_if(plan.held_out_fraction > 0 && !plan.held_out_file, "identify.held_out_fraction", "holding out readings",
            "held_out_fraction = 0, or held_out_file with readings of their own");
  refuse_if(plan.loss != LossKind::none, "identify.loss", "a robust loss", "loss = \"none\"");
  refuse_if(plan.strategy != Strategy::joint, "identify.strategy", "a strategy in stages", "strategy = \"joint\"");
  refuse_if(plan.estimate_variance_factor || plan.estimate_pose_noise || plan.estimate_block_noise,
            "identify.estimate_variances", "estimating variances", "stated uncertainties");
  refuse_if(plan.select_order, "identify.motion.orders", "a choice of orders", "`order` instead of `orders`");
  refuse_if(plan.select_terms || plan.rank_sensors, "identify.motion.optional", "a choice of terms or sensors",
            "terms that are all identified");
  refuse_if(plan.monte_carlo > 0, "identify.monte_carlo", "Monte Carlo", "monte_carlo = 0");
  refuse_if(setup.drift.has_value(), "setup.drift", "a drift of the set-up", "set-ups that stand still");
  refuse_if(!study.channels.files.empty() || !setup.channels.files.empty(), "channel", "recorded channels",
            "columns of the states in the files of readings");
}

std::uint64_t key_of(std::span<const std::byte> request, PieceRange range, std::uint64_t readings) {
  std::uint64_t key = readings;
  const auto mix = [&key](std::uint64_t word) {
    key = (key ^ word) * 0x9fb21c651e98df25U;
    key ^= key >> 29;
  };
  for (const std::byte byte : request) mix(static_cast<std::uint64_t>(byte));
  mix(range.first);
  mix(range.last);
  return key;
}

/// Sums of the readings on disk, a few pieces at a time, each kept in the journal.
class JournalledSums {
 public:
  JournalledSums(Problem problem, SumJournal& journal, std::uint64_t readings, int threads, ProgressCallback progress)
      : summer_(std::move(problem)),
        journal_(journal),
        readings_(readings),
        threads_(threads),
        progress_(std::move(progress)) {}

  SumOfReadings operator()(const SumRequest& request, const std::stop_token& stop) {
    if (!model_known_) take_model(request);
    const std::vector<std::byte> asked = to_bytes(request);
    const std::size_t together =
        static_cast<std::size_t>(std::max(1, threads_ > 0 ? threads_ : default_thread_count()));
    std::vector<SumOfReadings> parts;
    for (std::size_t first = 0; first < request.pieces; first += together) {
      stop_if_asked(stop);
      const PieceRange range{first, std::min(first + together, request.pieces)};
      const std::uint64_t key = key_of(asked, range, readings_);
      if (std::optional<SumOfReadings> earlier = kept(key, range)) {
        parts.push_back(std::move(*earlier));
      } else {
        parts.push_back(summer_.sum(request, range, {threads_, stop, {}}));
        journal_.add(key, to_bytes(parts.back()));
      }
      // Nobody knows how many sums the solver will ask for; this is how far the present one has come.
      if (progress_) progress_(range.last, request.pieces);
    }
    return merge_all(std::move(parts));
  }

 private:
  /// The fingerprint of the first piece tells other models apart, whose sums must not be taken.
  void take_model(const SumRequest& request) {
    SumRequest cost = request;
    cost.kind = SumKind::cost;
    cost.covariance.clear();
    const SumOfReadings first = summer_.sum(cost, {0, 1}, {threads_, {}, {}});
    readings_ ^= first.readings.front();
    model_known_ = true;
  }

  std::optional<SumOfReadings> kept(std::uint64_t key, PieceRange range) const {
    const std::optional<std::vector<std::byte>> bytes = journal_.find(key);
    if (!bytes) return std::nullopt;
    try {
      SumOfReadings sum = sum_from_bytes(*bytes);
      if (sum.range == range && sum.processor == vector_instructions()) return sum;
    } catch (const SumError&) {  // damaged on disk: made again
    }
    return std::nullopt;
  }

  PieceSummer summer_;
  SumJournal& journal_;
  std::uint64_t readings_;
  int threads_;
  ProgressCallback progress_;
  bool model_known_ = false;
};

/// What is said of all readings after the fit, without keeping anything of each.
struct NormTally {
  std::size_t beyond = 0;
  double largest = 0;
  std::size_t reading = 0;
};

NormTally tally_norms(const Observations& observations, double limit, int threads) {
  constexpr std::size_t kBlock = Observations::kBlockSize, kTogether = ReadingShards::kTogether;
  const std::size_t count = observations.reading_count(), rows = static_cast<std::size_t>(observations.rows());
  NormTally total;
  std::mutex mutex;
  for_each_block((count + kTogether - 1) / kTogether, threads, [&](std::size_t part) {
    NormTally own;
    std::vector<double> residuals(rows * kBlock);
    const std::size_t last = std::min(count, (part + 1) * kTogether);
    for (std::size_t first = part * kTogether; first < last; first += kBlock) {
      const std::size_t n = std::min(kBlock, last - first);
      observations.evaluate(first, n, {}, {}, residuals.data(), nullptr, rows * n);
      for (std::size_t k = 0; k < n; ++k) {
        double square = 0;
        for (std::size_t row = 0; row < rows; ++row) square += residuals[row * n + k] * residuals[row * n + k];
        const double norm = std::sqrt(square);
        if (norm > limit) ++own.beyond;
        if (norm > own.largest) own.largest = norm, own.reading = first + k;
      }
    }
    const std::lock_guard lock(mutex);
    total.beyond += own.beyond;
    if (own.largest > total.largest || (own.largest == total.largest && own.reading < total.reading)) {
      total.largest = own.largest;
      total.reading = own.reading;
    }
  });
  return total;
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

void tell_streamed(const Problem& streamed, double quantile, int threads, StudyResult& result) {
  for (std::size_t s = 0; s < result.campaign.setups.size(); ++s) {
    const CampaignSetup& setup = result.campaign.setups[s];
    if (!setup.shards) continue;
    const Observations& all = *streamed.observations[s].observations;
    const NormTally tally = tally_norms(all, std::sqrt(chi_square_quantile(quantile, all.rows())), threads);
    result.warnings.push_back(fmt::format(
        "{}: {} of all {} readings are outliers ({:.0f} by chance); the largest residual is {:.3g} standard "
        "uncertainties, {}",
        setup.name, tally.beyond, setup.shards->count(), quantile * static_cast<double>(setup.shards->count()),
        tally.largest, setup.shards->place(tally.reading)));
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
                     .threads = study.threads,
                     .stop = options.stop,
                     .progress = options.progress};
  for (const SetupData& data : setup.data) source.files.push_back({data.file, data.mapping});
  auto shards = std::make_shared<const ReadingShards>(std::move(source));
  if (shards->count() <= study.identification->readings_in_memory) return nullptr;
  require_streamable(study, setup);
  return shards;
}

void take_shards(const IdentificationPlan& plan, CampaignSetup& setup, std::vector<std::string>& warnings) {
  setup.device = setup.shards->device();
  setup.readings = setup.shards->drawn(plan.readings_in_memory);
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

void identify_streamed(const Study& study, const IdentifyOptions& given, const ProgressCallback& progress,
                       StudyResult& result) {
  if (given.solver.summation) {
    throw InputError({.field = "identify.readings_in_memory"},
                     "readings that do not fit into memory are summed by one process", "abbe run without mpirun");
  }
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
  std::filesystem::path file = study.output;
  file += ".sums";
  SumJournal journal(file);
  if (journal.size() > 0) {
    result.warnings.push_back(
        fmt::format("goes on from {} sums that an earlier run left in {}", journal.size(), file.string()));
  }
  auto sums = std::make_shared<JournalledSums>(std::move(elsewhere), journal, readings, study.threads, progress);
  IdentifyOptions options = given;
  options.list_outliers = false;
  options.solver.summation = [sums](const SumRequest& request, const std::stop_token& stop) {
    return (*sums)(request, stop);
  };
  result.identification = identify(streamed, options);
  if (result.identification.estimates.size() > 0) {
    keep_estimates(kept, result.identification.estimates);
    list_kept_outliers(kept, options.outlier_norm_quantile, result.identification);
    tell_streamed(streamed, options.outlier_norm_quantile, study.threads, result);
  }
  journal.remove();
}

}  // namespace abbe
