#include "abbe/history/machine_history.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <utility>

#include "abbe/errors/error_states.h"
#include "abbe/formats/files/results_files.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/calendar_date.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/history/sqlite_database.h"
#include "abbe/report/version.h"

namespace abbe {
namespace {

constexpr std::int64_t kApplication = 0x41626265;  // "Abbe", in the header of the file
// An abbe that knows form 1 alone refuses errors with states, campaign by campaign. It says more if the form is later.
constexpr std::int64_t kFormWithoutStates = 1, kForm = 2;

std::string now_text() {
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  const auto today = std::chrono::floor<std::chrono::days>(now);
  const std::chrono::hh_mm_ss time(now - today);
  return fmt::format("{}T{:02}:{:02}:{:02}Z", date_text(today), time.hours().count(), time.minutes().count(),
                     time.seconds().count());
}

std::string bytes_of(const Eigen::MatrixXd& covariance) {
  std::string bytes(static_cast<std::size_t>(covariance.size()) * sizeof(double), '\0');
  if (!bytes.empty()) std::memcpy(bytes.data(), covariance.data(), bytes.size());
  return bytes;
}

std::int64_t number_of(SqliteDatabase& database, std::string_view sql) {
  SqliteStatement statement(database, sql);
  return statement.step() ? statement.integer(0) : 0;
}

void require_history(SqliteDatabase& database) {
  const std::int64_t application = number_of(database, "PRAGMA application_id");
  const std::int64_t form = number_of(database, "PRAGMA user_version");
  if (application != kApplication) {
    throw InputError({.file = database.path()}, "this is the database of another program",
                     "a file that abbe history add has made");
  }
  if (form > kForm) {
    throw InputError({.file = database.path()}, fmt::format("a later abbe has made it (form {})", form),
                     fmt::format("form {}, or a later abbe", kForm));
  }
}

void make_history(SqliteDatabase& database) {
  database.run(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {};", kApplication, kFormWithoutStates));
  database.run(
      "CREATE TABLE campaign (number INTEGER PRIMARY KEY AUTOINCREMENT, name TEXT NOT NULL, measured TEXT NOT NULL, "
      "added TEXT NOT NULL, abbe_version TEXT NOT NULL, source TEXT NOT NULL, machine_toml TEXT NOT NULL, "
      "errors_toml TEXT NOT NULL, covariance BLOB NOT NULL, summary_json TEXT NOT NULL)");
}

[[noreturn]] void refuse_machine(const CampaignToKeep& one, const std::string& other, const std::string& chain) {
  throw InputError({.file = one.campaign.errors_file},
                   fmt::format("its machine is {}, and that of {} is {}", one.campaign.machine.chain(), other, chain),
                   "campaigns of one machine; another machine has a history of its own");
}

/// One campaign that cannot be read again would make the whole history unreadable.
void require_readable(const IdentifiedCampaign& one) {
  const Machine machine = parse_machine(machine_text(one.machine), one.errors_file);
  static_cast<void>(
      parse_errors(errors_text(one.machine, one.errors), one.errors_file, machine, StatesOfErrors::allowed));
}

/// What can be wrong with campaigns whatever is in the history: before a file is made.
void check_campaigns(const std::vector<CampaignToKeep>& campaigns) {
  if (campaigns.empty()) throw InputError({.field = "campaigns"}, "there is nothing to add", "one or more");
  for (const CampaignToKeep& one : campaigns) require_readable(one.campaign);
  for (std::size_t i = 1; i < campaigns.size(); ++i) {
    const IdentifiedCampaign& one = campaigns[i].campaign;
    const IdentifiedCampaign& first = campaigns[0].campaign;
    if (one.machine.chain() != first.machine.chain()) refuse_machine(campaigns[i], first.name, first.machine.chain());
    for (std::size_t k = 0; k < i; ++k) {
      const IdentifiedCampaign& other = campaigns[k].campaign;
      if (errors_text(one.machine, one.errors) != errors_text(other.machine, other.errors)) continue;
      if (bytes_of(one.errors.covariance) != bytes_of(other.errors.covariance)) continue;
      throw InputError({.file = one.errors_file}, "these are the errors of " + other.name, "each campaign once");
    }
  }
}

/// The machine of the first campaign in the history is that of all.
void require_same_machine(SqliteDatabase& database, const std::vector<CampaignToKeep>& campaigns) {
  SqliteStatement first(database, "SELECT machine_toml, name FROM campaign ORDER BY number LIMIT 1");
  if (!first.step()) return;
  const std::string chain = parse_machine(first.text(0), database.path()).chain();
  for (const CampaignToKeep& one : campaigns) {
    if (one.campaign.machine.chain() != chain) refuse_machine(one, first.text(1) + " in the history", chain);
  }
}

std::int64_t add_one(SqliteDatabase& database, const CampaignToKeep& one, const std::string& added) {
  const std::string machine = machine_text(one.campaign.machine);
  const std::string errors = errors_text(one.campaign.machine, one.campaign.errors);
  const std::string covariance = bytes_of(one.campaign.errors.covariance);
  SqliteStatement same(database, "SELECT name, measured FROM campaign WHERE errors_toml = ?1 AND covariance = ?2");
  same.bind(errors).bind_bytes(covariance);
  if (same.step()) {
    throw InputError({.file = one.campaign.errors_file},
                     fmt::format("these errors are in the history already, as {} of {}", same.text(0), same.text(1)),
                     "a campaign that is new");
  }
  SqliteStatement insert(database,
                         "INSERT INTO campaign (name, measured, added, abbe_version, source, machine_toml, "
                         "errors_toml, covariance, summary_json) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)");
  insert.bind(one.campaign.name).bind(date_text(one.measured)).bind(added).bind(version_text()).bind(one.source);
  insert.bind(machine).bind(errors).bind_bytes(covariance).bind(one.summary);
  insert.step();
  return number_of(database, "SELECT last_insert_rowid()");
}

void require_file_name(const std::string& path) {
  if (path.empty() || path == "-") {
    throw InputError({.field = "history"}, "is not the name of a file", "a file such as mill.history");
  }
}

/// SQLite takes an empty file for a new database, and does not say that a file is missing.
void require_contents(const std::string& path) {
  const char* const expected = "a file that abbe history add has made";
  std::error_code problem;
  if (!std::filesystem::exists(path, problem) && !problem) {
    throw InputError({.file = path}, "there is no such file", expected);
  }
  if (std::filesystem::file_size(path, problem) == 0) throw InputError({.file = path}, "the file is empty", expected);
}

}  // namespace

Date date_of(const std::string& text, const std::string& field) {
  if (const std::optional<CalendarDate> date = parse_calendar_date(text)) return *date;
  throw InputError({.field = field}, fmt::format("'{}' is not a date", text.substr(0, 40)),
                   "year-month-day, such as 2026-03-02");
}

std::string date_text(Date date) { return calendar_date_text(date); }

CampaignToKeep campaign_to_keep(const std::string& path, const std::string& machine_file, Date measured) {
  std::optional<Machine> machine;
  if (!machine_file.empty()) machine = read_machine(machine_file);
  CampaignToKeep result;
  result.campaign = read_campaign(path, machine, StatesOfErrors::allowed);
  result.measured = measured;
  result.source = path;
  if (is_results_folder(path)) result.summary = results_summary_text(path);
  return result;
}

std::vector<std::int64_t> add_to_history(const std::string& path, const std::vector<CampaignToKeep>& campaigns) {
  require_file_name(path);
  check_campaigns(campaigns);
  SqliteDatabase database(path, SqliteDatabase::Access::create);
  SqliteTransaction transaction(database);
  const bool is_new = number_of(database, "SELECT count(*) FROM sqlite_master") == 0 &&
                      number_of(database, "PRAGMA application_id") == 0;
  if (is_new) {
    make_history(database);
  } else {
    require_history(database);
  }
  require_same_machine(database, campaigns);
  const std::string added = now_text();
  std::vector<std::int64_t> numbers;
  numbers.reserve(campaigns.size());
  for (const CampaignToKeep& one : campaigns) {
    numbers.push_back(add_one(database, one, added));
    if (has_states(one.campaign.errors.errors)) database.run(fmt::format("PRAGMA user_version = {};", kForm));
  }
  transaction.commit();
  return numbers;
}

std::vector<KeptCampaign> read_history(const std::string& path) {
  require_file_name(path);
  require_contents(path);
  // What a program that was killed has begun is undone by the next one that may write.
  const bool may_write = access(path.c_str(), W_OK) == 0;
  SqliteDatabase database(path, may_write ? SqliteDatabase::Access::write : SqliteDatabase::Access::read);
  require_history(database);
  SqliteStatement rows(database,
                       "SELECT number, name, measured, added, abbe_version, source, machine_toml, errors_toml, "
                       "covariance, summary_json FROM campaign ORDER BY measured, number");
  std::vector<KeptCampaign> result;
  while (rows.step()) {
    KeptCampaign kept;
    kept.number = rows.integer(0);
    kept.campaign.name = rows.text(1);
    const std::string where = fmt::format("{}, campaign {}", path, kept.number);
    kept.campaign.errors_file = where;
    kept.measured = date_of(rows.text(2), where);
    kept.added = rows.text(3);
    kept.abbe_version = rows.text(4);
    kept.source = rows.text(5);
    kept.campaign.machine = parse_machine(rows.text(6), where);
    kept.campaign.errors = parse_errors(rows.text(7), where, kept.campaign.machine, StatesOfErrors::allowed);
    const std::string covariance = rows.text(8);
    const std::size_t p = kept.campaign.errors.errors.parameter_count();
    if (covariance.size() == p * p * sizeof(double)) {
      kept.campaign.errors.covariance.resize(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(p));
      std::memcpy(kept.campaign.errors.covariance.data(), covariance.data(), covariance.size());
    } else if (!covariance.empty()) {
      throw InputError({.file = where}, "its covariance has another size than its errors", "an undamaged history");
    }
    kept.summary = rows.text(9);
    result.push_back(std::move(kept));
  }
  return result;
}

KeptCampaign campaign_of_history(const std::string& path, std::int64_t number) {
  for (KeptCampaign& one : read_history(path)) {
    if (one.number == number) return std::move(one);
  }
  throw InputError({.field = "--campaign"}, fmt::format("there is no campaign {} in {}", number, path),
                   "a number that abbe history list shows");
}

std::vector<std::pair<std::string, std::string>> campaign_files(const KeptCampaign& campaign) {
  const Machine& machine = campaign.campaign.machine;
  const ErrorsFile& errors = campaign.campaign.errors;
  const bool has_covariance = errors.covariance.size() > 0;
  constexpr const char* kCovariance = "errors.covariance.csv";
  std::vector<std::pair<std::string, std::string>> files = {
      {"machine.toml", machine_text(machine)},
      {"errors.toml", errors_text(machine, errors, has_covariance ? kCovariance : "")}};
  if (has_covariance) files.emplace_back(kCovariance, covariance_text(machine, errors));
  if (!campaign.summary.empty()) files.emplace_back("summary.json", campaign.summary);
  return files;
}

}  // namespace abbe
