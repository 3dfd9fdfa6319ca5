#include "abbe/instruments/instrument_observations.h"

#include <Eigen/Core>
#include <algorithm>
#include <cassert>

#include "abbe/errors/error_states.h"
#include "abbe/errors/reversal.h"
#include "abbe/instruments/jacobian_target.h"
#include "abbe/instruments/reading_weights.h"

namespace abbe {
namespace {

constexpr std::size_t kMaxRows = 6;
constexpr std::size_t kNone = static_cast<std::size_t>(-1);
static_assert(Observations::kBlockSize <= ChainPlan::kBlockSize);

/// Working memory of one thread, grown once and kept.
struct InstrumentScratch {
  static constexpr std::size_t kBlock = Observations::kBlockSize;
  std::vector<double> positions, states, inputs, by_quantity, jacobian, by_position;
  std::vector<const double*> axis, state;
  ItemBlock block;
  double rotation[9][kBlock], start[3][kBlock], seen[3][kBlock], origin[3][kBlock];
  double value[kMaxRows * kBlock], by_motion[kMaxRows * 6 * kBlock];
  double force[kMaxRows][6][kBlock];
  std::uint16_t at[kBlock];  ///< place of the readings of one pair in the block, those of one item together
};

InstrumentScratch& instrument_scratch() {
  thread_local InstrumentScratch memory;
  return memory;
}

}  // namespace

struct InstrumentObservations::Implementation {
  struct BodyPair {
    Body from, to;
    ChainPlan plan;
  };

  ErrorSet errors;
  std::shared_ptr<const Instrument> instrument;
  InstrumentReadings readings;
  ReadingWeights weights;
  std::vector<BodyPair> pairs;
  std::vector<std::size_t> pair_of;  ///< [items]
  std::vector<SetupUnknown> unknowns;
  std::vector<std::size_t> quantity_of;  ///< [unknowns]
  std::vector<double> values;            ///< [quantities]
  std::vector<double> unknown_values;
  std::size_t tool_parameter = 0;
  Eigen::Vector3d tool_offset_error = Eigen::Vector3d::Zero();
  ReversalShift reversal;
  GivenStates given_states;
  ReadingDrift drift;

  std::size_t rows() const { return instrument->components().size(); }
  std::size_t find_members(std::size_t first, std::size_t count, std::size_t pair, InstrumentScratch& s) const;
  void load(const BodyPair& pair, std::size_t first, std::size_t members, InstrumentScratch& s) const;
  void see(const BodyPair& pair, std::size_t first, std::size_t members, InstrumentScratch& s) const;
  /// The bodies as a set-up sees them that has moved.
  void move(std::size_t first, std::size_t members, InstrumentScratch& s) const;
  /// Columns of the drift among the set-up's, and forces back in the frame of the body.
  void take_drift(std::size_t first, std::size_t members, std::size_t count,
                  std::span<const std::size_t> setup_parameters, double* columns, std::size_t stride,
                  InstrumentScratch& s) const;
  void evaluate_pair(const BodyPair& pair, std::size_t members, std::size_t first, std::size_t count,
                     std::span<const std::size_t> machine_parameters, std::span<const std::size_t> setup_parameters,
                     double* residuals, const JacobianTarget& out) const;
  void evaluate(std::size_t first, std::size_t count, std::span<const std::size_t> machine_parameters,
                std::span<const std::size_t> setup_parameters, double* residuals, const JacobianTarget& out) const;
  void differentiate(const BodyPair& pair, std::size_t members, std::size_t first, std::size_t count,
                     std::span<const std::size_t> machine_parameters, const JacobianTarget& out,
                     InstrumentScratch& s) const;
  void model_item(std::size_t begin, std::size_t end, std::size_t first, std::size_t count,
                  std::span<const std::size_t> setup_parameters, std::size_t setup_column, double* residuals,
                  double* jacobian, std::size_t stride) const;
};

std::size_t InstrumentObservations::Implementation::find_members(std::size_t first, std::size_t count, std::size_t pair,
                                                                 InstrumentScratch& s) const {
  std::size_t members = 0;
  bool in_order = true;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t item = readings.item[first + k];
    if (pair_of[item] != pair) continue;
    in_order = in_order && (members == 0 || readings.item[first + s.at[members - 1]] <= item);
    s.at[members++] = static_cast<std::uint16_t>(k);
  }
  if (!in_order) {
    std::sort(s.at, s.at + members, [&](std::uint16_t a, std::uint16_t b) {
      const std::uint16_t item_a = readings.item[first + a], item_b = readings.item[first + b];
      return item_a != item_b ? item_a < item_b : a < b;
    });
  }
  return members;
}

