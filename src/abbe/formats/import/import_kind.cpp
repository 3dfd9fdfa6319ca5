#include "abbe/formats/import/import_kind.h"

#include <fmt/format.h>

#include <array>
#include <initializer_list>

#include "abbe/formats/import/foreign_word.h"
#include "abbe/formats/machine/error_fields.h"

namespace abbe {
namespace {

using Words = std::vector<std::string>;
using Holds = ImportColumn::Holds;

constexpr std::array<std::string_view, 5> kImportKinds = {"points", "tracker", "positioning", "circular",
                                                          "temperatures"};

/// "soll ?" for one letter or name of an axis.
Words with_name(std::initializer_list<const char*> patterns, std::string_view name) {
  Words words;
  for (std::string word : patterns) {
    word.replace(word.find('?'), 1, small_letters(name));
    words.push_back(std::move(word));
  }
  return words;
}

Words coordinate_words(std::string_view letter) {
  Words words = with_name({"measured ?", "? measured",   "meas ?",       "? meas",       "?",
                           "actual ?",   "? actual",     "act ?",        "? act",        "ist ?",
                           "? ist",      "istwert ?",    "? istwert",    "gemessen ?",   "? gemessen",
                           "messwert ?", "? messwert",   "coordinate ?", "? coordinate", "coord ?",
                           "? coord",    "koordinate ?", "? koordinate", "position ?",   "? position",
                           "pos ?",      "? pos",        "point ?",      "punkt ?",      "center ?",
                           "centre ?",   "mitte ?",      "smr ?",        "? smr",        "tracker ?",
                           "? tracker",  "laser ?",      "? laser",      "lt ?",         "? lt",
                           "xlt ?",      "? value",      "wert ?"},
                          letter);
  // Geodetic names: easting, northing and height are right-handed in this order.
  if (letter == "x") words.insert(words.end(), {"easting", "rechtswert", "ostwert"});
  if (letter == "y") words.insert(words.end(), {"northing", "hochwert", "nordwert"});
  if (letter == "z") words.insert(words.end(), {"height", "höhe", "hoehe"});
  return words;
}

Words command_words(std::string_view axis) {
  return with_name(
      {"command ?",  "? command",  "commanded ?",    "? commanded",    "cmd ?",      "? cmd",      "soll ?",  "? soll",
       "sollwert ?", "? sollwert", "sollposition ?", "? sollposition", "nominal ?",  "? nominal",  "nom ?",   "? nom",
       "target ?",   "? target",   "set ?",          "? set",          "axis ?",     "? axis",     "achse ?", "? achse",
       "joint ?",    "? joint",    "machine ?",      "? machine",      "maschine ?", "? maschine", "mcs ?",   "? mcs",
       "?"},
      axis);
}

const Words kPointWords = {"point",    "point name", "pointname", "point id",   "point no",  "point number", "name",
                           "pt",       "pt name",    "pt id",     "punkt",      "punktname", "punktnummer",  "punktnr",
                           "punkt nr", "punkt id",   "messpunkt", "mess punkt", "label",     "bezeichnung",  "feature",
                           "merkmal",  "id",         "nr",        "no",         "number",    "nummer",       "lfd nr"};
const Words kTimeWords = {"time", "t", "zeit", "elapsed", "elapsed time", "messzeit"};

void add_point_name(std::vector<ImportColumn>& columns) {
  columns.push_back({"point", Quantity::dimensionless, Holds::label, false, "", kPointWords});
}

std::vector<ImportColumn> point_columns() {
  std::vector<ImportColumn> columns;
  add_point_name(columns);
  for (const char* const letter : {"x", "y", "z"}) {
    columns.push_back({letter, Quantity::length, Holds::number, true, "", coordinate_words(letter)});
  }
  for (const char* const letter : {"x", "y", "z"}) {
    columns.push_back({fmt::format("n{}", letter), Quantity::dimensionless, Holds::number, false, "normal",
                       with_name({"n?", "normal ?", "? normal", "i?", "normale ?"}, letter)});
  }
  return columns;
}

std::vector<ImportColumn> tracker_columns(const Machine& machine) {
  std::vector<ImportColumn> columns;
  add_point_name(columns);
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    columns.push_back({axis.name, axis_quantity(axis), Holds::number, true, "", command_words(axis.name), axis.name});
  }
  columns.push_back({"station",
                     Quantity::dimensionless,
                     Holds::name,
                     false,
                     "",
                     {"station", "station name", "standpunkt", "instrument", "tracker"}});
  columns.push_back({"reflector",
                     Quantity::dimensionless,
                     Holds::name,
                     false,
                     "",
                     {"reflector", "reflektor", "smr", "target", "target name", "ziel", "prism", "prisma"}});
  for (const char* const letter : {"x", "y", "z"}) {
    columns.push_back({fmt::format("offset_{}", letter), Quantity::length, Holds::number, false, "offset",
                       with_name({"offset ?", "? offset", "tool ?", "? tool", "werkzeug ?"}, letter)});
  }
  for (const char* const letter : {"x", "y", "z"}) {
    columns.push_back({fmt::format("measured_{}", letter), Quantity::length, Holds::number, false, "point",
                       coordinate_words(letter), letter});
  }
  columns.push_back({"range",
                     Quantity::length,
                     Holds::number,
                     false,
                     "polar",
                     {"range", "distance", "slope distance", "dist", "sd", "schrägdistanz", "schraegdistanz",
                      "schrägstrecke", "strecke", "distanz", "entfernung", "d", "r"}});
  columns.push_back({"azimuth",
                     Quantity::angle,
                     Holds::number,
                     false,
                     "polar",
                     {"azimuth", "az", "azimut", "horizontal angle", "hz", "hz angle", "h angle", "ha", "hor angle",
                      "horizontal", "horizontalwinkel", "horizontalrichtung", "hz winkel", "richtung", "bearing",
                      "azimuth clockwise", "azimuth cw"}});
  columns.push_back({"elevation",
                     Quantity::angle,
                     Holds::number,
                     false,
                     "polar",
                     {"elevation",
                      "el",
                      "elev",
                      "vertical angle",
                      "v",
                      "v angle",
                      "va",
                      "vz",
                      "ver angle",
                      "vertical",
                      "zenith",
                      "zenith angle",
                      "zenith distance",
                      "zen",
                      "zenit",
                      "zenitwinkel",
                      "zenitdistanz",
                      "höhenwinkel",
                      "hoehenwinkel",
                      "vertikalwinkel",
                      "v winkel"}});
  for (const char* const letter : {"x", "y", "z"}) {
    columns.push_back(
        {fmt::format("u_{}", letter), Quantity::length, Holds::number, false, "u of the point",
         with_name({"u ?", "? u", "sigma ?", "? sigma", "std ?", "? std", "stdev ?", "? stdev"}, letter)});
  }
  columns.push_back({"time", Quantity::time, Holds::number, false, "", kTimeWords});
  for (const Axis& axis : machine.axes) {
    columns.push_back({fmt::format("{}_approach", axis.name),
                       Quantity::dimensionless,
                       Holds::number,
                       false,
                       "",
                       {comparable_word(axis.name + " approach")}});
  }
  return columns;
}

const Words kDeviationWords = {"deviation",
                               "abweichung",
                               "positionsabweichung",
                               "positionierabweichung",
                               "error",
                               "position error",
                               "positioning error",
                               "fehler",
                               "err",
                               "dev",
                               "difference",
                               "differenz"};

std::vector<ImportColumn> circular_columns_of_import() {
  Words deviation = {"radial deviation", "radial error", "radiusabweichung", "radialabweichung"};
  deviation.insert(deviation.end(), kDeviationWords.begin(), kDeviationWords.end());
  std::vector<ImportColumn> columns = {
      {"direction",
       Quantity::dimensionless,
       Holds::rotation,
       true,
       "",
       {"direction", "dir", "richtung", "drehrichtung", "drehsinn", "rotation", "sense", "cw ccw"}},
      {"angle",
       Quantity::angle,
       Holds::number,
       false,
       "",
       {"angle", "winkel", "path angle", "bahnwinkel", "commanded angle", "sollwinkel", "position"}},
      {"deviation", Quantity::length, Holds::number, false, "", std::move(deviation)},
      {"radius",
       Quantity::length,
       Holds::number,
       false,
       "",
       {"radius", "measured radius", "actual radius", "istradius", "bar length", "length", "länge", "laenge"}}};
  for (const char* const letter : {"X", "Y", "Z"}) {
    columns.push_back({letter, Quantity::length, Holds::number, false, "", coordinate_words(small_letters(letter))});
  }
  return columns;
}

/// Temperatures have a unit of their own, which is a part of the name.
std::vector<ImportColumn> temperature_columns() {
  return {{"time", Quantity::dimensionless, Holds::name, true, "", {"time", "timestamp", "zeit", "zeitpunkt"}},
          {"sensor", Quantity::dimensionless, Holds::name, true, "", {"sensor", "fühler", "channel", "kanal"}},
          {"temperature_degC",
           Quantity::dimensionless,
           Holds::number,
           true,
           "",
           {"temperature degc", "temperatur degc", "temperature celsius", "temperature °c"}}};
}

std::vector<ImportColumn> positioning_columns() {
  const Words target = {"target",       "target position",  "soll",         "sollposition", "sollwert",
                        "nominal",      "nominal position", "commanded",    "command",      "programmed",
                        "zielposition", "zielpunkt",        "messposition", "position",     "pos"};
  const Words actual = {"actual",   "actual position",   "ist",     "istposition", "istwert",
                        "measured", "measured position", "reading", "messwert",    "gemessen"};
  std::vector<ImportColumn> columns = {
      {"run",
       Quantity::dimensionless,
       Holds::name,
       false,
       "",
       {"run", "run no", "lauf", "cycle", "zyklus", "durchlauf", "messlauf", "pass", "repeat", "repetition",
        "wiederholung", "series", "serie", "messreihe"}},
      {"direction",
       Quantity::dimensionless,
       Holds::direction,
       true,
       "",
       {"direction", "dir", "richtung", "approach", "anfahrrichtung", "verfahrrichtung", "sense"}}};
  for (const Quantity quantity : {Quantity::length, Quantity::angle}) {
    columns.push_back({"target", quantity, Holds::number, false, "", target});
  }
  for (const Quantity quantity : {Quantity::length, Quantity::angle}) {
    columns.push_back({"deviation", quantity, Holds::number, false, "", kDeviationWords});
  }
  for (const Quantity quantity : {Quantity::length, Quantity::angle}) {
    columns.push_back({"actual", quantity, Holds::number, false, "", actual});
  }
  return columns;
}

}  // namespace

