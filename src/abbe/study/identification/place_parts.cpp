#include "abbe/study/identification/place_parts.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace abbe {
namespace {

constexpr std::size_t kMostSearched = 300;  // readings
constexpr std::size_t kFewForSmallWindows = 100;
constexpr double kChange = 5;  // price of a change: a part has to explain more readings than that
constexpr int kRounds = 4;     // of fits and assignments
constexpr std::size_t kMostParts = 8;
constexpr double kPartShare = 0.8;   // of the readings of a part that it has to explain
constexpr double kWholeShare = 0.9;  // of all
constexpr double kFarDeviation = 1e30;

/// Readings begin..end - 1 of those that are searched, which one fit is to explain.
struct Part {
  std::size_t begin = 0, end = 0;
  std::size_t fit = 0;
};

std::vector<std::size_t> numbers_below(std::size_t count) {
  std::vector<std::size_t> numbers(count);
  for (std::size_t i = 0; i < count; ++i) numbers[i] = i;
  return numbers;
}

std::vector<std::size_t> readings_at(const StartFit& place, const std::vector<std::size_t>& order) {
  std::vector<std::size_t> readings;
  for (const std::size_t i : order) readings.push_back(place.readings[i]);
  return readings;
}

class PartSearch {
 public:
  PartSearch(const Machine& machine, const Instrument& instrument, const InstrumentReadings& readings,
             const StartFit& place)
      : machine_(machine),
        instrument_(instrument),
        readings_(readings),
        place_(place),
        order_(evenly_chosen(numbers_below(place.readings.size()), kMostSearched)),
        searched_(readings.subset(readings_at(place, order_))),
        tolerance_(kExplainedExtent * place.extent_mm) {}

  std::optional<PlaceParts> search() {
    if (order_.size() < 2 * kFewestOfPlace || !(tolerance_ > 0)) return std::nullopt;
    add_windows();
    std::vector<Part> parts = assigned();
    for (int round = 0; round < kRounds; ++round) {
      if (parts.size() < 2 || parts.size() > 2 * kMostParts) return std::nullopt;
      for (const Part& part : parts) add_fit(part.begin, part.end);
      std::vector<Part> next = assigned();
      const bool same = std::equal(next.begin(), next.end(), parts.begin(), parts.end(),
                                   [](const Part& a, const Part& b) { return a.begin == b.begin; });
      parts = std::move(next);
      if (same) break;
    }
    merge(parts);
    if (parts.size() < 2 || parts.size() > kMostParts || !are_sound(parts)) return std::nullopt;
    return placed(parts);
  }

 private:
  /// A fit of some readings, as all readings of the search see it.
  struct Fit {
    std::shared_ptr<const Instrument> instrument;
    std::vector<double> cost;  ///< [searched readings] 0 to 1
  };

  double cost_of(const std::optional<double>& deviation) const {
    const double relative = deviation.value_or(kFarDeviation) / tolerance_;
    return relative < 1 ? relative * relative : 1;  // 1 for what is not a number
  }

  std::vector<double> costs(const Instrument& instrument, const InstrumentReadings& readings) const {
    const std::unique_ptr<Observations> observations = instrument.observations(machine_, ErrorSet{}, readings);
    std::vector<double> result;
    for (std::size_t k = 0; k < readings.count(); ++k) result.push_back(cost_of(observations->length_of_deviation(k)));
    return result;
  }

  Fit fit_of(std::size_t begin, std::size_t end) const {
    std::vector<std::size_t> chosen;
    for (std::size_t i = begin; i < end; ++i) chosen.push_back(i);
    Fit fit{instrument_.started(machine_, searched_.subset(chosen)).instrument, {}};
    fit.cost = costs(*fit.instrument, searched_);
    return fit;
  }
  void add_fit(std::size_t begin, std::size_t end) { fits_.push_back(fit_of(begin, end)); }

  void add_windows() {
    const std::size_t n = order_.size();
    const bool few = n <= kFewForSmallWindows;
    for (std::size_t size = few ? kFewestOfPlace : 10; size < n; size = size * 8 / 5) {
      const std::size_t step = std::max<std::size_t>(2, size / 3);
      for (std::size_t begin = 0; begin + size < n; begin += step) add_fit(begin, begin + size);
      add_fit(n - size, n);
    }
    add_fit(0, n);
  }

  /// The cheapest assignment of readings to fits, changes of the fit included.
  std::vector<Part> assigned() const {
    const std::size_t n = order_.size(), count = fits_.size();
    std::vector<double> total(count);
    std::vector<std::size_t> from(n * count);
    std::vector<std::size_t> best_before(n, 0);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t best = static_cast<std::size_t>(std::min_element(total.begin(), total.end()) - total.begin());
      const double changed = i == 0 ? 0 : total[best] + kChange;
      for (std::size_t f = 0; f < count; ++f) {
        const bool stays = i == 0 || total[f] <= changed;
        from[i * count + f] = stays ? f : best;
        total[f] = (stays ? total[f] : changed) + fits_[f].cost[i];
      }
    }
    std::size_t fit = static_cast<std::size_t>(std::min_element(total.begin(), total.end()) - total.begin());
    std::vector<Part> parts = {{n, n, fit}};
    for (std::size_t i = n; i-- > 0;) {
      parts.back().begin = i;
      const std::size_t before = from[i * count + fit];
      if (i > 0 && before != fit) parts.push_back({i, i, before});
      fit = before;
    }
    std::reverse(parts.begin(), parts.end());
    return parts;
  }