void InstrumentObservations::Implementation::load(const BodyPair& pair, std::size_t first, std::size_t members,
                                                  InstrumentScratch& s) const {
  const auto gather = [&](const std::vector<std::vector<double>>& columns, std::vector<double>& memory,
                          std::vector<const double*>& pointers) {
    memory.resize(columns.size() * kBlockSize);
    pointers.resize(columns.size());
    for (std::size_t i = 0; i < columns.size(); ++i) {
      double* gathered = &memory[i * kBlockSize];
      for (std::size_t k = 0; k < members; ++k) gathered[k] = columns[i][first + s.at[k]];
      pointers[i] = gathered;
    }
  };
  gather(readings.poses.axis, s.positions, s.axis);
  if (reversal.acts_on(readings.poses)) {
    for (std::size_t i = 0; i < s.axis.size(); ++i) {
      double* commands = &s.positions[i * kBlockSize];
      for (std::size_t k = 0; k < members; ++k) commands[k] += reversal.shift(readings.poses, i, first + s.at[k]);
    }
  }
  given_states.gather(readings.poses, first, {s.at, members}, kBlockSize, s.states, s.state);
  gather(readings.inputs, s.inputs, s.block.inputs);
  const bool on_tool = pair.from == Body::tool;
  for (int c = 0; c < 3; ++c) std::fill_n(s.start[c], members, on_tool ? tool_offset_error[c] : 0.0);
}

void InstrumentObservations::Implementation::see(const BodyPair& pair, std::size_t first, std::size_t members,
                                                 InstrumentScratch& s) const {
  RotationArrays rotation;
  for (int i = 0; i < 9; ++i) rotation.r[i] = s.rotation[i];
  pair.plan.transform({s.axis, members, s.state}, {s.start[0], s.start[1], s.start[2]},
                      {s.seen[0], s.seen[1], s.seen[2]}, rotation);
  const bool from_tool = pair.to == Body::tool;
  for (int c = 0; c < 3; ++c) {
    for (std::size_t k = 0; k < members; ++k) {
      s.origin[c][k] = s.seen[c][k] - (from_tool ? tool_offset_error[c] : 0.0);
    }
  }
  if (drift.acts()) move(first, members, s);
}

void InstrumentObservations::Implementation::move(std::size_t first, std::size_t members, InstrumentScratch& s) const {
  for (std::size_t k = 0; k < members; ++k) {
    const std::size_t reading = first + s.at[k];
    const Eigen::Vector3d origin = drift.seen(reading, {s.origin[0][k], s.origin[1][k], s.origin[2][k]});
    for (int c = 0; c < 3; ++c) s.origin[c][k] = origin[c];
    Eigen::Matrix3d rotation;
    for (int i = 0; i < 9; ++i) rotation(i / 3, i % 3) = s.rotation[i][k];
    rotation = drift.turn(reading).transpose() * rotation;
    for (int i = 0; i < 9; ++i) s.rotation[i][k] = rotation(i / 3, i % 3);
  }
}

