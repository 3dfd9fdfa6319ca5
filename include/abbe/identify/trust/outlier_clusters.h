#pragma once

#include <string>
#include <vector>

#include "abbe/identify/identify.h"
#include "abbe/identify/trust/reading_facts.h"

namespace abbe {

/// A part of the readings with more outliers than chance puts there.
struct OutlierCluster {
  std::string where;         ///< "B from -90 to -51 deg", "reflector R2", "set-up bar, after 1200 s"
  std::size_t readings = 0;  ///< used readings in it
  std::size_t outliers = 0;  ///< of these
  std::size_t readings_elsewhere = 0, outliers_elsewhere = 0;
  double log_probability = 0;  ///< natural logarithm of probability()

  /// Of so many or more by chance, times the number of parts that were looked at; at most 1, and 0 below 1e-323.
  double probability() const;

  /// Half of a part that holds a twentieth of all readings or more: the result says nothing about it.
  bool is_region_left_out() const;
};

/// Looks where outliers stand: ranges of every axis, of time, stations, reflectors, balls and whole set-ups.
///
/// By chance, outliers would be a random draw of the readings: the number in a part is then hypergeometric. Readings
/// that follow each other at one pose count as one where ranges are looked at, because what happens at a pose happens
/// to all of them. Ranges are whole numbers of at most 24 classes with about as many poses each; with more than
/// 65,536 poses, the limits of the classes come from a sample of that size. Probabilities are multiplied by the number
/// of all parts looked at (Bonferroni); a cluster is what then stays below 1e-6. Of each axis, of time and of each kind
/// of label the most significant part is given.
/// @param facts  [problem.observations]
/// @returns by probability, smallest first
std::vector<OutlierCluster> outlier_clusters(const Problem& problem, const std::vector<Outlier>& outliers,
                                             const std::vector<ReadingFacts>& facts);

/// "107 of 110 readings with B from -90 to -51 deg are outliers, 3 of the 890 others".
std::string cluster_text(const OutlierCluster& cluster);

}  // namespace abbe