  std::size_t explained(const Fit& fit, std::size_t begin, std::size_t end) const {
    std::size_t count = 0;
    for (std::size_t i = begin; i < end; ++i) count += fit.cost[i] < 1 ? 1 : 0;
    return count;
  }

  /// Neighbours that one fit explains as well: a beam that went on with another run, a window that fitted badly.
  void merge(std::vector<Part>& parts) {
    for (std::size_t i = 0; i + 1 < parts.size();) {
      const std::size_t begin = parts[i].begin, middle = parts[i].end, end = parts[i + 1].end;
      Fit both = fit_of(begin, end);
      const std::size_t apart =
          explained(fits_[parts[i].fit], begin, middle) + explained(fits_[parts[i + 1].fit], middle, end);
      const std::size_t lost = apart - std::min(apart, explained(both, begin, end));
      if (static_cast<double>(lost) >= kChange) {
        ++i;
        continue;
      }
      fits_.push_back(std::move(both));
      parts[i] = {begin, end, fits_.size() - 1};
      parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(i) + 1);
      i = i == 0 ? 0 : i - 1;
    }
  }

  /// Each part alone, fitted to nothing else, explains its readings.
  bool are_sound(std::vector<Part>& parts) {
    std::size_t all = 0;
    for (Part& part : parts) {
      const std::size_t count = part.end - part.begin;
      if (count < kFewestOfPlace) return false;
      add_fit(part.begin, part.end);
      part.fit = fits_.size() - 1;
      const std::size_t good = explained(fits_[part.fit], part.begin, part.end);
      if (static_cast<double>(good) < kPartShare * static_cast<double>(count)) return false;
      all += good;
    }
    return static_cast<double>(all) >= kWholeShare * static_cast<double>(order_.size());
  }

  /// The parts among all readings.
  PlaceParts placed(const std::vector<Part>& parts) const {
    PlaceParts result{{0}, 0};
    for (std::size_t p = 0; p + 1 < parts.size(); ++p) {
      // Between the neighbours of the first and the last reading that was searched on either side.
      const std::size_t from = order_[parts[p].end - 1] + 1, to = order_[parts[p + 1].begin];
      std::vector<std::size_t> between(place_.readings.begin() + static_cast<std::ptrdiff_t>(from),
                                       place_.readings.begin() + static_cast<std::ptrdiff_t>(to));
      std::size_t begin = from;
      if (!between.empty()) {
        const InstrumentReadings open = readings_.subset(between);
        const std::vector<double> before = costs(*fits_[parts[p].fit].instrument, open);
        const std::vector<double> after = costs(*fits_[parts[p + 1].fit].instrument, open);
        double gain = 0, most = 0;  // of the first j readings to the part before
        for (std::size_t j = 0; j < between.size(); ++j) {
          gain += after[j] - before[j];
          if (gain <= most) continue;
          most = gain;
          begin = from + j + 1;
        }
      }
      result.begins.push_back(begin);
    }
    double squares = 0;
    std::size_t count = 0;
    for (const Part& part : parts) {
      for (std::size_t i = part.begin; i < part.end; ++i) {
        const double cost = fits_[part.fit].cost[i];
        if (!(cost < 1)) continue;
        squares += cost;
        ++count;
      }
    }
    result.rms_mm = count > 0 ? tolerance_ * std::sqrt(squares / static_cast<double>(count)) : 0;
    return result;
  }

  const Machine& machine_;
  const Instrument& instrument_;
  const InstrumentReadings& readings_;
  const StartFit& place_;
  std::vector<std::size_t> order_;  ///< [searched readings] index into place_.readings
  InstrumentReadings searched_;
  double tolerance_;
  std::vector<Fit> fits_;
};

}  // namespace

std::vector<std::size_t> evenly_chosen(const std::vector<std::size_t>& readings, std::size_t most) {
  const std::size_t count = std::min(readings.size(), most);
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t begin = i * readings.size() / count, next = (i + 1) * readings.size() / count;
    // The golden ratio keeps step with no plan: every third reading could be always the same reflector.
    const double turns = static_cast<double>(i) * 0.6180339887498949;
    const double share = turns - std::floor(turns);
    chosen.push_back(readings[begin + static_cast<std::size_t>(share * static_cast<double>(next - begin))]);
  }
  return chosen;
}

std::optional<PlaceParts> parts_of_place(const Machine& machine, const Instrument& instrument,
                                         const InstrumentReadings& readings, const StartFit& place) {
  return PartSearch(machine, instrument, readings, place).search();
}

}  // namespace abbe
