#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/errors/error_states.h"
#include "abbe/errors/random_errors.h"
#include "abbe/formats/machine/state_option.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/machine/coupling.h"
#include "abbe/machine/machine_check.h"
#include "bindings/arrays.h"
#include "bindings/files.h"
#include "bindings/machine_errors.h"
#include "bindings/tables.h"

namespace abbe::python {
namespace {

constexpr double kMicro = 1e-6, kMicrometre = 1e-3;  // urad in rad, um in mm

[[noreturn]] void refuse(const char* field, const std::string& problem, const std::string& expected) {
  throw InputError({.field = field}, problem, expected);
}

/// The values of an argument in um or urad, whichever the component is in, inside units.
std::vector<double> values_in(bool rotation, const std::optional<std::vector<double>>& um,
                              const std::optional<std::vector<double>>& urad, const std::string& name,
                              const std::string& what) {
  const auto& wanted = rotation ? urad : um;
  const auto& other = rotation ? um : urad;
  const std::string unit = rotation ? "urad" : "um";
  if (!wanted || other) {
    refuse(name.c_str(),
           other ? "is a" + std::string(rotation ? "n angle" : " length") : "its " + what + " are missing",
           fmt::format("{}_{}", what, unit));
  }
  std::vector<double> values = *wanted;
  for (double& value : values) {
    if (!std::isfinite(value)) refuse(name.c_str(), fmt::format("has the {} {}", what, value), "finite numbers");
    value *= rotation ? kMicro : kMicrometre;
  }
  return values;
}

struct NamedError {
  std::size_t axis = 0;
  Component component = Component::X;
};

NamedError named(const Machine& machine, const std::string& name, bool location) {
  NamedError result;
  bool is_location = false;
  const char* expected = location ? "a location error of an axis of the machine, such as EC0Y"
                                  : "an error motion of an axis of the machine, such as EXX";
  if (!parse_error_name(machine, name, result.axis, result.component, is_location) || is_location != location) {
    refuse("name", fmt::format("'{}' is none of {}", name, machine.chain()), expected);
  }
  return result;
}

BasisKind basis_kind(const std::string& word) {
  for (const BasisKind kind : {BasisKind::monomial, BasisKind::legendre, BasisKind::chebyshev, BasisKind::fourier,
                               BasisKind::bspline, BasisKind::table_linear, BasisKind::table_monotone}) {
    if (word == basis_kind_name(kind)) return kind;
  }
  refuse("basis", fmt::format("'{}' is no basis", word),
         "monomial, legendre, chebyshev, fourier, bspline, table-linear or table-monotone");
}

/// Numbers of an argument that are positions of one axis: mm of a linear, degrees of a rotary one.
std::vector<double> positions_of(const Axis& axis, const std::optional<std::vector<double>>& mm,
                                 const std::optional<std::vector<double>>& deg, const char* base) {
  const bool rotary = axis.kind == AxisKind::rotary;
  if (rotary ? mm.has_value() : deg.has_value()) {
    refuse(fmt::format("{}_{}", base, rotary ? "mm" : "deg").c_str(),
           fmt::format("axis {} is {}", axis.name, rotary ? "rotary" : "linear"),
           fmt::format("{}_{}", base, rotary ? "deg" : "mm"));
  }
  std::vector<double> values = (rotary ? deg : mm).value_or(std::vector<double>{});
  for (const double value : values) {
    if (!std::isfinite(value)) refuse(base, fmt::format("has the position {}", value), "finite numbers");
  }
  if (rotary) {
    for (double& value : values) value *= std::numbers::pi / 180;
  }
  return values;
}

struct MotionArguments {
  std::string basis;
  std::optional<std::vector<double>> coefficients_um, coefficients_urad, range_mm, range_deg, nodes_mm, nodes_deg;
  std::optional<double> period_deg, period_mm;
};

/// The order that a number of coefficients belongs to.
int order_for(BasisKind kind, std::size_t coefficients) {
  const int count = static_cast<int>(coefficients);
  if (kind == BasisKind::fourier) return (count - 1) / 2;
  if (kind == BasisKind::bspline) return count - 3;
  return count - 1;
}

void add_motion(MachineErrors& errors, const std::string& name, const MotionArguments& arguments) {
  const auto [axis_index, component] = named(errors.machine, name, false);
  const Axis& axis = errors.machine.axes[axis_index];
  ErrorMotion motion;
  motion.axis = axis_index;
  motion.component = component;
  motion.coefficients =
      values_in(is_rotation(component), arguments.coefficients_um, arguments.coefficients_urad, name, "coefficients");
  Basis& basis = motion.basis;
  basis.kind = basis_kind(arguments.basis);
  const bool table = basis.kind == BasisKind::table_linear || basis.kind == BasisKind::table_monotone;
  const PositionLimits travel = position_limits(errors.machine, axis_index);
  basis.from = travel.from;
  basis.to = travel.to;
  const std::vector<double> range = positions_of(axis, arguments.range_mm, arguments.range_deg, "range");
  if (!range.empty()) {
    if (range.size() != 2 || !(range[0] < range[1])) refuse("range", "is no range", "(smallest, largest) position");
    basis.from = range[0];
    basis.to = range[1];
  }
  if (table) {
    basis.nodes = positions_of(axis, arguments.nodes_mm, arguments.nodes_deg, "nodes");
    if (basis.nodes.size() < 2 ||
        std::adjacent_find(basis.nodes.begin(), basis.nodes.end(), std::greater_equal<>()) != basis.nodes.end()) {
      refuse("nodes", "are no nodes of a table", "two or more rising positions");
    }
    basis.from = basis.nodes.front();
    basis.to = basis.nodes.back();
  } else {
    basis.order = order_for(basis.kind, motion.coefficients.size());
  }
  if (basis.kind == BasisKind::fourier) {
    basis.period = axis.kind == AxisKind::rotary ? arguments.period_deg.value_or(360) * std::numbers::pi / 180
                                                 : arguments.period_mm.value_or(0);
    if (!(basis.period > 0 && std::isfinite(basis.period)))
      refuse("period_mm", "is missing", "the period of the harmonics, mm");
  }
  if (motion.coefficients.empty() || basis.order < 0 || basis.size() != motion.coefficients.size()) {
    refuse(name.c_str(),
           fmt::format("{} coefficients do not fit the basis {}", motion.coefficients.size(), arguments.basis),
           fmt::format("{} coefficients", table ? basis.nodes.size() : basis.size()));
  }
  errors.file.errors.motions.push_back(std::move(motion));
  errors.file.covariance.resize(0, 0);
}

void add_location(MachineErrors& errors, const std::string& name, std::optional<double> um, std::optional<double> urad,
                  std::optional<double> u_um, std::optional<double> u_urad) {
  const auto [axis, component] = named(errors.machine, name, true);
  const auto listed = [](std::optional<double> value) {
    return value ? std::optional(std::vector<double>{*value}) : std::nullopt;
  };
  if (!location_error_is_valid(errors.machine.axes[axis], component)) {
    refuse("name", name + " has no effect on this machine", "a location error that moves the axis");
  }
  const bool rotation = is_rotation(component);
  LocationError location{axis, component, values_in(rotation, listed(um), listed(urad), name, "value").front(), 0};
  if (u_um || u_urad) {
    location.standard_uncertainty = values_in(rotation, listed(u_um), listed(u_urad), name, "u").front();
    if (location.standard_uncertainty < 0)
      refuse(name.c_str(), "its standard uncertainty is below zero", "zero or more");
  }
  errors.file.errors.locations.push_back(location);
  errors.file.covariance.resize(0, 0);
}

nb::object uncertainties(const MachineErrors& errors) {
  const ErrorSet& set = errors.set();
  const std::size_t count = set.parameter_count();
  std::vector<double> result(count, 0.0);
  const Eigen::MatrixXd covariance = covariance_of(errors.file);
  for (std::size_t p = 0; p < count && covariance.rows() > 0; ++p) {
    const auto index = static_cast<Eigen::Index>(p);
    result[p] = std::sqrt(std::max(0.0, covariance(index, index)));
  }
  return array_of(std::move(result), {count});
}

/// Standard uncertainties of the error motions of one axis at its positions, from the covariance of the coefficients.
nb::object evaluate_uncertainty(const MachineErrors& errors, const std::string& axis_name, const ArrayLike& positions) {
  refuse_states(errors.machine, errors.set(), "an error motion by itself");
  const std::size_t axis = errors.machine.find_axis(axis_name);
  if (axis == Machine::npos) {
    throw nb::key_error(fmt::format("no axis '{}' in {}", axis_name, errors.machine.chain()).c_str());
  }
  const Numbers values = positions.numbers("positions_mm_rad");
  if (values.ndim() != 1) refuse("positions_mm_rad", "is no list of positions", "shape (n,), mm or rad");
  const std::size_t count = values.shape(0);
  const Eigen::MatrixXd covariance = covariance_of(errors.file);
  Columns<double> result(kComponentCount, count);
  std::vector<double> functions;
  Eigen::VectorXd row(covariance.rows());
  for (std::size_t k = 0; k < count; ++k) {
    const double position = values.data()[static_cast<std::int64_t>(k) * values.stride(0)];
    for (std::size_t c = 0; c < kComponentCount; ++c) {
      row.setZero();
      Eigen::Index first = 0;
      for (const ErrorMotion& motion : errors.set().motions) {
        const std::size_t size = motion.basis.size();
        if (motion.axis == axis && static_cast<std::size_t>(motion.component) == c && covariance.rows() > 0) {
          functions.resize(size);
          motion.basis.values(position, motion.coefficients, functions);
          for (std::size_t f = 0; f < size; ++f) row[first + static_cast<Eigen::Index>(f)] += functions[f];
        }
        first += static_cast<Eigen::Index>(size);
      }
      result[c][k] = covariance.rows() > 0 ? std::sqrt(std::max(0.0, row.dot(covariance * row))) : 0.0;
    }
  }
  return result.release({kComponentCount}, false);
}

/// Errors at values of their measured and lag states; those of the machine that are left are computed at a pose.
MachineErrors errors_at(const MachineErrors& errors, const std::map<std::string, double>& states) {
  std::vector<std::string> texts;
  for (const auto& [name, value] : states) texts.push_back(fmt::format("{}={}", name, value));
  MachineErrors there{errors.machine, errors_at_options(errors.machine, errors.file, "states", texts, "errors")};
  for (const std::string& sentence : there.file.at_state.outside) {
    if (PyErr_WarnEx(PyExc_UserWarning, sentence.c_str(), 1) < 0) throw nb::python_error();
  }
  return there;
}

/// Names of the states that errors depend on, as Python gives them.
std::vector<std::string> states_used(const MachineErrors& errors) {
  std::vector<std::string> names;
  const std::vector<std::uint8_t> used = used_states(errors.machine, errors.set());
  for (std::size_t j = 0; j < used.size(); ++j) {
    if (used[j] != 0) names.push_back(errors.machine.states[j].name);
  }
  return names;
}

nb::object evaluate(const MachineErrors& errors, const std::string& axis_name, const ArrayLike& positions) {
  refuse_states(errors.machine, errors.set(), "an error motion by itself");
  const std::size_t axis = errors.machine.find_axis(axis_name);
  if (axis == Machine::npos)
    throw nb::key_error(fmt::format("no axis '{}' in {}", axis_name, errors.machine.chain()).c_str());
  const Numbers values = positions.numbers("positions_mm_rad");
  if (values.ndim() != 1) refuse("positions_mm_rad", "is no list of positions", "shape (n,), mm or rad");
  const std::size_t count = values.shape(0);
  Columns<double> result(kComponentCount, count);
  for (std::size_t k = 0; k < count; ++k) {
    const auto components = errors.set().evaluate(axis, values.data()[static_cast<std::int64_t>(k) * values.stride(0)]);
    for (std::size_t c = 0; c < kComponentCount; ++c) result[c][k] = components[c];
  }
  return result.release({kComponentCount}, false);
}

MachineErrors random(const Machine& machine, std::uint64_t seed, double mean_volumetric_um, int linear_order,
                     int rotary_order, bool location_errors) {
  MachineErrors errors{machine, {}};
  RandomErrorOptions options;
  options.seed = seed;
  options.linear_order = linear_order;
  options.rotary_harmonics = options.rotary_order = rotary_order;
  options.locations = location_errors;
  errors.file.errors = random_errors(machine, options);
  if (!(mean_volumetric_um > 0)) refuse("mean_volumetric_um", "is not above zero", "a length in um");
  if (scale_errors(machine, errors.file.errors, {.value_um = mean_volumetric_um, .remove_rigid_motion = true}) == 0) {
    refuse("machine", "no error of it moves the functional point", "a machine with errors that can be seen");
  }
  return errors;
}

Machine sound(const Machine& machine) {
  const auto found = find_problems(machine);
  if (!found.empty()) throw InputError({.field = "machine"}, found.front().text(), "a machine without problems()");
  return machine;
}

}  // namespace

void bind_errors(nb::module_& module) {
  nb::class_<MachineErrors> bound(
      module, "Errors",
      "Geometric errors of one machine: error motions, location errors, reversal values, tool offset.\n\n"
      "The machine is copied. Values are in mm and rad, in the order of `names`.\n\n"
      ">>> import abbe\n"
      ">>> mill = abbe.Machine.from_chain(\"w X' Y' b Z t\")\n"
      ">>> errors = abbe.Errors(mill)\n"
      ">>> errors.add_location('EC0Y', value_urad=20)\n"
      ">>> errors.add_motion('EAX', coefficients_urad=[25, 25])\n"
      ">>> errors.names\n"
      "['EAX[P0]', 'EAX[P1]', 'EC0Y', 'tool_X', 'tool_Y', 'tool_Z']\n");
  add_tables(bound, "errors_frame", "errors_html");
  bound
      .def(
          "__init__",
          [](MachineErrors* self, const Machine& machine) {
            new (self) MachineErrors{sound(machine), {}};
          },
          nb::arg("machine"), "No errors yet.")
      .def_static(
          "read",
          [](const std::filesystem::path& path, const Machine& machine) {
            return MachineErrors{machine, read_errors(path, machine, StatesOfErrors::allowed)};
          },
          nb::arg("path"), nb::arg("machine"),
          "Errors from a file (*.errors.toml) and the covariance it names. Raises InputError.")
      .def_static(
          "parse",
          [](const std::string& text, const Machine& machine, const std::filesystem::path& path) {
            return MachineErrors{machine, parse_errors(text, path, machine, StatesOfErrors::allowed)};
          },
          nb::arg("text"), nb::arg("machine"), nb::arg("path") = std::filesystem::path("errors.toml"),
          "Errors from text; other files are looked for in the folder of `path`.")
      .def_static(
          "random", &random, nb::arg("machine"), nb::kw_only(), nb::arg("seed") = 1,
          nb::arg("mean_volumetric_um") = 100.0, nb::arg("linear_order") = 4, nb::arg("rotary_order") = 4,
          nb::arg("location_errors") = true,
          "Smooth random errors of a stated mean volumetric error (after the best fit of the workpiece datum).\n\n"
          "The same seed gives the same errors on every computer.")
      .def_prop_ro(
          "machine", [](const MachineErrors& errors) { return errors.machine; }, "A copy of the machine.")
      .def_prop_ro(
          "names", [](const MachineErrors& errors) { return parameter_names(errors.machine, errors.set()); },
          "Names of the values: 'EXX[P2]', 'EC0Y', 'reversal_X', 'tool_X'.")
      .def_prop_ro(
          "is_angle",
          [](const MachineErrors& errors) {
            std::vector<std::uint8_t> flags;
            for (const bool angle : parameters_are_angles(errors.machine, errors.set())) flags.push_back(angle ? 1 : 0);
            return array_of_bools(std::move(flags));
          },
          nb::sig("def is_angle(self) -> numpy.ndarray"), "[p] true for values in rad, false for mm.")
      .def_prop_rw(
          "values_mm_rad",
          [](const MachineErrors& errors) {
            std::vector<double> values = errors.set().parameters();
            const std::size_t count = values.size();
            return array_of(std::move(values), {count});
          },
          [](MachineErrors& errors, const ArrayLike& argument) {
            const Numbers values = argument.numbers("values_mm_rad");
            const std::size_t count = errors.set().parameter_count();
            if (values.ndim() != 1 || values.shape(0) != count) {
              refuse("values_mm_rad", "has another shape", fmt::format("shape ({},), as names", count));
            }
            std::vector<double> copied(count);
            for (std::size_t p = 0; p < count; ++p) {
              copied[p] = values.data()[static_cast<std::int64_t>(p) * values.stride(0)];
              if (!std::isfinite(copied[p]))
                refuse("values_mm_rad", fmt::format("number {} is {}", p, copied[p]), "finite numbers");
            }
            errors.file.errors.set_parameters(copied);
          },
          nb::for_getter(nb::sig("def values_mm_rad(self) -> numpy.ndarray")), "[p] all values, mm or rad.")
      .def_prop_ro("standard_uncertainties_mm_rad", &uncertainties,
                   nb::sig("def standard_uncertainties_mm_rad(self) -> numpy.ndarray"),
                   "[p] standard uncertainties, mm or rad; 0 where none is stated.")
      .def_prop_rw(
          "covariance",
          [](const MachineErrors& errors) -> std::optional<Eigen::MatrixXd> {
            if (errors.file.covariance.rows() == 0) return std::nullopt;
            return errors.file.covariance;
          },
          [](MachineErrors& errors, const std::optional<ArrayLike>& argument) {
            if (!argument) return errors.file.covariance.resize(0, 0);
            const Numbers values = argument->numbers("covariance");
            const std::size_t count = errors.set().parameter_count();
            if (values.ndim() != 2 || values.shape(0) != count || values.shape(1) != count) {
              refuse("covariance", "has another shape", fmt::format("shape ({0}, {0}), as names", count));
            }
            const auto n = static_cast<Eigen::Index>(count);
            Eigen::MatrixXd matrix(n, n);
            for (Eigen::Index i = 0; i < n; ++i) {
              for (Eigen::Index j = 0; j < n; ++j)
                matrix(i, j) = values.data()[i * values.stride(0) + j * values.stride(1)];
            }
            if (!matrix.allFinite() ||
                (matrix - matrix.transpose()).cwiseAbs().maxCoeff() > 1e-10 * matrix.cwiseAbs().maxCoeff()) {
              refuse("covariance", "is not symmetric and finite", "a covariance matrix, products of mm and rad");
            }
            errors.file.covariance = matrix;
          },
          nb::arg("covariance").none(), "[p, p] covariance of the values, products of mm and rad; None: not stated.")
      .def_prop_ro(
          "provenance",
          [](const MachineErrors& errors) {
            return std::map<std::string, std::string>(errors.file.provenance.begin(), errors.file.provenance.end());
          },
          "Where the errors come from: free text by key.")
      .def_prop_ro(
          "distrusted", [](const MachineErrors& errors) { return errors.file.distrusted; },
          "Why the errors must not be used as they are, a sentence each; empty: they may.")
      .def_prop_ro("warnings", [](const MachineErrors& errors) { return errors.file.warnings; })
      .def(
          "add_motion",
          [](MachineErrors& errors, const std::string& name, const std::string& basis,
             std::optional<std::vector<double>> coefficients_um, std::optional<std::vector<double>> coefficients_urad,
             std::optional<std::vector<double>> range_mm, std::optional<std::vector<double>> range_deg,
             std::optional<std::vector<double>> nodes_mm, std::optional<std::vector<double>> nodes_deg,
             std::optional<double> period_mm, std::optional<double> period_deg) {
            add_motion(errors, name,
                       {basis, std::move(coefficients_um), std::move(coefficients_urad), std::move(range_mm),
                        std::move(range_deg), std::move(nodes_mm), std::move(nodes_deg), period_deg, period_mm});
          },
          nb::arg("name"), nb::arg("basis") = "legendre", nb::kw_only(), nb::arg("coefficients_um") = nb::none(),
          nb::arg("coefficients_urad") = nb::none(), nb::arg("range_mm") = nb::none(),
          nb::arg("range_deg") = nb::none(), nb::arg("nodes_mm") = nb::none(), nb::arg("nodes_deg") = nb::none(),
          nb::arg("period_mm") = nb::none(), nb::arg("period_deg") = nb::none(),
          "Adds an error motion such as 'EXX' or 'EAC'.\n\n"
          "basis: 'monomial', 'legendre', 'chebyshev', 'fourier', 'bspline', 'table-linear' or 'table-monotone'\n"
          "(docs/formats.md). Coefficients are in um for translations and in urad for rotations, in the order of the "
          "basis.\n"
          "Without a range it is the travel of the axis. A covariance that was stated is forgotten.")
      .def("add_location", &add_location, nb::arg("name"), nb::kw_only(), nb::arg("value_um") = nb::none(),
           nb::arg("value_urad") = nb::none(), nb::arg("u_um") = nb::none(), nb::arg("u_urad") = nb::none(),
           "Adds a location error such as 'EC0Y' with its standard uncertainty u, in um or urad.\n\n"
           "A covariance that was stated is forgotten.")
      .def(
          "set_reversal",
          [](MachineErrors& errors, const std::string& name, std::optional<double> um, std::optional<double> urad) {
            const std::size_t axis = errors.machine.find_axis(name);
            if (axis == Machine::npos) throw nb::key_error(fmt::format("no axis '{}'", name).c_str());
            const bool rotary = errors.machine.axes[axis].kind == AxisKind::rotary;
            const auto listed = [](std::optional<double> v) {
              return v ? std::optional(std::vector<double>{*v}) : std::nullopt;
            };
            const double value = values_in(rotary, listed(um), listed(urad), "reversal_" + name, "value").front();
            auto& all = errors.file.errors.reversals;
            std::erase_if(all, [&](const Reversal& reversal) { return reversal.axis == axis; });
            all.push_back({axis, value, 0});
            errors.file.covariance.resize(0, 0);
          },
          nb::arg("axis"), nb::kw_only(), nb::arg("value_um") = nb::none(), nb::arg("value_urad") = nb::none(),
          "Sets the reversal value of an axis (ISO 230-2: position after a positive approach less that after a "
          "negative\n"
          "one; lost motion is below zero).")
      .def_prop_ro("states", &states_used,
                   "Names of the states of the machine that the errors depend on; empty: they depend on none.")
      .def("at_state", &errors_at, nb::arg("states"),
           "Errors as they are at values of measured and lag states, with their covariance.\n\n"
           "states: {'ambient_degC': 26.5}, all that the errors depend on. Errors with states that are computed at a\n"
           "pose keep these. 'days_since_measurement' adds the random walk of the errors. Warns (UserWarning) of\n"
           "values beyond those that were measured. Raises InputError naming what is missing.")
      .def("evaluate", &evaluate, nb::arg("axis"), nb::arg("positions_mm_rad"),
           nb::sig("def evaluate(self, axis: str, positions_mm_rad: numpy.typing.ArrayLike) -> numpy.ndarray"),
           "Error motions of one axis at its positions: [n, 6], EX EY EZ in mm, EA EB EC in rad.")
      .def("evaluate_uncertainty", &evaluate_uncertainty, nb::arg("axis"), nb::arg("positions_mm_rad"),
           nb::sig(
               "def evaluate_uncertainty(self, axis: str, positions_mm_rad: numpy.typing.ArrayLike) -> numpy.ndarray"),
           "Standard uncertainties of the error motions of one axis: [n, 6], mm and rad; 0 where none is stated.")
      .def(
          "text", [](const MachineErrors& errors) { return errors_text(errors.machine, errors.file); },
          "Text of an errors file without the covariance.")
      .def(
          "write",
          [](const MachineErrors& errors, const std::filesystem::path& path, bool overwrite) {
            refuse_existing(path, overwrite);
            if (errors.file.covariance.rows() > 0) refuse_existing(covariance_beside(path), overwrite);
            write_errors(path, errors.machine, errors.file);
          },
          nb::arg("path"), nb::arg("overwrite") = false,
          "Writes an errors file and, beside it, its covariance. Existing files are only replaced with overwrite=True.")
      .def(
          "copy", [](const MachineErrors& errors) { return errors; }, "A copy that can be changed on its own.")
      .def("__len__", [](const MachineErrors& errors) { return errors.set().parameter_count(); })
      .def("__repr__", [](const MachineErrors& errors) {
        const ErrorSet& set = errors.set();
        return fmt::format("<abbe.Errors of {}: {} error motions, {} location errors, {} values{}>",
                           errors.machine.chain(), set.motions.size(), set.locations.size(), set.parameter_count(),
                           errors.file.covariance.rows() > 0 ? ", with covariance" : "");
      });
}

}  // namespace abbe::python
