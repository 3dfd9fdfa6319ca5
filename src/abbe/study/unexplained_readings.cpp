#include "abbe/study/unexplained_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "abbe/study/axis_mistakes.h"

namespace abbe {
namespace {

constexpr std::size_t kFewestOfPlace = 6;
constexpr std::size_t kMostTried = 300;     // that every mistake is tried on
constexpr std::size_t kMostInOrder = 2000;  // in which the end of a part is looked for
constexpr double kExplainedShare = 0.8, kExplainedExtent = 0.03;
constexpr double kMendedShare = 0.9;
constexpr double kAsGood = 3;  // causes up to this factor above the best cannot be told from it
constexpr std::size_t kMostParts = 8;

std::vector<std::size_t> evenly_chosen(const std::vector<std::size_t>& readings, std::size_t most) {
  const std::size_t count = std::min(readings.size(), most);
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(readings[i * readings.size() / count]);
  return chosen;
}

/// How well the place that was found explains readings.
struct PlaceFit {
  bool determined = false;
  double share = 0;                       ///< within kExplainedExtent of the extent
  double rms_mm = 0;                      ///< of these
  std::vector<std::uint8_t> explained{};  ///< [readings]

  bool explains(double least) const { return determined && share >= least; }
};

PlaceFit place_fit(const Machine& machine, const StartedInstrument& started, const StartFit& fit,
                   const InstrumentReadings& readings) {
  PlaceFit result{.determined = fit.determined};
  result.explained.assign(readings.count(), 0);
  if (!fit.found || readings.count() == 0) return result;
  const std::unique_ptr<Observations> observations = started.instrument->observations(machine, ErrorSet{}, readings);
  double squares = 0;
  std::size_t count = 0;
  for (std::size_t k = 0; k < readings.count(); ++k) {
    const std::optional<double> distance = observations->length_of_deviation(k);
    if (!distance || !(*distance <= kExplainedExtent * fit.extent_mm)) continue;
    result.explained[k] = 1;
    squares += *distance * *distance;
    ++count;
  }
  if (count == 0) return result;
  result.share = static_cast<double>(count) / static_cast<double>(readings.count());
  result.rms_mm = std::sqrt(squares / static_cast<double>(count));
  return result;
}

/// What would explain the readings, and how well.
struct Explanation {
  std::string words;
  double rms_mm = 0;
};

class MistakeSearch {
 public:
  MistakeSearch(const Machine& machine, const Instrument& instrument, const InstrumentReadings& readings,
                const StartFit& present, const PlaceFit& as_read)
      : machine_(machine), instrument_(instrument), readings_(readings), present_(present), as_read_(as_read) {}

  UnexplainedReadings search() const {
    UnexplainedReadings result{.place = present_.place,
                               .readings = present_.readings.size(),
                               .share = as_read_.share,
                               .rms_mm = as_read_.rms_mm,
                               .causes = {}};
    std::vector<Explanation> found = mistakes();
    if (found.empty()) {
      if (std::optional<Explanation> moved = interruptions()) found.push_back(*std::move(moved));
    }
    if (found.empty()) return result;
    result.mended_rms_mm = found.front().rms_mm;
    for (const Explanation& one : found) result.mended_rms_mm = std::min(result.mended_rms_mm, one.rms_mm);
    const double as_good = kAsGood * result.mended_rms_mm + 1e-9 * present_.extent_mm;
    for (Explanation& one : found) {
      if (one.rms_mm <= as_good) result.causes.push_back(std::move(one.words));
    }
    return result;
  }

 private:
  /// The fit of chosen readings without these mistakes; null: none.
  PlaceFit fit_without(const std::vector<std::size_t>& chosen, const ReadingMistake* mistake,
                       const AxisMistake* axes) const {
    const auto shift = static_cast<std::ptrdiff_t>(axes == nullptr ? 0 : axes->shift);
    std::vector<std::size_t> kept;
    for (const std::size_t k : chosen) {
      const std::ptrdiff_t from = static_cast<std::ptrdiff_t>(k) + shift;
      if (from >= 0 && from < static_cast<std::ptrdiff_t>(readings_.count())) kept.push_back(k);
    }
    InstrumentReadings changed = readings_.subset(kept);
    std::vector<double> one(changed.measured.size());
    for (std::size_t i = 0; i < kept.size(); ++i) {
      if (axes != nullptr) {
        std::vector<double> pose = readings_.poses.pose(kept[i] + static_cast<std::size_t>(shift));
        if (axes->undo) axes->undo(pose.data());
        for (std::size_t a = 0; a < pose.size(); ++a) changed.poses.axis[a][i] = pose[a];
      }
      if (mistake == nullptr) continue;
      for (std::size_t c = 0; c < one.size(); ++c) one[c] = changed.measured[c][i];
      mistake->undo(one.data());
      for (std::size_t c = 0; c < one.size(); ++c) changed.measured[c][i] = one[c];
    }
    const StartedInstrument started = instrument_.started(machine_, changed);
    for (const StartFit& fit : started.fits) {
      if (fit.place == present_.place) return place_fit(machine_, started, fit, changed);
    }
    return {};
  }

