#include "abbe/identify/sums/carrier_groups.h"

#include <algorithm>
#include <iterator>
#include <map>

#include "abbe/geometry/cross_products.h"

namespace abbe {
namespace {

// Relative to a product of two columns in registers: rough estimates, between what processors with AVX2 and with
// AVX-512 take.
constexpr double kFold = 1.3;        // a product of two carriers
constexpr double kStore = 1;         // a result of it
constexpr double kMultiply = 1.5;    // a product of two basis functions
constexpr double kShortTile = 1.15;  // a product of sums over one number per reading
constexpr double kLongTile = 1.3;    // of whole columns, which no first-level cache holds together
constexpr double kWrite = 3;         // a number that the evaluation writes

std::size_t pairs(std::size_t n) { return n * (n + 1) / 2; }

double operations_of_pair(std::size_t w, std::size_t p, std::size_t rows) {
  return static_cast<double>(w) * (kFold * static_cast<double>(rows) + kStore) + kMultiply * static_cast<double>(p) +
         kShortTile * static_cast<double>(padded(w, kColumnMultiple) * padded(p, 2));
}

double operations_of_pair(const CarrierGroup& a, const CarrierGroup& b, std::size_t rows) {
  return operations_of_pair(a.carriers.size() * b.carriers.size(), a.bases.size() * b.bases.size(), rows);
}

double operations_within(const CarrierGroup& group, std::size_t rows) {
  return operations_of_pair(pairs(group.carriers.size()), pairs(group.bases.size()), rows);
}

std::vector<std::size_t> joined(const std::vector<std::size_t>& a, const std::vector<std::size_t>& b) {
  std::vector<std::size_t> all;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(all));
  return all;
}

/// Operations per reading that joining groups i and j saves; negative if it costs more.
double saving(const std::vector<CarrierGroup>& groups, std::size_t i, std::size_t j, const CarrierGroup& both,
              std::size_t rows) {
  double saved = operations_within(groups[i], rows) + operations_within(groups[j], rows) +
                 operations_of_pair(groups[i], groups[j], rows) - operations_within(both, rows);
  for (std::size_t k = 0; k < groups.size(); ++k) {
    if (k == i || k == j) continue;
    saved += operations_of_pair(groups[i], groups[k], rows) + operations_of_pair(groups[j], groups[k], rows) -
             operations_of_pair(both, groups[k], rows);
  }
  return saved;
}

}  // namespace

std::vector<CarrierGroup> carrier_groups(const FactoredColumns& form, std::size_t rows) {
  std::vector<std::vector<std::size_t>> bases_of(form.carriers() + 1);
  for (const FactoredColumns::Column& column : form.columns)
    bases_of[column.carrier].push_back(std::min(column.basis, form.bases()));
  bases_of.back().push_back(form.bases());
  std::map<std::vector<std::size_t>, std::size_t> group_of;
  std::vector<CarrierGroup> groups;
  for (std::size_t c = 0; c < bases_of.size(); ++c) {
    std::vector<std::size_t>& bases = bases_of[c];
    std::sort(bases.begin(), bases.end());
    bases.erase(std::unique(bases.begin(), bases.end()), bases.end());
    const auto [at, is_new] = group_of.try_emplace(bases, groups.size());
    if (is_new) groups.push_back({{}, bases});
    groups[at->second].carriers.push_back(c);
  }
  // Joined step by step: a group with more products than columns may still fill whole tiles better.
  while (true) {
    double best = 0;
    std::size_t first = 0, second = 0;
    CarrierGroup best_group;
    for (std::size_t i = 0; i < groups.size(); ++i) {
      for (std::size_t j = i + 1; j < groups.size(); ++j) {
        CarrierGroup both{joined(groups[i].carriers, groups[j].carriers), joined(groups[i].bases, groups[j].bases)};
        if (both.bases.size() == groups[i].bases.size() + groups[j].bases.size()) continue;
        const double saved = saving(groups, i, j, both, rows);
        if (saved <= best) continue;
        best = saved;
        first = i;
        second = j;
        best_group = std::move(both);
      }
    }
    if (best <= 0) return groups;
    groups[first] = std::move(best_group);
    groups.erase(groups.begin() + static_cast<std::ptrdiff_t>(second));
  }
}

double operations_of_groups(const FactoredColumns& form, const std::vector<CarrierGroup>& groups, std::size_t rows) {
  double sum = kWrite * static_cast<double>(rows * form.carriers() + form.bases());
  for (std::size_t i = 0; i < groups.size(); ++i) {
    sum += operations_within(groups[i], rows);
    for (std::size_t j = i + 1; j < groups.size(); ++j) sum += operations_of_pair(groups[i], groups[j], rows);
  }
  return sum;
}

double operations_of_columns(std::size_t columns, std::size_t rows) {
  // With the residuals as a last tile.
  const std::size_t tiles = padded(columns, kColumnMultiple) / kColumnMultiple + 1;
  const double products = static_cast<double>(kColumnMultiple * kColumnMultiple * pairs(tiles));
  return static_cast<double>(rows) * (kLongTile * products + kWrite * static_cast<double>(columns));
}

}  // namespace abbe
