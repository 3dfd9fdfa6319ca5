#include "machine_peak.h"

#include <algorithm>
#include <chrono>
#include <vector>

#include "abbe/geometry/parallel_blocks.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "machine_peak.cpp"
#include <hwy/foreach_target.h>
// After it.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace abbe::benchmarks::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Twelve sums that do not wait for each other: two units with a latency of up to six cycles.
/// @returns operations  @param sum  becomes a number that depends on all of them
double fused_sums(std::size_t rounds, double* sum) {
  const hn::ScalableTag<double> d;
  const auto factor = hn::Set(d, 0.9999), term = hn::Set(d, 1e-4);
  auto a = hn::Set(d, 1), b = a, c = a, e = a, f = a, g = a, h = a, i = a, j = a, k = a, l = a, m = a;
  for (std::size_t round = 0; round < rounds; ++round) {
    a = hn::MulAdd(a, factor, term), b = hn::MulAdd(b, factor, term), c = hn::MulAdd(c, factor, term);
    e = hn::MulAdd(e, factor, term), f = hn::MulAdd(f, factor, term), g = hn::MulAdd(g, factor, term);
    h = hn::MulAdd(h, factor, term), i = hn::MulAdd(i, factor, term), j = hn::MulAdd(j, factor, term);
    k = hn::MulAdd(k, factor, term), l = hn::MulAdd(l, factor, term), m = hn::MulAdd(m, factor, term);
  }
  a = hn::Add(hn::Add(hn::Add(a, b), hn::Add(c, e)), hn::Add(hn::Add(f, g), hn::Add(h, i)));
  a = hn::Add(a, hn::Add(hn::Add(j, k), hn::Add(l, m)));
  *sum = hn::GetLane(hn::SumOfLanes(d, a));
  return 24.0 * static_cast<double>(hn::Lanes(d) * rounds);
}

void scaled_sum(const double* b, const double* c, std::size_t count, double* a) {
  const hn::ScalableTag<double> d;
  const auto scale = hn::Set(d, 3.0);
  for (std::size_t k = 0; k < count; k += hn::Lanes(d)) {
    hn::StoreU(hn::MulAdd(scale, hn::LoadU(d, c + k), hn::LoadU(d, b + k)), d, a + k);
  }
}

void fill(double value, std::size_t count, double* a) {
  const hn::ScalableTag<double> d;
  for (std::size_t k = 0; k < count; k += hn::Lanes(d)) hn::StoreU(hn::Set(d, value), d, a + k);
}

}  // namespace abbe::benchmarks::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe::benchmarks {
HWY_EXPORT(fused_sums);
HWY_EXPORT(scaled_sum);
HWY_EXPORT(fill);

namespace {

constexpr int kRepetitions = 9;
constexpr std::size_t kArray = std::size_t{1} << 24;  // doubles

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

volatile double kept = 0;

}  // namespace

double peak_operations(int threads) {
  double best = 0;
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    std::vector<double> operations(static_cast<std::size_t>(threads)), sums(operations.size());
    const double start = now();
    for_each_block(operations.size(), threads, [&](std::size_t thread) {
      operations[thread] = HWY_DYNAMIC_DISPATCH(fused_sums)(4'000'000, &sums[thread]);
    });
    const double time = now() - start;
    double all = 0;
    for (const double of_thread : operations) all += of_thread;
    kept = sums.front();
    best = std::max(best, all / time);
  }
  return best;
}

double memory_bandwidth(int threads) {
  constexpr std::size_t kBlocks = 64, kBlock = kArray / kBlocks;
  std::vector<double> a(kArray, 0), b(kArray, 1), c(kArray, 2);
  double best = 0;
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    const double start = now();
    for_each_block(kBlocks, threads, [&](std::size_t block) {
      const std::size_t at = block * kBlock;
      HWY_DYNAMIC_DISPATCH(scaled_sum)(b.data() + at, c.data() + at, kBlock, a.data() + at);
    });
    best = std::max(best, 24.0 * static_cast<double>(kArray) / (now() - start));
    kept = a[kArray / 2];
  }
  return best;
}

double store_bandwidth(std::size_t bytes) {
  const std::size_t count = bytes / sizeof(double) / 64 * 64, rounds = std::max<std::size_t>(1, (64u << 20) / bytes);
  std::vector<double> a(count, 0);
  double best = 0;
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    const double start = now();
    for (std::size_t round = 0; round < rounds; ++round) {
      HWY_DYNAMIC_DISPATCH(fill)(static_cast<double>(round), count, a.data());
      kept = a[count / 2];
    }
    best = std::max(best, static_cast<double>(rounds * count * sizeof(double)) / (now() - start));
  }
  return best;
}

}  // namespace abbe::benchmarks
#endif
