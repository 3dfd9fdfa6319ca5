#include <fmt/format.h>

#include <algorithm>

#include "abbe/geometry/cross_products.h"
#include "abbe/identify/normal_equations.h"
#include "abbe/identify/sums/pose_sums.h"
#include "abbe/identify/sums/reading_fingerprints.h"
#include "abbe/identify/sums/sum_of_readings.h"

namespace abbe {
namespace {

std::uint64_t fingerprint_of(const ReadingPoint& point) {
  SumRequest request;
  request.point = point;
  return point_fingerprint(request);
}

}  // namespace

PieceSummer::PieceSummer(Problem problem)
    : stated_(as_stated(problem)),
      selected_(stated_),
      weighed_(stated_.observations.size()),
      pieces_(divide_readings(stated_)),
      fingerprints_(pieces_.size()),
      is_known_(pieces_.size()) {
  stated_.priors.clear();
  stated_.joint_priors.clear();
}

void PieceSummer::check(const SumRequest& request) const {
  const auto refuse = [](const std::string& what) {
    throw SumError("the request for sums does not fit the readings here: " + what);
  };
  const auto expect = [&](const std::string& what, std::size_t asked, std::size_t here) {
    if (asked != here) refuse(fmt::format("{} {} there, {} here", what, asked, here));
  };
  const auto expect_point = [&](const ReadingPoint& point) {
    expect("parameters of the errors:", point.machine.size(), stated_.errors.parameter_count());
    expect("sets of readings:", point.setups.size(), stated_.observations.size());
    for (std::size_t o = 0; o < point.setups.size(); ++o) {
      const Observations& own = *stated_.observations[o].observations;
      expect("unknowns of the set-up of " + own.name() + ":", point.setups[o].size(), own.unknowns().size());
    }
  };
  expect_point(request.point);
  expect_point(request.reference);
  expect("sets of readings:", request.setups.size(), stated_.observations.size());
  const auto within = [](const std::vector<std::size_t>& list, std::size_t count) {
    return std::all_of(list.begin(), list.end(), [&](std::size_t index) { return index < count; });
  };
  if (!within(request.machine_parameters, request.point.machine.size()))
    refuse("a parameter of the errors is not here");
  for (std::size_t o = 0; o < request.setups.size(); ++o) {
    const SetupSelection& setup = request.setups[o];
    const Observations& own = *stated_.observations[o].observations;
    if (!within(setup.unknowns, own.unknowns().size())) refuse("an unknown of " + own.name() + " is not here");
    if (!setup.use.empty()) expect("readings of " + own.name() + ":", setup.use.size(), own.reading_count());
    if (!setup.weighed && request.kind == SumKind::poses) refuse("sums over poses without variances");
    if (!setup.weighed) continue;
    const ReadingVariance& variance = setup.weights.variance;
    if (!(variance.factor > 0 && variance.pose >= 0)) refuse("variances of " + own.name() + " below zero");
    if (variance.pose > 0 && !setup.weights.is_known) refuse("a pose variance without its point");
    if (!setup.weights.is_known) continue;
    expect("parameters of the errors:", setup.weights.machine.size(), stated_.errors.parameter_count());
    expect("unknowns of the set-up of " + own.name() + ":", setup.weights.setup.size(), own.unknowns().size());
  }
  std::size_t p = request.machine_parameters.size();
  for (const SetupSelection& setup : request.setups) p += setup.unknowns.size();
  if (request.kind == SumKind::poses) expect("entries of the covariance:", request.covariance.size(), p * p);
}

void PieceSummer::select(const SumRequest& request) {
  selected_.machine_parameters = request.machine_parameters;
  for (std::size_t o = 0; o < request.setups.size(); ++o) {
    const SetupSelection& setup = request.setups[o];
    SelectedObservations& selected = selected_.observations[o];
    if (selected.use != setup.use) weighed_[o].reset();
    selected.unknowns = setup.unknowns;
    selected.use = setup.use;
    selected.observations = stated_.observations[o].observations;
    if (!setup.weighed) continue;
    if (!weighed_[o]) {
      weighed_[o] = std::make_shared<WeighedObservations>(selected.observations, selected.use, selected.common);
    }
    // Derivatives by the displacement of all readings: only where they are others than last time.
    if (!(weighed_[o]->weights() == setup.weights)) weighed_[o]->weigh_at(setup.weights);
    selected.observations = weighed_[o];
  }
}

const std::vector<std::uint64_t>& PieceSummer::fingerprints(const ReadingPoint& reference, PieceRange range,
                                                            int threads) {
  if (const std::uint64_t now = fingerprint_of(reference); now != reference_) {
    std::fill(is_known_.begin(), is_known_.end(), std::uint8_t{0});
    reference_ = now;
  }
  const auto first = is_known_.begin() + static_cast<std::ptrdiff_t>(range.first);
  const auto last = is_known_.begin() + static_cast<std::ptrdiff_t>(range.last);
  if (std::find(first, last, 0) != last) {
    set_observations(stated_, reference);
    take_fingerprints(stated_, pieces_, range, threads, fingerprints_);
    std::fill(first, last, std::uint8_t{1});
  }
  return fingerprints_;
}

SumOfReadings PieceSummer::sum(const SumRequest& request, PieceRange range, const SumOptions& options) {
  check(request);
  const bool of_poses = request.kind == SumKind::poses;
  SumOfReadings result;
  result.kind = request.kind;
  result.point = point_fingerprint(request);
  result.selection = selection_fingerprint(request);
  result.processor = vector_instructions();
  result.range = range;
  std::vector<std::uint64_t> known;
  if (of_poses) {
    select(request);
    const std::vector<ReadingPiece> poses = divide_poses(weighed_observations(selected_));
    known =
        fingerprints_of_poses(poses, pieces_, fingerprints(request.reference, {0, pieces_.size()}, options.threads));
  } else {
    if (range.first <= range.last && range.last <= pieces_.size())
      known = fingerprints(request.reference, range, options.threads);
    known.resize(pieces_.size());
    select(request);
  }
  result.pieces = known.size();
  if (request.pieces != result.pieces)
    throw SumError(fmt::format("the request for sums is of another problem: {} pieces there, {} here", request.pieces,
                               result.pieces));
  if (range.first > range.last || range.last > result.pieces)
    throw SumError(
        fmt::format("pieces {} to {} were asked for, but there are {}", range.first, range.last, result.pieces));
  result.readings.assign(known.begin() + static_cast<std::ptrdiff_t>(range.first),
                         known.begin() + static_cast<std::ptrdiff_t>(range.last));
  set_observations(selected_, request.point);
  result.values = ReadingStream(selected_, options.threads)
                      .sum_pieces(request.kind, request.loss, request.covariance, range, options);
  return result;
}

}  // namespace abbe
