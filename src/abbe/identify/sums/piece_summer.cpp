#include <fmt/format.h>

#include <algorithm>

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

void refuse(const std::string& what) { throw SumError("the request for sums does not fit the readings here: " + what); }

void expect(const std::string& what, std::size_t asked, std::size_t here) {
  if (asked != here) refuse(fmt::format("{} {} there, {} here", what, asked, here));
}

}  // namespace

PieceSummer::PieceSummer(const Problem& problem)
    : stated_(as_stated(problem)),
      selected_(stated_),
      weighed_(stated_.observations.size()),
      pieces_(divide_readings(stated_)),
      fingerprints_(pieces_.size()),
      is_known_(pieces_.size()) {
  stated_.priors.clear();
  stated_.joint_priors.clear();
}
PieceSummer::~PieceSummer() = default;

void PieceSummer::check(const ReadingPoint& point) const {
  expect("parameters of the errors:", point.machine.size(), stated_.errors.parameter_count());
  expect("sets of readings:", point.setups.size(), stated_.observations.size());
  for (std::size_t o = 0; o < point.setups.size(); ++o) {
    const Observations& own = *stated_.observations[o].observations;
    expect("unknowns of the set-up of " + own.name() + ":", point.setups[o].size(), own.unknowns().size());
  }
}

void PieceSummer::check(const SumRequest& request) const {
  check(request.point);
  check(request.reference);
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
  check(reference);
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

void PieceSummer::prepare_fingerprints(const ReadingPoint& reference) {
  check(reference);
  set_observations(stated_, reference);
}

std::uint64_t PieceSummer::fingerprint(std::size_t piece) const {
  return fingerprint_of_readings(stated_, pieces_[piece]);
}

void PieceSummer::set_fingerprints(const ReadingPoint& reference, std::vector<std::uint64_t> fingerprints) {
  expect("pieces:", fingerprints.size(), pieces_.size());
  reference_ = fingerprint_of(reference);
  fingerprints_ = std::move(fingerprints);
  std::fill(is_known_.begin(), is_known_.end(), std::uint8_t{1});
}

const std::vector<std::uint64_t>* PieceSummer::known_fingerprints(const ReadingPoint& reference) const {
  const bool all =
      reference_ == fingerprint_of(reference) && std::find(is_known_.begin(), is_known_.end(), 0) == is_known_.end();
  return all ? &fingerprints_ : nullptr;
}

void PieceSummer::prepare(const SumRequest& request, PieceRange range, int threads) {
  check(request);
  SumOfReadings head = begin_sum(request);
  if (request.kind == SumKind::poses) {
    select(request);
    const std::vector<ReadingPiece> poses = divide_poses(weighed_observations(selected_));
    head.readings =
        fingerprints_of_poses(poses, pieces_, fingerprints(request.reference, {0, pieces_.size()}, threads));
  } else {
    if (range.first <= range.last && range.last <= pieces_.size())
      head.readings = fingerprints(request.reference, range, threads);
    head.readings.resize(pieces_.size());
    select(request);
  }
  head.pieces = head.readings.size();
  if (request.pieces != head.pieces)
    throw SumError(fmt::format("the request for sums is of another problem: {} pieces there, {} here", request.pieces,
                               head.pieces));
  set_observations(selected_, request.point);
  stream_ = std::make_unique<ReadingStream>(selected_, threads);
  head_ = std::move(head);
  request_ = request;
}

SumOfReadings PieceSummer::sum_prepared(PieceRange range, const SumOptions& options) const {
  if (!stream_) throw SumError("no request for sums was prepared");
  if (range.first > range.last || range.last > head_.pieces)
    throw SumError(
        fmt::format("pieces {} to {} were asked for, but there are {}", range.first, range.last, head_.pieces));
  SumOfReadings result;
  result.kind = head_.kind;
  result.point = head_.point;
  result.selection = head_.selection;
  result.processor = head_.processor;
  result.pieces = head_.pieces;
  result.range = range;
  result.readings.assign(head_.readings.begin() + static_cast<std::ptrdiff_t>(range.first),
                         head_.readings.begin() + static_cast<std::ptrdiff_t>(range.last));
  result.values = stream_->sum_pieces(request_.kind, request_.loss, request_.covariance, range, options);
  return result;
}

SumOfReadings PieceSummer::sum(const SumRequest& request, PieceRange range, const SumOptions& options) {
  prepare(request, range, options.threads);
  return sum_prepared(range, options);
}

}  // namespace abbe
