#include "abbe/identify/sums/sum_of_readings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "abbe/geometry/parallel_blocks.h"
#include "abbe/geometry/stopped.h"
#include "abbe/identify/function_observations_test.h"
#include "abbe/identify/normal_equations.h"
#include "abbe/identify/pose_noise_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using Bytes = std::vector<std::byte>;

/// Two sets of readings, of 12 and 3 pieces; every seventh reading and one whole piece are left out.
struct TwoInstruments {
  explicit TwoInstruments(std::uint64_t seed = 1)
      : first(250, test::PoseObservations::simulate(seed, 250, 6, 1, 0.05)),
        second(60, test::PoseObservations::simulate(9, 60, 5, 1, 0.05)),
        problem(function_problem({&first, &second})) {
    problem.observations[1].unknowns = {0, 2, 4};
    problem.observations[0].use.assign(first.reading_count(), 1);
    for (std::size_t k = 0; k < first.reading_count(); k += 7) problem.observations[0].use[k] = 0;
    for (std::size_t k = 256; k < 384; ++k) problem.observations[0].use[k] = 0;
  }
  test::PoseObservations first, second;
  Problem problem;
};

SumRequest request_of(const Problem& problem, SumKind kind) {
  SumRequest request;
  request.kind = kind;
  request.pieces = divide_readings(problem).size();
  request.loss = Loss{LossKind::cauchy, 0, 1.5};
  request.point = reading_point(problem, present_values(problem));
  request.reference = request.point;
  for (const SelectedObservations& selected : problem.observations)
    request.setups.push_back({selected.unknowns, selected.use, false, {}});
  return request;
}

std::vector<SumOfReadings> parts_of(PieceSummer& summer, const SumRequest& request,
                                    const std::vector<std::size_t>& cuts) {
  std::vector<SumOfReadings> parts;
  std::size_t next = 0;
  for (const std::size_t cut : cuts) {
    parts.push_back(summer.sum(request, {next, cut}));
    next = cut;
  }
  parts.push_back(summer.sum(request, {next, summer.piece_count()}));
  return parts;
}

std::string message_of_merge(std::vector<SumOfReadings> parts) {
  try {
    merge_all(std::move(parts));
  } catch (const SumError& error) {
    return error.what();
  }
  return "merged";
}

TEST(ReadingPieces, CoverAllReadingsOnceInOrderAndDependOnTheirNumberOnly) {
  TwoInstruments two;
  const std::vector<ReadingPiece> pieces = divide_readings(two.problem);
  ASSERT_EQ(pieces.size(), 15U);
  std::size_t next = 0, observations = 0;
  for (const ReadingPiece& piece : pieces) {
    if (piece.observations != observations) {
      EXPECT_EQ(next, two.first.reading_count());
      next = 0;
    }
    observations = piece.observations;
    EXPECT_EQ(piece.first, next);
    next = piece.last;
    EXPECT_TRUE((next - piece.first) % Observations::kBlockSize == 0 || next == 1500 || next == 300);
  }
  EXPECT_EQ(next, two.second.reading_count());
  test::PoseObservations many(10, std::vector<double>(std::size_t{3} * 100000));
  EXPECT_EQ(divide_readings(function_problem({&many})).size(), 46U);  // 782 blocks, 17 together
  two.problem.observations[0].use.clear();
  EXPECT_EQ(divide_readings(two.problem).size(), 15U);
}