void InstrumentObservations::Implementation::take_drift(std::size_t first, std::size_t members, std::size_t count,
                                                        std::span<const std::size_t> setup_parameters, double* columns,
                                                        std::size_t stride, InstrumentScratch& s) const {
  const std::size_t own_unknowns = quantity_of.size();
  for (std::size_t k = 0; k < members; ++k) {
    const std::size_t reading = first + s.at[k];
    const Eigen::Vector3d origin(s.origin[0][k], s.origin[1][k], s.origin[2][k]);
    const Eigen::Matrix3d turn = drift.turn(reading);
    for (std::size_t row = 0; row < rows(); ++row) {
      const auto& f = s.force[row];
      const Eigen::Vector3d force(f[0][k], f[1][k], f[2][k]), moment(f[3][k], f[4][k], f[5][k]);
      const Eigen::Matrix<double, 6, 1> slopes = drift.slopes(reading, origin, force, moment);
      for (std::size_t i = 0; i < setup_parameters.size(); ++i) {
        if (setup_parameters[i] < own_unknowns) continue;
        const std::size_t unknown = setup_parameters[i] - own_unknowns;
        columns[i * stride + row * count + s.at[k]] =
            drift.weight(unknown, reading) * slopes[drift.component_of(unknown)];
      }
      const Eigen::Vector3d back = turn * force, moment_back = turn * moment;
      for (int c = 0; c < 3; ++c) {
        s.force[row][c][k] = back[c];
        s.force[row][3 + c][k] = moment_back[c];
      }
    }
  }
}

void InstrumentObservations::Implementation::model_item(std::size_t begin, std::size_t end, std::size_t first,
                                                        std::size_t count,
                                                        std::span<const std::size_t> setup_parameters,
                                                        std::size_t setup_column, double* residuals, double* jacobian,
                                                        std::size_t stride) const {
  InstrumentScratch& s = instrument_scratch();
  const std::size_t n = end - begin;
  ItemBlock& block = s.block;
  block.item = readings.item[first + s.at[begin]];
  block.count = n;
  for (int i = 0; i < 9; ++i) block.rotation[i] = s.rotation[i] + begin;
  for (int i = 0; i < 3; ++i) block.origin[i] = s.origin[i] + begin;
  for (const double*& input : block.inputs) input += begin;
  block.quantities = values.data();
  const std::vector<std::size_t>& used = instrument->items()[block.item].quantities;
  ModelledBlock out;
  out.value = s.value;
  if (jacobian != nullptr) {
    s.by_quantity.resize(std::max<std::size_t>(1, rows() * used.size() * n));
    out.by_motion = s.by_motion;
    out.by_quantity = s.by_quantity.data();
  }
  instrument->model(block, out);
  for (const double*& input : block.inputs) input -= begin;

  for (std::size_t row = 0; row < rows(); ++row) {
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t at = s.at[begin + k];
      const std::size_t reading = first + at;
      residuals[row * count + at] = weights.weighted(
          row, reading, [&](std::size_t r) { return readings.measured[r][reading] - s.value[r * n + k]; });
      if (jacobian == nullptr) continue;
      for (std::size_t j = 0; j < 6; ++j) {
        s.force[row][j][begin + k] =
            weights.weighted(row, reading, [&](std::size_t r) { return s.by_motion[(r * 6 + j) * n + k]; });
      }
    }
  }
  if (jacobian == nullptr) return;
  for (std::size_t i = 0; i < setup_parameters.size(); ++i) {
    if (setup_parameters[i] >= quantity_of.size()) continue;  // of the drift
    const std::size_t quantity = quantity_of[setup_parameters[i]];
    const std::size_t q = static_cast<std::size_t>(std::find(used.begin(), used.end(), quantity) - used.begin());
    for (std::size_t row = 0; row < rows(); ++row) {
      double* column = jacobian + (setup_column + i) * stride + row * count;
      for (std::size_t k = 0; k < n; ++k) {
        const std::size_t at = s.at[begin + k];
        column[at] = q < used.size()
                         ? weights.weighted(row, first + at,
                                            [&](std::size_t r) { return s.by_quantity[(r * used.size() + q) * n + k]; })
                         : 0.0;
      }
    }
  }
}

