#include "abbe/study/identification/streamed_identification.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "abbe/formats/readings/streamed_observations.h"
#include "abbe/formats/study/study_instrument.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/digest.h"
#include "abbe/geometry/numbered_work.h"
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

/// Sums of the readings on disk as numbered work, so that finished ones can be kept in a file and shared by processes.
class StreamedSums {
 public:
  StreamedSums(Problem problem, std::uint64_t readings, int threads, const IdentificationJob& job)
      : summer_(std::move(problem)),
        readings_(readings),
        threads_(threads),
        driver_(job.work),
        progress_(job.progress) {}

  SumOfReadings operator()(const SumRequest& request, const std::stop_token& stop) {
    summer_.prepare(request, {0, summer_.piece_count()}, threads_);
    std::vector<SumOfReadings> parts(request.pieces);
    std::size_t done = 0;
    NumberedWork work{.name = "sums over the readings", .blocks = parts.size(), .threads = threads_};
    work.is_followed = true;
    work.for_all = true;
    work.fingerprint = [&] { return fingerprint(request); };
    work.compute = [&](std::size_t piece) {
      stop_if_asked(stop);
      parts[piece] = summer_.sum_prepared({piece, piece + 1}, {1, stop, {}});
    };
    work.pack = [&](std::size_t piece, std::vector<std::byte>& bytes) {
      const std::vector<std::byte> sum = to_bytes(parts[piece]);
      bytes.insert(bytes.end(), sum.begin(), sum.end());
    };
    work.unpack = [&](std::size_t piece, std::span<const std::byte> bytes) {
      try {
        parts[piece] = sum_from_bytes(bytes);
      } catch (const SumError& error) {
        throw WorkError(error.what());
      }
      if (!(parts[piece].range == PieceRange{piece, piece + 1})) throw WorkError("a sum is of another piece");
    };
    // Nobody knows how many sums the solver will ask for; this is how far the present one has come.
    work.finished = [&](std::size_t) {
      if (progress_) progress_(++done, parts.size());
    };
    do_work(driver_, work);
    return merge_all(std::move(parts));
  }

  /// Of the readings of all pieces, as Summation has it.
  std::vector<std::uint64_t> fingerprints(const ReadingPoint& reference, const std::stop_token& stop) {
    if (const std::vector<std::uint64_t>* known = summer_.known_fingerprints(reference)) return *known;
    summer_.prepare_fingerprints(reference);
    std::vector<std::uint64_t> all(summer_.piece_count());
    NumberedWork work{.name = "fingerprints of the readings", .blocks = all.size(), .threads = threads_};
    work.is_followed = true;
    work.for_all = true;
    work.is_kept = false;
    work.fingerprint = [&] {
      Digest digest;
      digest.add_text("fingerprints of the readings");
      digest.add_text(vector_instructions());
      digest.add(readings_);
      digest.add_numbers(reference.machine);
      for (const std::vector<double>& setup : reference.setups) digest.add_numbers(setup);
      return digest.value();
    };
    work.compute = [&](std::size_t piece) {
      stop_if_asked(stop);
      all[piece] = summer_.fingerprint(piece);
    };
    work.pack = [&](std::size_t piece, std::vector<std::byte>& bytes) {
      const auto own = std::as_bytes(std::span(&all[piece], 1));
      bytes.insert(bytes.end(), own.begin(), own.end());
    };
    work.unpack = [&](std::size_t piece, std::span<const std::byte> bytes) {
      const auto own = std::as_writable_bytes(std::span(&all[piece], 1));
      if (bytes.size() != own.size()) throw WorkError("a fingerprint is cut off");
      std::copy(bytes.begin(), bytes.end(), own.begin());
    };
    do_work(driver_, work);
    summer_.set_fingerprints(reference, all);
    return all;
  }

 private:
  /// Of the request, and of all readings and the model: residuals at a point near that of the start.
  std::uint64_t fingerprint(const SumRequest& request) const {
    Digest digest;
    digest.add_text("sums of single pieces");
    digest.add_text(vector_instructions());
    digest.add_bytes(to_bytes(request));
    digest.add(readings_);
    if (const std::vector<std::uint64_t>* known = summer_.known_fingerprints(request.reference)) {
      for (const std::uint64_t of_piece : *known) digest.add(of_piece);
    }
    return digest.value();
  }

  PieceSummer summer_;
  std::uint64_t readings_;
  int threads_;
  WorkDriver driver_;
  ProgressCallback progress_;
};

/// What is said of all readings after the fit, without keeping anything of each.
struct NormTally {
  double beyond = 0;  ///< number of readings
  double largest = 0;
  double reading = 0;  ///< number of the first one that has it

  void take(const NormTally& other) {
    beyond += other.beyond;
    if (other.largest > largest || (other.largest == largest && other.reading < reading)) {
      largest = other.largest;
      reading = other.reading;
    }
  }
};

NormTally tally_part(const Observations& observations, double limit, std::size_t first, std::size_t last) {
  constexpr std::size_t kBlock = Observations::kBlockSize;
  const std::size_t rows = static_cast<std::size_t>(observations.rows());
  NormTally own;
  std::vector<double> residuals(rows * kBlock);
  for (; first < last; first += kBlock) {
    const std::size_t n = std::min(kBlock, last - first);
    observations.evaluate(first, n, {}, {}, residuals.data(), nullptr, rows * n);
    for (std::size_t k = 0; k < n; ++k) {
      double square = 0;
      for (std::size_t row = 0; row < rows; ++row) square += residuals[row * n + k] * residuals[row * n + k];
      const double norm = std::sqrt(square);
      if (norm > limit) own.beyond += 1;
      if (norm > own.largest) own.largest = norm, own.reading = static_cast<double>(first + k);
    }
  }
  return own;
}

/// @param fingerprint  of readings and estimates
NormTally tally_norms(const Observations& observations, double limit, std::uint64_t fingerprint, int threads,
                      const WorkDriver& driver) {
  constexpr std::size_t kBlocks = 256, kMostTogether = 8;
  const std::size_t count = observations.reading_count(),
                    parts = (count + ReadingShards::kTogether - 1) / ReadingShards::kTogether,
                    together = ReadingShards::kTogether * std::clamp<std::size_t>(parts / kBlocks, 1, kMostTogether);
  std::vector<NormTally> tallies((count + together - 1) / together);
  NumberedWork work{.name = "norms of the residuals", .blocks = tallies.size(), .threads = threads};
  work.is_followed = true;
  work.for_all = true;
  work.is_kept = false;
  work.fingerprint = [&] { return fingerprint; };
  work.compute = [&](std::size_t block) {
    tallies[block] = tally_part(observations, limit, block * together, std::min(count, (block + 1) * together));
  };
  work.pack = [&](std::size_t block, std::vector<std::byte>& bytes) {
    const NormTally& own = tallies[block];
    pack_numbers(std::array{own.beyond, own.largest, own.reading}, bytes);
  };
  work.unpack = [&](std::size_t block, std::span<const std::byte> bytes) {
    std::array<double, 3> numbers{};
    unpack_numbers(bytes, numbers);
    require_unpacked(bytes);
    tallies[block] = {numbers[0], numbers[1], numbers[2]};
  };
  do_work(driver, work);
  NormTally total;
  for (const NormTally& own : tallies) total.take(own);
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
  require_streamable(study, setup);
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
      Summation([sums](const SumRequest& request, const std::stop_token& stop) { return (*sums)(request, stop); },
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