TEST(ReadingPieces, OfMoreReadingsAreLongerAndThenMore) {
  const auto pieces_of = [](std::size_t readings) {
    const std::size_t blocks = (readings + Observations::kBlockSize - 1) / Observations::kBlockSize;
    return (readings + readings_of_piece(blocks) - 1) / readings_of_piece(blocks);
  };
  EXPECT_EQ(readings_of_piece(0), 128U);
  EXPECT_EQ(readings_of_piece(1), 128U);
  EXPECT_EQ(readings_of_piece(48), 128U);
  EXPECT_EQ(readings_of_piece(49), 256U);
  EXPECT_EQ(readings_of_piece(255 * 48), 255 * 128U);
  EXPECT_EQ(readings_of_piece(255 * 48 + 1), 32768U);
  EXPECT_EQ(readings_of_piece(256 * 48 + 1), 32768U + 4096U);
  EXPECT_EQ(pieces_of(3'000'000), 46U);
  EXPECT_EQ(pieces_of(12'800'000), 196U);
  EXPECT_EQ(pieces_of(100'000'000), 255U);
  EXPECT_EQ(pieces_of(1'000'000'000), 256U);
  for (std::size_t readings = 1; readings < 2'000'000'000; readings += 1 + readings / 7) {
    const std::size_t pieces = pieces_of(readings);
    EXPECT_LE(pieces, readings <= 3'145'728 ? 48U : 256U) << readings;
    EXPECT_GE(pieces, std::min<std::size_t>(24, (readings + 127) / 128)) << readings;
  }
}

TEST(ReadingPieces, AreSharedOutWholeAndEvenly) {
  for (const std::size_t processes : {1, 2, 3, 7, 20}) {
    std::size_t next = 0;
    for (std::size_t i = 0; i < processes; ++i) {
      const PieceRange share = share_of_pieces(15, i, processes);
      EXPECT_EQ(share.first, next);
      EXPECT_LE(share.count(), 15 / processes + 1);
      next = share.last;
    }
    EXPECT_EQ(next, 15U);
  }
}

TEST(SumOfReadings, OfPartsInAnyOrderHasTheBytesOfTheWhole) {
  TwoInstruments two;
  PieceSummer summer(two.problem);
  for (const SumKind kind : {SumKind::cost, SumKind::gradient, SumKind::normal, SumKind::norms, SumKind::factor}) {
    const SumRequest request = request_of(two.problem, kind);
    const Bytes whole = to_bytes(summer.sum(request, {0, 15}, {.threads = 3}));
    std::vector<SumOfReadings> parts;
    for (const SumOfReadings& part : parts_of(summer, request, {1, 1, 8, 13})) {
      const Bytes sent = to_bytes(part);
      parts.push_back(sum_from_bytes(sent));
    }
    std::rotate(parts.begin(), parts.begin() + 2, parts.end());
    EXPECT_EQ(to_bytes(merge_all(parts)), whole) << kind_words(kind);
    EXPECT_EQ(to_bytes(request_from_bytes(to_bytes(request))), to_bytes(request));
  }
}

TEST(SumOfReadings, GivesTheStreamTheBytesThatItHasByItself) {
  TwoInstruments two;
  PieceSummer summer(two.problem);
  const Eigen::VectorXd x = present_values(two.problem);
  const Loss loss{LossKind::huber, 0, 1};
  int sums = 0;
  const ReadingStream here(two.problem, 2);
  const ReadingStream there(two.problem, 2, [&](const SumRequest& request, const std::stop_token&) {
    ++sums;
    return merge_all(parts_of(summer, request_from_bytes(to_bytes(request)), {5, 12}));
  });
  for (const Wanted wanted : {Wanted::cost, Wanted::gradient, Wanted::normal}) {
    const NormalEquations a = here.sums(x, loss, wanted), b = there.sums(x, loss, wanted);
    EXPECT_EQ(a.cost, b.cost);
    EXPECT_EQ(a.gradient, b.gradient);
    EXPECT_EQ(a.normal, b.normal);
  }
  EXPECT_EQ(here.norms(x), there.norms(x));
  EXPECT_EQ(here.orthogonal_factor(x, loss), there.orthogonal_factor(x, loss));
  EXPECT_EQ(sums, 5);
}

TEST(SumOfReadings, AreMadeByTheStreamItselfWhereProcessesShareThem) {
  TwoInstruments two;
  const Eigen::VectorXd x = present_values(two.problem);
  bool lose = false;
  const Summation shared([&](const SumRequest& request, const Summation::Here& here, const std::stop_token&) {
    std::vector<SumOfReadings> parts;
    for (const std::size_t process : {2, 0, 1}) {
      if (lose && process == 1) continue;
      parts.push_back(sum_from_bytes(to_bytes(here(share_of_pieces(request.pieces, process, 3)))));
    }
    return merge_all(std::move(parts));
  });
  const ReadingStream alone(two.problem, 2), together(two.problem, 2, shared);
  const Loss loss{LossKind::huber, 0, 1};
  const NormalEquations a = alone.sums(x, loss, Wanted::normal), b = together.sums(x, loss, Wanted::normal);
  EXPECT_EQ(a.cost, b.cost);
  EXPECT_EQ(a.gradient, b.gradient);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(alone.norms(x), together.norms(x));
  EXPECT_EQ(alone.orthogonal_factor(x, loss), together.orthogonal_factor(x, loss));
  lose = true;
  EXPECT_THROW(together.sums(x, loss, Wanted::cost), SumError);
}

TEST(SumOfReadings, OfAPreparedRequestIsThatOfTheRequest) {
  TwoInstruments two;
  PieceSummer summer(two.problem), prepared(two.problem);
  EXPECT_THROW(prepared.sum_prepared({0, 0}), SumError);
  for (const SumKind kind : {SumKind::gradient, SumKind::normal, SumKind::norms}) {
    const SumRequest request = request_of(two.problem, kind);
    prepared.prepare(request, {0, 15}, 2);
    std::vector<SumOfReadings> pieces(15);
    for_each_block(15, 3, [&](std::size_t i) { pieces[i] = prepared.sum_prepared({i, i + 1}, {.threads = 1}); });
    EXPECT_EQ(to_bytes(merge_all(pieces)), to_bytes(summer.sum(request, {0, 15})));
    EXPECT_THROW(prepared.sum_prepared({14, 16}), SumError);
  }
}

TEST(SumOfReadings, TakesFingerprintsThatAreGivenAndOthersOnce) {
  TwoInstruments two;
  PieceSummer summer(two.problem);
  const SumRequest request = request_of(two.problem, SumKind::cost);
  const std::vector<std::uint64_t> expected = summer.sum(request, {0, 15}).readings;
  PieceSummer other(two.problem);
  EXPECT_EQ(other.known_fingerprints(request.reference), nullptr);
  other.prepare_fingerprints(request.reference);
  std::vector<std::uint64_t> found;
  for (std::size_t i = 0; i < 15; ++i) found.push_back(other.fingerprint(i));
  EXPECT_EQ(found, expected);
  found[3] = 17;
  other.set_fingerprints(request.reference, found);
  ASSERT_NE(other.known_fingerprints(request.reference), nullptr);
  EXPECT_EQ(*other.known_fingerprints(request.reference), found);
  EXPECT_EQ(other.sum(request, {0, 15}).readings, found);
  ReadingPoint elsewhere = request.reference;
  elsewhere.machine[0] += 1e-9;
  EXPECT_EQ(other.known_fingerprints(elsewhere), nullptr);
  EXPECT_THROW(other.set_fingerprints(request.reference, {1, 2}), SumError);
  elsewhere.machine.pop_back();
  EXPECT_THROW(other.prepare_fingerprints(elsewhere), SumError);
}

TEST(SumOfReadings, IsCheckedWithTheFingerprintsOfTheSummation) {
  TwoInstruments two;
  PieceSummer summer(two.problem);
  const auto sum = [&](const SumRequest& request, const std::stop_token&) { return summer.sum(request, {0, 15}); };
  std::uint64_t changed = 0;
  int asked = 0;
  const auto fingerprints = [&](const ReadingPoint& reference, const std::stop_token&) {
    ++asked;
    PieceSummer own(two.problem);
    own.prepare_fingerprints(reference);
    std::vector<std::uint64_t> all;
    for (std::size_t i = 0; i < own.piece_count(); ++i) all.push_back(own.fingerprint(i));
    all[4] += changed;
    return all;
  };
  const Eigen::VectorXd x = present_values(two.problem);
  const NormalEquations here = ReadingStream(two.problem, 1).sums(x, Loss{}, Wanted::normal);
  EXPECT_EQ(ReadingStream(two.problem, 1, Summation(sum, fingerprints)).sums(x, Loss{}, Wanted::normal).normal,
            here.normal);
  EXPECT_EQ(asked, 1);
  changed = 1;
  const ReadingStream other(two.problem, 1, Summation(sum, fingerprints));
  EXPECT_THROW(other.sums(x, Loss{}, Wanted::normal), SumError);
}

// Why the pieces of a range stay apart: a total of the range could not be added to those of others without changing
// the last bits.
TEST(SumOfReadings, TotalsOfRangesWouldNotGiveTheSameBits) {
  TwoInstruments two;
  PieceSummer summer(two.problem);
  const SumOfReadings whole = summer.sum(request_of(two.problem, SumKind::normal), {0, 15});
  const auto total = [&](std::size_t entry, std::size_t first, std::size_t last) {
    double sum = 0;
    for (std::size_t i = first; i < last; ++i)
      if (entry < whole.values[i].size()) sum += whole.values[i][entry];
    return sum;
  };
  int differ = 0;
  for (std::size_t entry = 0; entry < 21; ++entry)
    for (std::size_t cut = 1; cut < 12; ++cut)
      differ += total(entry, 0, cut) + total(entry, cut, 12) != total(entry, 0, 12);
  EXPECT_GT(differ, 20);
}

TEST(SumOfReadings, HoldsTheWeightsOfVarianceComponents) {
  TwoInstruments two;
  auto weighed = std::make_shared<WeighedObservations>(borrowed(two.first), two.problem.observations[0].use);
  Problem problem = two.problem;
  problem.observations[0].observations = weighed;
  set_observations(problem, present_values(problem));
  weighed->weigh({1.7, 0.003});
  TwoInstruments other;  // of another process
  PieceSummer summer(other.problem);
  const auto elsewhere = [&](const SumRequest& request, const std::stop_token&) {
    return merge_all(parts_of(summer, request_from_bytes(to_bytes(request)), {4}));
  };
  const ReadingStream there(problem, 2, elsewhere);
  Eigen::VectorXd x = present_values(problem);
  for (int round = 0; round < 2; ++round) {
    const NormalEquations a = ReadingStream(problem, 2).sums(x, Loss{}, Wanted::normal);
    const NormalEquations b = there.sums(x, Loss{}, Wanted::normal);
    EXPECT_EQ(a.cost, b.cost);
    EXPECT_EQ(a.normal, b.normal);
    x.array() += 0.01;
    set_observations(problem, x);
    weighed->weigh({0.6, 0.02});
  }
  WeighedObservations unknown(borrowed(two.first), two.problem.observations[0].use);
  unknown.weigh({1, 0.003});
  problem.observations[0].observations = borrowed(unknown);
  EXPECT_THROW(ReadingStream(problem, 1, elsewhere).sums(x, Loss{}, Wanted::cost), SumError);
}

TEST(SumOfReadings, ThatDoNotGoTogetherAreNotMerged) {
  TwoInstruments two;
  PieceSummer summer(two.problem);
  const SumRequest request = request_of(two.problem, SumKind::gradient);
  const std::vector<SumOfReadings> good = parts_of(summer, request, {3, 8});
  EXPECT_EQ(message_of_merge(good), "merged");
  EXPECT_EQ(message_of_merge({good[0], good[2]}), "the sum of pieces 3 to 7 is missing");
  EXPECT_EQ(message_of_merge({good[1], good[2]}), "the sum of pieces 0 to 2 is missing");
  EXPECT_EQ(message_of_merge({good[1], good[0]}), "the sum of pieces 8 to 14 is missing");
  EXPECT_EQ(message_of_merge({}), "no pieces have been summed");
  EXPECT_EQ(message_of_merge({good[0], good[1], summer.sum(request, {6, 15})}), "pieces 6 to 7 were summed twice");
  EXPECT_EQ(message_of_merge({good[0], good[1], good[2], summer.sum(request, {2, 3})}), "piece 2 was summed twice");
  SumRequest other = request;
  other.point.setups[0][2] += 1e-15;
  EXPECT_THAT(message_of_merge({good[0], summer.sum(other, {3, 8}), good[2]}), HasSubstr("of different parameters"));
  other = request;
  other.loss.scale = 1.6;
  EXPECT_THAT(message_of_merge({good[0], summer.sum(other, {3, 8}), good[2]}), HasSubstr("or losses"));
  other = request;
  other.kind = SumKind::normal;
  EXPECT_THAT(message_of_merge({good[0], summer.sum(other, {3, 8}), good[2]}),
              HasSubstr("do not go together: gradient and normal equations"));
  std::vector<SumOfReadings> parts = good;
  parts[1].processor = "an older processor";
  EXPECT_THAT(message_of_merge(parts), HasSubstr("different vector instructions"));
  EXPECT_THROW(merge(good[0], good[2]), SumError);
  EXPECT_EQ(merge(good[0], good[1]).range, (PieceRange{0, 8}));
}

TEST(SumOfReadings, OfAnotherProblemOrPointIsRefusedByTheIdentification) {
  TwoInstruments two, same, other(2);
  const Eigen::VectorXd x = present_values(two.problem);
  const auto refusal = [&](const Summation& summation) -> std::string {
    try {
      ReadingStream(two.problem, 1, summation).sums(x, Loss{}, Wanted::normal);
    } catch (const SumError& error) {
      return error.what();
    }
    return "";
  };
  PieceSummer good(same.problem), bad(other.problem);
  EXPECT_EQ(refusal([&](const SumRequest& r, const std::stop_token&) { return good.sum(r, {0, 15}); }), "");
  EXPECT_EQ(
      refusal([&](const SumRequest& r, const std::stop_token&) {
        return bad.sum(r, {0, 15});
      }),
      "the sum of the readings is of another problem: readings 0 to 127 of function are others, or their model is");
  EXPECT_THAT(refusal([&](const SumRequest& r, const std::stop_token&) {
                return merge(good.sum(r, {0, 13}), bad.sum(r, {13, 15}));  // whose second instrument is the same
              }),
              "");
  EXPECT_THAT(refusal([&](const SumRequest& r, const std::stop_token&) {
                return good.sum(r, {0, 14});
              }),
              HasSubstr("is incomplete: it begins with piece 0 and ends before piece 14 of 15"));
  EXPECT_THAT(refusal([&](const SumRequest& r, const std::stop_token&) {
                SumRequest elsewhere = r;
                elsewhere.point.setups[0][0] += 0.1;
                return good.sum(elsewhere, {0, 15});
              }),
              HasSubstr("was made at other parameters"));
  EXPECT_THAT(refusal([&](const SumRequest& r, const std::stop_token&) {
                SumRequest all = r;
                all.setups[0].use.clear();
                return good.sum(all, {0, 15});
              }),
              HasSubstr("another selection"));
  EXPECT_THAT(refusal([&](const SumRequest& r, const std::stop_token&) {
                SumRequest cost = r;
                cost.kind = SumKind::cost;
                return good.sum(cost, {0, 15});
              }),
              HasSubstr("holds cost, not normal equations"));
  EXPECT_THAT(refusal([&](const SumRequest& r, const std::stop_token&) {
                SumOfReadings sum = good.sum(r, {0, 15});
                sum.values[4].pop_back();
                return sum;
              }),
              HasSubstr("holds 20 numbers for piece 4"));
}

TEST(SumOfReadings, RequestsThatDoNotFitTheReadingsAreRefused) {
  TwoInstruments two;
  PieceSummer summer(two.problem);
  const SumRequest good = request_of(two.problem, SumKind::normal);
  EXPECT_NO_THROW(summer.sum(good, {0, 1}));
  EXPECT_THROW(summer.sum(good, {0, 16}), SumError);
  EXPECT_THROW(summer.sum(good, {3, 2}), SumError);
  const std::vector<std::pair<std::string, std::function<void(SumRequest&)>>> changes = {
      {"16 pieces there, 15 here", [](SumRequest& request) { request.pieces = 16; }},
      {"sets of readings: 1 there, 2 here", [](SumRequest& request) { request.point.setups.pop_back(); }},
      {"sets of readings: 1 there, 2 here", [](SumRequest& request) { request.setups.pop_back(); }},
      {"parameters of the errors: 1 there, 3 here", [](SumRequest& request) { request.reference.machine = {1}; }},
      {"unknowns of the set-up of function: 4 there, 5 here",
       [](SumRequest& request) { request.point.setups[1].pop_back(); }},
      {"an unknown of function is not here", [](SumRequest& request) { request.setups[1].unknowns = {5}; }},
      {"readings of function: 1499 there, 1500 here", [](SumRequest& request) { request.setups[0].use.pop_back(); }},
      {"a parameter of the errors is not here", [](SumRequest& request) { request.machine_parameters = {3}; }},
      {"a pose variance without its point",
       [](SumRequest& request) {
         request.setups[0].weighed = true;
         request.setups[0].weights.variance.pose = 0.1;
       }},
      {"sums over poses without variances", [](SumRequest& request) { request.kind = SumKind::poses; }},
      {"entries of the covariance: 0 there, 64 here", [](SumRequest& request) {
         request.kind = SumKind::poses;
         for (SetupSelection& setup : request.setups) setup.weighed = true;
       }}};
  for (const auto& [message, change] : changes) {
    SumRequest request = good;
    change(request);
    std::string found;
    try {
      summer.sum(request, {0, 1});
    } catch (const SumError& error) {
      found = error.what();
    }
    EXPECT_THAT(found, HasSubstr(message));
  }
}

TEST(SumOfReadings, DamagedBytesAreRefused) {
  TwoInstruments two;
  PieceSummer summer(two.problem);
  const SumRequest request = request_of(two.problem, SumKind::gradient);
  const Bytes sum = to_bytes(summer.sum(request, {0, 4})), asked = to_bytes(request);
  const auto refused = [](const Bytes& bytes, bool is_sum) {
    try {
      if (is_sum)
        sum_from_bytes(bytes);
      else
        request_from_bytes(bytes);
    } catch (const SumError&) {
      return true;
    }
    return false;
  };
  for (const bool is_sum : {true, false}) {
    const Bytes& good = is_sum ? sum : asked;
    EXPECT_FALSE(refused(good, is_sum));
    EXPECT_TRUE(refused(good, !is_sum));
    for (std::size_t k = 0; k < good.size(); ++k) {
      Bytes bad = good;
      bad[k] ^= std::byte{0x10};
      EXPECT_TRUE(refused(bad, is_sum)) << k;
    }
    for (std::size_t length = 0; length < good.size(); length += 5)
      EXPECT_TRUE(refused(Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(length)), is_sum)) << length;
    Bytes longer = good;
    longer.resize(good.size() + 8);
    EXPECT_TRUE(refused(longer, is_sum));
  }
}

TEST(SumOfReadings, TellsOfEveryPieceAndStopsBetweenThem) {
  TwoInstruments two;
  PieceSummer summer(two.problem);
  const SumRequest request = request_of(two.problem, SumKind::normal);
  for (const int threads : {1, 3}) {
    std::vector<std::size_t> told;
    summer.sum(request, {2, 9}, {.threads = threads, .progress = [&](std::size_t done, std::size_t total) {
                                   EXPECT_EQ(total, 7U);
                                   told.push_back(done);
                                 }});
    EXPECT_EQ(told, (std::vector<std::size_t>{1, 2, 3, 4, 5, 6, 7}));
  }
  std::stop_source source;
  std::size_t last = 0;
  const SumOptions stopping{.threads = 1, .stop = source.get_token(), .progress = [&](std::size_t done, std::size_t) {
                              last = done;
                              if (done == 3) source.request_stop();
                            }};
  EXPECT_THROW(summer.sum(request, {0, 15}, stopping), Stopped);
  EXPECT_EQ(last, 3U);
}

}  // namespace
}  // namespace abbe
