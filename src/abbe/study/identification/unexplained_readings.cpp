#include "abbe/study/identification/unexplained_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "abbe/identify/identify.h"
#include "abbe/study/identification/axis_mistakes.h"
#include "abbe/study/identification/place_parts.h"

namespace abbe {
namespace {

constexpr std::size_t kMostTried = 300;     // that every mistake is tried on
constexpr std::size_t kMostInOrder = 2000;  // by which a place is judged
constexpr double kExplainedShare = 0.8;
constexpr double kMendedShare = 0.9;
constexpr std::size_t kMostMistakes = 100;
constexpr double kAsGood = 3;  // causes up to this factor above the best cannot be told from it

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
  const std::vector<double> distances = lengths_by_reading(*observations);
  double squares = 0;
  std::size_t count = 0;
  for (std::size_t k = 0; k < readings.count(); ++k) {
    const double distance = distances[k];
    if (!(distance >= 0 && distance <= kExplainedExtent * fit.extent_mm)) continue;
    result.explained[k] = 1;
    squares += distance * distance;
    ++count;
  }
  if (count == 0) return result;
  result.share = static_cast<double>(count) / static_cast<double>(readings.count());
  result.rms_mm = std::sqrt(squares / static_cast<double>(count));
  return result;
}

/// The most readings one after the other that are not explained.
std::size_t longest_misfit(const PlaceFit& fit) {
  std::size_t longest = 0, run = 0;
  for (const std::uint8_t explained : fit.explained) {
    run = explained != 0 ? 0 : run + 1;
    longest = std::max(longest, run);
  }
  return longest;
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

  /// Without causes.
  UnexplainedReadings as_read() const {
    return {.place = present_.place,
            .readings = present_.readings.size(),
            .share = as_read_.share,
            .rms_mm = as_read_.rms_mm,
            .causes = {},
            .set_up_is_open = present_.rough};
  }

  UnexplainedReadings search() const {
    UnexplainedReadings result = as_read();
    std::vector<Explanation> found;
    const bool explained = as_read_.explains(kExplainedShare);
    // A move is one cause, and so comes before combinations of mistakes.
    if (!explained) found = mistakes(1, 1);
    if (found.empty()) {
      if (std::optional<Explanation> moved = interruptions()) found.push_back(*std::move(moved));
    }
    if (!explained && found.empty()) found = mistakes(2, kMostMistakes);
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
  std::vector<Explanation> mistakes(std::size_t fewest, std::size_t largest) const {
    const std::vector<std::size_t> chosen = evenly_chosen(present_.readings, kMostTried);
    const std::vector<ReadingMistake> measured = instrument_.usual_mistakes();
    const std::vector<AxisMistake> axes = axis_mistakes(machine_);
    const std::size_t most =
        std::min(largest, std::max<std::size_t>(2, measured.empty() ? 0 : measured.back().words.size()));
    std::vector<Explanation> found;
    const auto attempt = [&](const ReadingMistake* mistake, const AxisMistake* axis) {
      const PlaceFit fit = fit_without(chosen, mistake, axis);
      if (!fit.explains(kMendedShare)) return;
      std::vector<std::string> words;
      if (mistake != nullptr) words = mistake->words;
      if (axis != nullptr) words.push_back(axis->words);
      found.push_back({fmt::format("{}", fmt::join(words, ", and ")), fit.rms_mm});
    };
    for (std::size_t count = fewest; count <= most && found.empty(); ++count) {
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

  /// That the place moved, where each part of the readings fits by itself.
  std::optional<Explanation> interruptions() const {
    const std::optional<PlaceParts> parts = parts_of_place(machine_, instrument_, readings_, present_);
    if (!parts) return std::nullopt;
    std::vector<std::string> after;
    for (std::size_t p = 1; p < parts->begins.size(); ++p) {
      const std::size_t last = present_.readings[parts->begins[p] - 1];
      const std::vector<std::string>& names = readings_.point_name;
      after.push_back("after reading " + (names.empty() || names[last].empty()
                                              ? std::to_string(last)
                                              : fmt::format("{} ({})", last, names[last])));
    }
    return Explanation{
        fmt::format("{} {} {}", present_.place, instrument_.interruption_words(), fmt::join(after, " and ")),
        parts->rms_mm};
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
  if (readings < kFewestOfPlace) return text + "; they are too few to try the usual mistakes";
  if (causes.empty()) {
    text += "; none of the usual mistakes would explain that";
    return set_up_is_open ? text + ", but a number of the set-up may be far from where the study begins" : text;
  }
  text += fmt::format("; they fit to {:.3g} mm if ", mended_rms_mm);
  if (causes.size() == 1) return text + causes.front();
  return text + fmt::format("one of these holds: {}", fmt::join(causes, "; "));
}

JudgedReadings judge_readings(const Machine& machine, const Instrument& instrument, const InstrumentReadings& readings,
                              const StartedInstrument& started) {
  JudgedReadings result;
  for (const StartFit& fit : started.fits) {
    const bool few = fit.readings.size() < kFewestOfPlace;
    // Some place explains any few readings; where none does, they contradict the machine.
    if (!fit.determined || (few && fit.found)) continue;
    ++result.places;
    const PlaceFit as_read =
        place_fit(machine, started, fit, readings.subset(evenly_chosen(fit.readings, kMostInOrder)));
    const bool explained = as_read.explains(kExplainedShare);
    if (explained && longest_misfit(as_read) < kFewestOfPlace) continue;
    const MistakeSearch search(machine, instrument, readings, fit, as_read);
    UnexplainedReadings place = few ? search.as_read() : search.search();
    // Readings that do not fit but lie scattered are outliers.
    if (explained && place.causes.empty()) continue;
    result.unexplained.push_back(std::move(place));
  }
  return result;
}

}  // namespace abbe
