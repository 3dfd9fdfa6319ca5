#include "abbe/machine/machines_for_test.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "abbe/geometry/angle_units.h"
#include "abbe/machine/chain.h"

namespace abbe::test {
namespace {

Machine from_chain(const std::string& name, const std::string& chain) {
  const ParsedChain parsed = parse_chain(chain);
  if (!parsed.ok) throw std::logic_error(parsed.error.message());
  Machine machine = parsed.machine;
  machine.name = name;
  return machine;
}

Axis& axis(Machine& machine, const char* name) { return machine.axes.at(machine.find_axis(name)); }

void travel(Machine& machine, const char* name, double from, double to) {
  Axis& a = axis(machine, name);
  const double unit = a.kind == AxisKind::rotary ? kDegree : 1;
  a.travel_min = from * unit;
  a.travel_max = to * unit;
  a.endless = false;
}

void endless(Machine& machine, const char* name) { axis(machine, name).endless = true; }
void point(Machine& machine, const char* name, const Eigen::Vector3d& p) { axis(machine, name).point = p; }

void workpiece_at(Machine& machine, const Eigen::Vector3d& p) {
  machine.bed_from_workpiece = RigidTransform::translate(p);
}

void tool(Machine& machine, const Eigen::Vector3d& gauge, const Eigen::Vector3d& offset) {
  machine.tool_reference = gauge;
  machine.tool_offset = offset;
}

}  // namespace

Machine aguado_table() {
  Machine m = from_chain("Aguado", "w C' X' b Z t");
  const Eigen::Vector3d c(699.7148742739481, -0.20895713340667849, -100);
  travel(m, "C", 0, 360);
  travel(m, "X", 0, 1400);
  travel(m, "Z", 0, 600);
  point(m, "C", c);
  workpiece_at(m, c);
  tool(m, {0, 0, 300}, {0, 0, 0});
  return m;
}

Machine wang_grinder() {
  Machine m = from_chain("Wang grinder", "w C b X Z A Y B t");
  travel(m, "C", 0, 360);
  travel(m, "X", 0, 440);
  travel(m, "Z", 0, 440);
  travel(m, "A", 0, 360);
  travel(m, "Y", 0, 220);
  travel(m, "B", -45, 45);
  axis(m, "A").setting = true;
  workpiece_at(m, {0, 0, 400});
  tool(m, {0, 0, 0}, {200, 0, 0});
  m.tool_direction = {-1, 0, 0};
  return m;
}

Machine yin_engraver(char convention) {
  const double r_a = 240.745, r_c1 = 209.476, l_ta = -0.265, l_ac1 = -0.145;
  const double x0 = -197.236, y0 = 25.306, z0 = -528.996;
  const bool u = convention == 'U';
  Machine m = from_chain("Yin engraver", u ? "w C2' X Y b Z C1 A t" : "w C2' b X Y Z C1 A t");
  const double z = u ? -z0 : z0;
  point(m, "C1", {x0, y0, z});
  point(m, "A", {x0 + r_c1, y0 + l_ac1, z});
  tool(m, {x0 + r_c1, y0 + l_ac1, z}, {0, l_ta, u ? -r_a : r_a});
  travel(m, "X", -800, 800);
  travel(m, "Y", -800, 800);
  travel(m, "Z", u ? -450 : -200, 800);
  travel(m, "C1", -200, 200);
  travel(m, "A", -185, 185);
  endless(m, "C2");
  axis(m, "C2").setting = true;
  return m;
}

Machine liu_scanner() {
  Machine m = from_chain("Liu scanner", "w C A X' Y' b Z t");
  axis(m, "C").direction = Eigen::Vector3d::UnitY();
  endless(m, "C");
  endless(m, "A");
  for (const char* name : {"X", "Y", "Z"}) travel(m, name, -100, 100);
  tool(m, {0, 0, 10.05}, {0, 0, -0.05});
  return m;
}

Machine trunnion_mill() {
  Machine m = from_chain("trunnion mill", "w C' A' Y' b X Z t");
  endless(m, "C");
  travel(m, "A", -120, 30);
  travel(m, "Y", -255, 255);
  travel(m, "X", -300, 300);
  travel(m, "Z", -510, 0);
  point(m, "C", {0, 0, 0});
  point(m, "A", {0, 0.02, 50});
  workpiece_at(m, {0, 0, 0});
  tool(m, {0, 0, 560}, {0, 0, -150});
  return m;
}

Machine swivel_head_mill() {
  Machine m = from_chain("swivel-head mill", "w X' b Y Z B A t");
  travel(m, "X", 0, 2000);
  travel(m, "Y", -500, 500);
  travel(m, "Z", -800, 0);
  travel(m, "B", -100, 100);
  travel(m, "A", -30, 30);
  point(m, "B", {1000, -120, 1150});
  point(m, "A", {1000, -120, 1150});
  workpiece_at(m, {1000, 0, 0});
  tool(m, {1000, -120, 900}, {0, 0, -120});
  return m;
}

Machine head_table_mill() {
  Machine m = from_chain("head-table mill", "w C' X' b Y Z B t");
  endless(m, "C");
  travel(m, "X", -400, 400);
  travel(m, "Y", -325, 325);
  travel(m, "Z", -560, 0);
  travel(m, "B", -120, 30);
  point(m, "B", {60, 0, 860});
  tool(m, {0, 0, 680}, {0, 0, -160});
  return m;
}

Machine gantry_fork_head() {
  Machine m = from_chain("gantry with fork head", "w b X Y Z C A t");
  travel(m, "X", 0, 4000);
  travel(m, "Y", 0, 2500);
  travel(m, "Z", -1250, 0);
  travel(m, "C", -360, 360);
  travel(m, "A", -110, 110);
  point(m, "C", {0, 0, 1700});
  point(m, "A", {0, 0, 1700});
  tool(m, {0, 0, 1480}, {0, 0, -130});
  return m;
}

Machine lathe() {
  Machine m = from_chain("lathe", "w C' b Z X t");
  endless(m, "C");
  travel(m, "Z", 5, 560);
  travel(m, "X", -20, 210);
  tool(m, {65, 0, 0}, {-65, 0, 0});
  m.tool_direction = {1, 0, 0};
  return m;
}

Machine three_axis_mill() {
  Machine m = from_chain("three-axis mill", "w X' Y' b Z t");
  travel(m, "X", 0, 760);
  travel(m, "Y", 0, 440);
  travel(m, "Z", -460, 0);
  workpiece_at(m, {380, 220, 0});
  tool(m, {0, 0, 610}, {0, 0, -120});
  return m;
}

Machine moving_table_cmm() {
  Machine m = from_chain("moving-table CMM", "w Y' b X Z t");
  travel(m, "Y", 0, 1200);
  travel(m, "X", 0, 900);
  travel(m, "Z", -600, 0);
  tool(m, {0, 0, 800}, {0, 0, -150});
  return m;
}

Machine nutating_head_mill() {
  Machine m = from_chain("nutating-head mill", "w C' X' b Y Z B t");
  axis(m, "B").direction = {0, std::numbers::sqrt2 / 2, std::numbers::sqrt2 / 2};
  endless(m, "C");
  travel(m, "X", -400, 400);
  travel(m, "Y", -400, 400);
  travel(m, "Z", -600, 0);
  travel(m, "B", -30, 180);
  point(m, "B", {0, 150, 1000});
  tool(m, {0, 0, 700}, {0, 0, -140});
  return m;
}

Machine redundant_gantry() {
  Machine m = from_chain("redundant gantry", "w C2' X1' b X2 Y Z C1 A t");
  point(m, "C1", {10, -20, 900});
  point(m, "A", {40, -18, 900});
  tool(m, {40, -18, 700}, {0, 0, -100});
  endless(m, "C1");
  endless(m, "C2");
  return m;
}

Machine three_axis_head() {
  Machine m = from_chain("three-axis head", "w b X Y Z C1 A C2 t");
  point(m, "C1", {10, -20, 900});
  point(m, "A", {40, -18, 900});
  point(m, "C2", {40, -15, 900});
  tool(m, {40, -18, 700}, {30, 0, -100});
  m.tool_direction = Eigen::Vector3d(1, 2, 2) / 3;
  return m;
}

Machine rotary_table() {
  Machine machine;
  machine.name = "rotary table";
  Axis c{.name = "C", .kind = AxisKind::rotary, .side = ChainSide::workpiece};
  c.direction = Eigen::Vector3d::UnitZ();
  c.travel_max = 2 * std::numbers::pi;
  machine.axes = {c};
  return machine;
}

Machine arm_of_lines(const std::vector<Eigen::Vector3d>& directions, const std::vector<Eigen::Vector3d>& points,
                     const Eigen::Vector3d& tool_at) {
  Machine m;
  m.name = "arm";
  for (std::size_t i = 0; i < directions.size(); ++i) {
    Axis a{.name = "A" + std::to_string(i + 1), .kind = AxisKind::rotary, .side = ChainSide::tool};
    a.direction = directions[i].normalized();
    a.point = points[i];
    a.travel_min = -std::numbers::pi;
    a.travel_max = std::numbers::pi;
    m.axes.push_back(a);
  }
  m.tool_reference = tool_at;
  return m;
}

Machine jointed_arm() {
  Machine m = from_chain("jointed arm", "w b C1 B1 B2 A1 B3 A2 t");
  travel(m, "C1", -165, 165);
  travel(m, "B1", -110, 110);
  travel(m, "B2", -110, 70);
  travel(m, "A1", -160, 160);
  travel(m, "B3", -120, 120);
  travel(m, "A2", -400, 400);
  point(m, "B1", {0, 0, 290});
  point(m, "B2", {0, 0, 560});
  point(m, "A1", {0, 0, 630});
  point(m, "B3", {302, 0, 630});
  point(m, "A2", {374, 0, 630});
  tool(m, {374, 0, 630}, {60, 0, 25});
  m.tool_direction = {-1, 0, 0};
  return m;
}

Machine parallel_axes_arm() {
  Machine m = from_chain("parallel-axes arm", "w b C1 B1 B2 B3 C2 B4 t");
  for (const char* name : {"C1", "B1", "B3", "C2", "B4"}) travel(m, name, -360, 360);
  travel(m, "B2", -180, 180);
  point(m, "B1", {0, 0, 89});
  point(m, "B2", {425, 0, 89});
  point(m, "B3", {817, 0, 89});
  point(m, "C2", {817, 109, 89});
  point(m, "B4", {817, 109, -6});
  axis(m, "C2").direction = {0, 0, -1};
  tool(m, {817, 191, -6}, {0, 70, 0});
  m.tool_direction = {0, -1, 0};
  return m;
}

Machine seven_axis_arm() {
  Machine m = from_chain("seven-axis arm", "w b C1 B1 C2 B2 C3 B3 C4 t");
  for (const char* name : {"C1", "C2", "C3"}) travel(m, name, -170, 170);
  for (const char* name : {"B1", "B2", "B3"}) travel(m, name, -120, 120);
  travel(m, "C4", -175, 175);
  for (const char* name : {"B1", "C2"}) point(m, name, {0, 0, 340});
  for (const char* name : {"B2", "C3"}) point(m, name, {0, 0, 740});
  for (const char* name : {"B3", "C4"}) point(m, name, {0, 0, 1140});
  axis(m, "B2").direction = {0, -1, 0};
  tool(m, {0, 0, 1266}, {0, 0, 80});
  m.tool_direction = {0, 0, -1};
  return m;
}

namespace {

void couple(Machine& m, const char* axis_name, const char* of, double ratio) {
  m.couplings.push_back({m.find_axis(axis_name), m.find_axis(of), ratio});
}

}  // namespace

Machine coupled_arm() {
  Machine m = jointed_arm();
  m.name = "coupled arm";
  couple(m, "A2", "B3", 0.5);
  couple(m, "B2", "B1", -1);
  couple(m, "B3", "A1", 0.02);
  couple(m, "A2", "A1", -0.03);
  return m;
}

Machine coupled_seven_axis_arm() {
  Machine m = seven_axis_arm();
  m.name = "coupled seven-axis arm";
  couple(m, "B2", "B1", 1);
  couple(m, "C4", "B3", -0.25);
  return m;
}

Machine coupled_fork_head() {
  Machine m = gantry_fork_head();
  m.name = "coupled fork head";
  axis(m, "C").endless = false;
  travel(m, "C", -200, 200);
  couple(m, "A", "C", 0.1);
  couple(m, "Z", "A", 3);
  return m;
}

Machine single_axis(const std::string& chain) { return from_chain(chain, chain); }

std::vector<NamedMachine> all_machines() {
  std::vector<NamedMachine> machines;
  for (const Machine& m : {aguado_table(), wang_grinder(), liu_scanner(), trunnion_mill(), swivel_head_mill(),
                           head_table_mill(), gantry_fork_head(), lathe(), three_axis_mill(), moving_table_cmm(),
                           nutating_head_mill(), redundant_gantry(), three_axis_head(), single_axis("w b Z t"),
                           single_axis("w X' b t"), single_axis("w C' b t"), single_axis("w b B t")}) {
    machines.push_back({m.name, m});
  }
  machines.push_back({"Yin U", yin_engraver('U')});
  machines.push_back({"Yin P", yin_engraver('P')});
  return machines;
}

std::vector<double> random_commands(const Machine& machine, std::mt19937_64& generator) {
  std::vector<double> commands;
  for (const Axis& a : machine.axes) {
    const double from = a.endless ? -2 * std::numbers::pi : a.travel_min;
    const double to = a.endless ? 2 * std::numbers::pi : a.travel_max;
    commands.push_back(std::uniform_real_distribution<double>(from, to)(generator));
  }
  return commands;
}

}  // namespace abbe::test