std::string_view import_kind_name(ImportKind kind) { return kImportKinds[static_cast<std::size_t>(kind)]; }

std::optional<ImportKind> import_kind_named(std::string_view name) {
  for (std::size_t i = 0; i < kImportKinds.size(); ++i) {
    if (kImportKinds[i] == name) return static_cast<ImportKind>(i);
  }
  return std::nullopt;
}

std::vector<std::string> import_kind_names() { return {kImportKinds.begin(), kImportKinds.end()}; }

std::vector<std::string_view> convention_names() { return {"as-written", "reversed", "zenith", "clockwise"}; }

std::string_view convention_name(ImportConvention convention) {
  return convention_names()[static_cast<std::size_t>(convention)];
}

std::vector<ImportColumn> import_columns(ImportKind kind, const Machine& machine) {
  switch (kind) {
    case ImportKind::points:
      return point_columns();
    case ImportKind::tracker:
      return tracker_columns(machine);
    case ImportKind::circular:
      return circular_columns_of_import();
    case ImportKind::temperatures:
      return temperature_columns();
    case ImportKind::positioning:
      break;
  }
  return positioning_columns();
}

std::string import_header(const ImportColumn& column, std::string_view suffix) {
  return suffix.empty() ? column.base : fmt::format("{}_{}", column.base, suffix);
}

}  // namespace abbe