void InstrumentObservations::Implementation::evaluate_pair(const BodyPair& pair, std::size_t members, std::size_t first,
                                                           std::size_t count,
                                                           std::span<const std::size_t> machine_parameters,
                                                           std::span<const std::size_t> setup_parameters,
                                                           double* residuals, const JacobianTarget& out) const {
  InstrumentScratch& s = instrument_scratch();
  const std::size_t setup_column =
      out.written(machine_parameters.size() + setup_parameters.size()) - setup_parameters.size();
  load(pair, first, members, s);
  see(pair, first, members, s);
  for (std::size_t begin = 0; begin < members;) {
    std::size_t end = begin + 1;
    while (end < members && readings.item[first + s.at[end]] == readings.item[first + s.at[begin]]) ++end;
    model_item(begin, end, first, count, setup_parameters, setup_column, residuals, out.columns, out.stride);
    begin = end;
  }
  if (!out.wanted()) return;
  if (drift.acts()) {
    take_drift(first, members, count, setup_parameters, out.columns + setup_column * out.stride, out.stride, s);
  }
  if (!machine_parameters.empty()) differentiate(pair, members, first, count, machine_parameters, out, s);
}

void InstrumentObservations::Implementation::differentiate(const BodyPair& pair, std::size_t members, std::size_t first,
                                                           std::size_t count,
                                                           std::span<const std::size_t> machine_parameters,
                                                           const JacobianTarget& out, InstrumentScratch& s) const {
  RowArrays row_arrays[kMaxRows];
  for (std::size_t row = 0; row < rows(); ++row) {
    row_arrays[row].force = {s.force[row][0], s.force[row][1], s.force[row][2]};
    row_arrays[row].moment = {s.force[row][3], s.force[row][4], s.force[row][5]};
  }
  // Columns of the machine stand first, whole or as carriers.
  std::size_t columns = 0;
  for (std::size_t j = 0; j < machine_parameters.size(); ++j) columns = std::max(columns, out.place(j) + 1);
  JacobianTarget compact = out;
  // Where all readings of the block follow each other in their order, they are written to their places at once.
  const bool in_place = members == count && std::is_sorted(s.at, s.at + members);
  if (!in_place) {
    compact.stride = rows() * members;
    compact.basis_stride = members;
    s.jacobian.resize(columns * compact.stride + out.bases_written() * members);
    compact.columns = s.jacobian.data();
    compact.bases = compact.columns + columns * compact.stride;
  }
  double* by_position = nullptr;
  if (reversal.acts_on(readings.poses)) {
    s.by_position.resize(s.axis.size() * rows() * members);
    by_position = s.by_position.data();
  }
  const BlockMembers block{first, count, {s.at, members}};
  differentiate_readings(pair.plan, {s.axis, members, s.state}, {s.start[0], s.start[1], s.start[2]},
                         {s.seen[0], s.seen[1], s.seen[2]}, {row_arrays, rows()}, machine_parameters, compact, nullptr,
                         by_position, reversal, readings.poses, block);
  if (!in_place) spread_derivatives(compact, columns, rows(), block, out);
}

void InstrumentObservations::Implementation::evaluate(std::size_t first, std::size_t count,
                                                      std::span<const std::size_t> machine_parameters,
                                                      std::span<const std::size_t> setup_parameters, double* residuals,
                                                      const JacobianTarget& out) const {
  assert(count <= kBlockSize && first + count <= readings.count());
  for (std::size_t pair = 0; pair < pairs.size(); ++pair) {
    const std::size_t members = find_members(first, count, pair, instrument_scratch());
    if (members == 0) continue;
    evaluate_pair(pairs[pair], members, first, count, machine_parameters, setup_parameters, residuals, out);
  }
}

