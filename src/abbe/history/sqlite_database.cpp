#include "abbe/history/sqlite_database.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <utility>

#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

// Another program that adds a campaign holds the file for milliseconds.
constexpr int kWaitMilliseconds = 30'000;

}  // namespace

SqliteStatement::SqliteStatement(SqliteDatabase& database, std::string_view sql) : database_(database) {
  sqlite3_stmt* statement = nullptr;
  const int result =
      sqlite3_prepare_v2(database.handle(), sql.data(), static_cast<int>(sql.size()), &statement, nullptr);
  statement_.reset(statement);
  if (result != SQLITE_OK) database.fail(result);
}

void SqliteStatement::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

SqliteStatement& SqliteStatement::bind(std::string_view text) {
  const int result =
      sqlite3_bind_text64(statement_.get(), ++bound_, text.data(), text.size(), SQLITE_TRANSIENT, SQLITE_UTF8);
  if (result != SQLITE_OK) database_.fail(result);
  return *this;
}

SqliteStatement& SqliteStatement::bind(std::int64_t number) {
  const int result = sqlite3_bind_int64(statement_.get(), ++bound_, number);
  if (result != SQLITE_OK) database_.fail(result);
  return *this;
}

SqliteStatement& SqliteStatement::bind_bytes(std::string_view bytes) {
  const int result = sqlite3_bind_blob64(statement_.get(), ++bound_, bytes.data(), bytes.size(), SQLITE_TRANSIENT);
  if (result != SQLITE_OK) database_.fail(result);
  return *this;
}

SqliteStatement& SqliteStatement::bind_nothing() {
  const int result = sqlite3_bind_null(statement_.get(), ++bound_);
  if (result != SQLITE_OK) database_.fail(result);
  return *this;
}

bool SqliteStatement::step() {
  const int result = sqlite3_step(statement_.get());
  if (result == SQLITE_ROW) return true;
  if (result != SQLITE_DONE) database_.fail(result);
  return false;
}

std::string SqliteStatement::text(int column) const {
  const auto* const bytes = static_cast<const char*>(sqlite3_column_blob(statement_.get(), column));
  const int size = sqlite3_column_bytes(statement_.get(), column);
  return bytes == nullptr ? std::string() : std::string(bytes, static_cast<std::size_t>(size));
}

std::int64_t SqliteStatement::integer(int column) const { return sqlite3_column_int64(statement_.get(), column); }

bool SqliteStatement::is_null(int column) const { return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL; }

SqliteDatabase::SqliteDatabase(std::string path, Access access) : path_(std::move(path)) {
  const int flags = access == Access::read    ? SQLITE_OPEN_READONLY
                    : access == Access::write ? SQLITE_OPEN_READWRITE
                                              : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  sqlite3* handle = nullptr;
  const int result = sqlite3_open_v2(path_.c_str(), &handle, flags, nullptr);
  handle_.reset(handle);
  if (result != SQLITE_OK) fail(result);
  sqlite3_busy_timeout(handle, kWaitMilliseconds);
}

void SqliteDatabase::Close::operator()(sqlite3* handle) const { sqlite3_close(handle); }

void SqliteDatabase::run(std::string_view sql) {
  const int result = sqlite3_exec(handle_.get(), std::string(sql).c_str(), nullptr, nullptr, nullptr);
  if (result != SQLITE_OK) fail(result);
}

void SqliteDatabase::fail(int result) const {
  const char* const words = handle_ ? sqlite3_errmsg(handle_.get()) : sqlite3_errstr(result);
  switch (result & 0xff) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      throw InputError({.file = path_},
                       fmt::format("another program has been writing it for {} s", kWaitMilliseconds / 1000),
                       "a history that nobody writes for so long");
    case SQLITE_NOTADB:
      throw InputError({.file = path_}, "this is not a history", "a file that abbe history add has made");
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
    case SQLITE_READONLY:
      throw InputError({.file = path_}, fmt::format("cannot be opened: {}", words),
                       "a file in a folder that can be read and written");
    case SQLITE_FULL:
    case SQLITE_IOERR:
      throw InputError({.file = path_}, fmt::format("could not be written, and is as it was: {}", words),
                       "space on the disk");
    default:
      throw InputError({.file = path_}, fmt::format("cannot be used: {}", words), "a history of abbe");
  }
}

SqliteTransaction::SqliteTransaction(SqliteDatabase& database) : database_(database) {
  database_.run("BEGIN IMMEDIATE");
}

SqliteTransaction::~SqliteTransaction() {
  if (is_open_) sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
}

void SqliteTransaction::commit() {
  database_.run("COMMIT");
  is_open_ = false;
}

}  // namespace abbe
