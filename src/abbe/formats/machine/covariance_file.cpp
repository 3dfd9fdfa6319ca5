#include "abbe/formats/machine/covariance_file.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/list_text.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/geometry/decompositions.h"

namespace abbe {
namespace {

constexpr double kSymmetry = 1e-10;  // of correlations

int shift(bool is_angle) { return is_angle ? 6 : 3; }
const char* unit(bool is_angle) { return is_angle ? "urad" : "um"; }

/// Fields of the next line that counts, or none at the end.
std::vector<std::string> next_fields(std::string_view text, std::size_t& at, std::size_t& line,
                                     const std::string& file) {
  std::vector<std::string> fields;
  while (at < text.size()) {
    std::string_view rest = csv_next_line(text, at);
    ++line;
    if (csv_is_passed_over(rest)) continue;
    std::string unquoted;
    std::string_view field;
    for (bool more = true; more;) {
      if (!csv_take_field(rest, field, unquoted, more)) throw InputError({file, line, 0, ""}, "a quote is not closed");
      fields.emplace_back(field);
    }
    break;
  }
  return fields;
}

/// A combination of parameters with a variance below zero, beyond what rounding makes of one that is zero, would give
/// uncertainties that are too small or none. In correlations, because mm and rad differ by orders of magnitude.
bool is_semi_definite(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd scale =
      covariance.diagonal().unaryExpr([](double variance) { return variance > 0 ? 1 / std::sqrt(variance) : 0.0; });
  Eigen::MatrixXd correlation = scale.asDiagonal() * covariance * scale.asDiagonal();
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    if (!(covariance(i, i) > 0) && (covariance.row(i).array() != 0).any()) return false;
  }
  correlation.diagonal().array() += 5e-9 * static_cast<double>(covariance.rows());
  return Cholesky(correlation).info() == Eigen::Success;
}

/// Takes the mean of the two entries of a pair, which programs give with different last digits.
/// @param lines  [row] of the file
void make_symmetric(Eigen::MatrixXd& covariance, const std::vector<std::string>& names,
                    const std::vector<std::size_t>& lines, const std::string& file) {
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const double difference = std::abs(covariance(i, j) - covariance(j, i));
      if (!(difference <= kSymmetry * std::sqrt(covariance(i, i) * covariance(j, j)))) {
        throw InputError({file, lines[static_cast<std::size_t>(i)], 0, names[static_cast<std::size_t>(j)]},
                         "is not symmetric",
                         fmt::format("a covariance matrix, symmetric to {:g} in its correlations", kSymmetry));
      }
      covariance(i, j) = covariance(j, i) = (covariance(i, j) + covariance(j, i)) / 2;
    }
  }
}

}  // namespace

Eigen::MatrixXd parse_covariance(std::string_view text, const std::string& file, const Machine& machine,
                                 const ErrorSet& errors) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const std::vector<std::string> names = parameter_names(machine, errors);
  const std::vector<bool> angles = parameters_are_angles(machine, errors);
  const auto count = static_cast<Eigen::Index>(names.size());
  std::size_t at = 0, line = 0;

  std::vector<std::string> header = {"parameter", "unit"};
  header.insert(header.end(), names.begin(), names.end());
  const auto refuse_name = [&](const std::string& found, const std::string& expected) {
    throw InputError({file, line, 0, found}, "is not the parameter of the errors file at this place", expected);
  };
  const std::vector<std::string> first = next_fields(text, at, line, file);
  for (std::size_t i = 0; i < header.size() || i < first.size(); ++i) {
    const std::string found = i < first.size() ? first[i] : "the end of the header";
    const std::string expected = i < header.size() ? header[i] : "the end of the header";
    if (found != expected) refuse_name(found, expected);
  }

  Eigen::MatrixXd covariance(count, count);
  std::vector<std::size_t> lines;
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto row = static_cast<std::size_t>(i);
    const std::vector<std::string> fields = next_fields(text, at, line, file);
    if (fields.size() != header.size()) {
      throw InputError({file, line, 0, names[row]}, "the row has " + counted(fields.size(), "field", "fields"),
                       fmt::format("{} as in the header", header.size()));
    }
    if (fields[0] != names[row]) refuse_name(fields[0], names[row]);
    if (fields[1] != unit(angles[row])) {
      throw InputError({file, line, 0, names[row]}, fmt::format("unit '{}'", fields[1]), unit(angles[row]));
    }
    for (Eigen::Index j = 0; j < count; ++j) {
      const auto column = static_cast<std::size_t>(j);
      double value = 0;
      if (parse_number(fields[column + 2], -shift(angles[row]) - shift(angles[column]), value) != NumberProblem::none ||
          std::abs(value) > kLargestInput) {
        throw InputError({file, line, 0, names[column]}, fmt::format("'{}' is not a finite number", fields[column + 2]),
                         fmt::format("a covariance in {} {}", unit(angles[row]), unit(angles[column])));
      }
      covariance(i, j) = value;
      if (j == i && value < 0)
        throw InputError({file, line, 0, names[column]}, "the variance is negative", "a covariance matrix");
    }
    lines.push_back(line);
  }
  if (!next_fields(text, at, line, file).empty()) {
    throw InputError({file, line, 0, ""}, "more rows than parameters", fmt::format("{} rows", count));
  }
  make_symmetric(covariance, names, lines, file);
  if (!is_semi_definite(covariance)) {
    throw InputError({.file = file, .field = "covariance"}, "covariance is not positive semi-definite",
                     "a covariance matrix: no variance below zero in any direction");
  }
  return covariance;
}

std::string covariance_text(const Machine& machine, const ErrorsFile& contents) {
  const std::vector<std::string> names = parameter_names(machine, contents.errors);
  const std::vector<bool> angles = parameters_are_angles(machine, contents.errors);
  std::string text = "# Covariance of the parameters; an entry is in the product of the units of its row and column.\n";
  text += "parameter,unit";
  for (const std::string& name : names) text += "," + csv_field(name);
  text += '\n';
  for (std::size_t i = 0; i < names.size(); ++i) {
    text += csv_field(names[i]) + "," + unit(angles[i]);
    for (std::size_t j = 0; j < names.size(); ++j) {
      text += ',';
      text += shortest_text(contents.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)),
                            shift(angles[i]) + shift(angles[j]));
    }
    text += '\n';
  }
  return text;
}

}  // namespace abbe