  /// The fewest mistakes that explain the readings, all that do.
  std::vector<Explanation> mistakes() const {
    const std::vector<std::size_t> chosen = evenly_chosen(present_.readings, kMostTried);
    const std::vector<ReadingMistake> measured = instrument_.usual_mistakes();
    const std::vector<AxisMistake> axes = axis_mistakes(machine_);
    const std::size_t most = std::max<std::size_t>(2, measured.empty() ? 0 : measured.back().words.size());
    std::vector<Explanation> found;
    const auto attempt = [&](const ReadingMistake* mistake, const AxisMistake* axis) {
      const PlaceFit fit = fit_without(chosen, mistake, axis);
      if (!fit.explains(kMendedShare)) return;
      std::vector<std::string> words;
      if (mistake != nullptr) words = mistake->words;
      if (axis != nullptr) words.push_back(axis->words);
      found.push_back({fmt::format("{}", fmt::join(words, ", and ")), fit.rms_mm});
    };
    for (std::size_t count = 1; count <= most && found.empty(); ++count) {
      for (const ReadingMistake& mistake : measured) {
        if (mistake.words.size() == count) attempt(&mistake, nullptr);
        if (mistake.words.size() != 1 || count != 2) continue;
        for (const AxisMistake& axis : axes) attempt(&mistake, &axis);
      }
      if (count > 1) continue;
      for (const AxisMistake& axis : axes) attempt(nullptr, &axis);
    }
    return found;
  }

  /// Parts of the readings, in their order, that fit by themselves.
  std::optional<Explanation> interruptions() const {
    const std::vector<std::size_t> all = evenly_chosen(present_.readings, kMostInOrder);
    double worst = 0;
    std::vector<std::string> after;
    for (std::size_t begin = 0; begin < all.size();) {
      if (begin + kFewestOfPlace > all.size()) return std::nullopt;
      const PartFit part = longest_part(all, begin);
      if (part.end == begin) return std::nullopt;
      worst = std::max(worst, part.rms_mm);
      if (part.end == all.size()) break;
      after.push_back(place_in_order(all[part.end - 1], all[part.end]));
      if (after.size() == kMostParts) return std::nullopt;
      begin = part.end;
    }
    if (after.empty()) return std::nullopt;
    return Explanation{
        fmt::format("{} {} {}", present_.place, instrument_.interruption_words(), fmt::join(after, " and ")), worst};
  }

  struct PartFit {
    std::size_t end = 0;
    double rms_mm = 0;
  };

  /// The longest part from `begin` on that fits but for a few outliers: a longer one has readings from elsewhere.
  /// @returns end = begin: none fits
  PartFit longest_part(const std::vector<std::size_t>& all, std::size_t begin) const {
    PartFit part{begin, 0};
    const auto fits = [&](std::size_t end) {
      const std::vector<std::size_t> chosen(all.begin() + static_cast<std::ptrdiff_t>(begin),
                                            all.begin() + static_cast<std::ptrdiff_t>(end));
      const PlaceFit fit = fit_without(chosen, nullptr, nullptr);
      const auto bad = static_cast<std::size_t>(std::count(fit.explained.begin(), fit.explained.end(), 0));
      const std::size_t most_bad = std::max<std::size_t>(1, chosen.size() * 3 / 100);
      // Readings on a line determine no place, and contradict none.
      if (fit.determined && bad > most_bad) return false;
      // The part ends with the last reading that fits.
      std::size_t last = chosen.size();
      while (fit.determined && last > 0 && end < all.size() && fit.explained[last - 1] == 0) --last;
      part = {begin + last, fit.rms_mm};
      return true;
    };
    if (fits(all.size())) return part;
    std::size_t good = begin + kFewestOfPlace, bad = all.size();
    if (!fits(good)) return {begin, 0};
    while (good + 1 < bad) {
      const std::size_t middle = good + (bad - good) / 2;
      (fits(middle) ? good : bad) = middle;
    }
    return part;
  }

  std::string place_in_order(std::size_t last, std::size_t next) const {
    const auto named = [&](std::size_t k) {
      const std::vector<std::string>& names = readings_.point_name;
      return names.empty() || names[k].empty() ? fmt::format("{}", k) : fmt::format("{} ({})", k, names[k]);
    };
    const auto at = std::find(present_.readings.begin(), present_.readings.end(), last);
    if (at + 1 != present_.readings.end() && *(at + 1) == next) return "after reading " + named(last);
    return fmt::format("between readings {} and {}", named(last), named(next));
  }

  const Machine& machine_;
  const Instrument& instrument_;
  const InstrumentReadings& readings_;
  const StartFit& present_;
  const PlaceFit& as_read_;
};

}  // namespace

std::string UnexplainedReadings::words() const {
  std::string text = share == 0 ? fmt::format("{}: none of its {} readings fits the nominal machine", place, readings)
                                : fmt::format("{}: only {:.0f} % of its {} readings fit the nominal machine", place,
                                              100 * share, readings);
  if (causes.empty()) return text + "; none of the usual mistakes would explain that";
  text += fmt::format("; they fit to {:.3g} mm if ", mended_rms_mm);
  if (causes.size() == 1) return text + causes.front();
  return text + fmt::format("one of these holds: {}", fmt::join(causes, "; "));
}

std::vector<UnexplainedReadings> unexplained_readings(const Machine& machine, const Instrument& instrument,
                                                      const InstrumentReadings& readings,
                                                      const StartedInstrument& started) {
  std::vector<UnexplainedReadings> result;
  for (const StartFit& fit : started.fits) {
    if (!fit.determined || fit.readings.size() < kFewestOfPlace) continue;
    const PlaceFit as_read =
        place_fit(machine, started, fit, readings.subset(evenly_chosen(fit.readings, kMostInOrder)));
    if (as_read.explains(kExplainedShare)) continue;
    UnexplainedReadings place = MistakeSearch(machine, instrument, readings, fit, as_read).search();
    if (!place.causes.empty() || !fit.rough) result.push_back(std::move(place));
  }
  return result;
}

}  // namespace abbe