InstrumentObservations::InstrumentObservations(const Machine& machine, const ErrorSet& errors,
                                               std::shared_ptr<const Instrument> instrument,
                                               InstrumentReadings readings)
    : implementation_(std::make_unique<Implementation>()) {
  check_readings(machine, *instrument, readings);
  Implementation& own = *implementation_;
  own.errors = errors;
  own.instrument = std::move(instrument);
  own.readings = std::move(readings);
  assert(own.rows() >= 1 && own.rows() <= kMaxRows);
  own.tool_parameter = errors.parameter_count() - 3;
  own.tool_offset_error = errors.tool_offset_error;
  own.reversal = ReversalShift(errors);
  own.given_states = GivenStates(machine, errors);
  require_states(machine, errors, own.readings.poses);
  own.weights = ReadingWeights(*own.instrument, own.readings);
  // Only pairs of bodies that occur get a plan.
  std::vector<std::uint8_t> occurs(own.instrument->items().size(), 0);
  for (const std::uint16_t item : own.readings.item) occurs[item] = 1;
  own.pair_of.assign(occurs.size(), kNone);
  for (std::size_t i = 0; i < occurs.size(); ++i) {
    if (occurs[i] == 0) continue;
    const InstrumentItem& item = own.instrument->items()[i];
    std::size_t pair = 0;
    while (pair < own.pairs.size() && (own.pairs[pair].from != item.from || own.pairs[pair].to != item.to)) ++pair;
    if (pair == own.pairs.size()) {
      own.pairs.push_back({item.from, item.to, ChainPlan(machine, errors, item.from, item.to)});
    }
    own.pair_of[i] = pair;
  }
  for (std::size_t q = 0; q < own.instrument->quantities().size(); ++q) {
    const SetupQuantity& quantity = own.instrument->quantities()[q];
    own.values.push_back(quantity.value);
    if (quantity.knowledge == Knowledge::exact) continue;
    own.unknowns.push_back({quantity.name, quantity.is_angle, quantity.scale, quantity.is_pure_number});
    own.quantity_of.push_back(q);
    own.unknown_values.push_back(quantity.value);
  }
  if (own.readings.drift == nullptr) return;
  std::vector<std::uint16_t> place;
  for (const std::uint16_t item : own.readings.item) {
    place.push_back(static_cast<std::uint16_t>(own.instrument->station_of(item)));
  }
  own.drift = ReadingDrift(own.readings.drift, own.readings.time_s, std::move(place));
  for (SetupUnknown& unknown : own.readings.drift->unknowns()) own.unknowns.push_back(std::move(unknown));
  const std::vector<double>& values = own.readings.drift->values;
  own.unknown_values.insert(own.unknown_values.end(), values.begin(), values.end());
}

InstrumentObservations::~InstrumentObservations() = default;

std::string InstrumentObservations::name() const { return implementation_->instrument->name(); }
std::size_t InstrumentObservations::reading_count() const { return implementation_->readings.count(); }
int InstrumentObservations::rows() const { return static_cast<int>(implementation_->rows()); }
const std::vector<ReadingComponent>& InstrumentObservations::components() const {
  return implementation_->instrument->components();
}
const std::vector<SetupUnknown>& InstrumentObservations::unknowns() const { return implementation_->unknowns; }
std::vector<double> InstrumentObservations::unknown_values() const { return implementation_->unknown_values; }
std::vector<double> InstrumentObservations::positions(std::size_t reading) const {
  return implementation_->readings.poses.pose(reading);
}
const Instrument& InstrumentObservations::instrument() const { return *implementation_->instrument; }
const InstrumentReadings& InstrumentObservations::readings() const { return implementation_->readings; }
std::size_t InstrumentObservations::quantity_of(std::size_t unknown) const {
  return implementation_->quantity_of.at(unknown);
}
std::vector<double> InstrumentObservations::quantity_values() const { return implementation_->values; }

void InstrumentObservations::set_parameters(std::span<const double> machine, std::span<const double> setup) {
  Implementation& own = *implementation_;
  assert(machine.size() == own.tool_parameter + 3);
  assert(setup.size() == own.unknowns.size());
  for (Implementation::BodyPair& pair : own.pairs) pair.plan.set_parameters(machine);
  own.reversal.set_parameters(machine);
  for (int k = 0; k < 3; ++k) own.tool_offset_error[k] = machine[own.tool_parameter + static_cast<std::size_t>(k)];
  for (std::size_t i = 0; i < setup.size(); ++i) {
    own.unknown_values[i] = setup[i];
    if (i < own.quantity_of.size()) own.values[own.quantity_of[i]] = setup[i];
  }
  own.drift.set(setup.subspan(own.quantity_of.size()));
}

void InstrumentObservations::evaluate(std::size_t first, std::size_t count,
                                      std::span<const std::size_t> machine_parameters,
                                      std::span<const std::size_t> setup_parameters, double* residuals,
                                      double* jacobian, std::size_t stride) const {
  implementation_->evaluate(first, count, machine_parameters, setup_parameters, residuals,
                            JacobianTarget::of(jacobian, stride));
}

std::optional<FactoredColumns> InstrumentObservations::column_factors(
    std::span<const std::size_t> machine_parameters, std::span<const std::size_t> setup_parameters) const {
  return factors_with_setup(implementation_->errors, machine_parameters, setup_parameters);
}

void InstrumentObservations::evaluate_factored(std::size_t first, std::size_t count,
                                               std::span<const std::size_t> machine_parameters,
                                               std::span<const std::size_t> setup_parameters, double* residuals,
                                               const JacobianFactors& factors) const {
  implementation_->evaluate(first, count, machine_parameters, setup_parameters, residuals, JacobianTarget::of(factors));
}

bool InstrumentObservations::displacement_rows(std::size_t first, std::size_t count, double* rows_out) const {
  const Implementation& own = *implementation_;
  assert(count <= kBlockSize && first + count <= own.readings.count());
  InstrumentScratch& s = instrument_scratch();
  double residuals[kMaxRows * kBlockSize];
  double no_columns = 0;  // asks for derivatives; nothing is written, as no column is wanted
  for (std::size_t pair = 0; pair < own.pairs.size(); ++pair) {
    const std::size_t members = own.find_members(first, count, pair, s);
    if (members == 0) continue;
    own.load(own.pairs[pair], first, members, s);
    own.see(own.pairs[pair], first, members, s);
    for (std::size_t begin = 0; begin < members;) {
      std::size_t end = begin + 1;
      while (end < members && own.readings.item[first + s.at[end]] == own.readings.item[first + s.at[begin]]) ++end;
      own.model_item(begin, end, first, count, {}, 0, residuals, &no_columns, 0);
      begin = end;
    }
    if (own.drift.acts()) own.take_drift(first, members, count, {}, nullptr, 0, s);
    for (std::size_t direction = 0; direction < 3; ++direction) {
      for (std::size_t row = 0; row < own.rows(); ++row) {
        for (std::size_t k = 0; k < members; ++k) {
          rows_out[(direction * own.rows() + row) * count + s.at[k]] = s.force[row][direction][k];
        }
      }
    }
  }
  return true;
}

std::vector<double> InstrumentObservations::deviation(std::size_t reading) const {
  std::vector<double> result(implementation_->rows());
  deviations(reading, 1, result.data());
  return result;
}

void InstrumentObservations::deviations(std::size_t first, std::size_t count, double* out) const {
  const Implementation& own = *implementation_;
  evaluate(first, count, {}, {}, out, nullptr, 0);
  double of_reading[kMaxRows];
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t row = 0; row < own.rows(); ++row) of_reading[row] = out[row * count + k];
    own.weights.unweight(first + k, of_reading);
    for (std::size_t row = 0; row < own.rows(); ++row) out[row * count + k] = of_reading[row];
  }
}

std::vector<std::vector<double>> InstrumentObservations::modelled() const {
  const Implementation& own = *implementation_;
  std::vector<std::vector<double>> result = own.readings.measured;
  std::vector<double> apart(own.rows() * kBlockSize);
  for (std::size_t first = 0; first < own.readings.count(); first += kBlockSize) {
    const std::size_t n = std::min(kBlockSize, own.readings.count() - first);
    deviations(first, n, apart.data());
    for (std::size_t row = 0; row < own.rows(); ++row)
      for (std::size_t k = 0; k < n; ++k) result[row][first + k] -= apart[row * n + k];
  }
  return result;
}

}  // namespace abbe
