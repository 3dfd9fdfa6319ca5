#pragma once

// Internal to history: a database in one file, by SQLite.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

namespace abbe {

class SqliteDatabase;

/// A statement that is run row by row. It must not outlive its database.
class SqliteStatement {
 public:
  SqliteStatement(SqliteDatabase& database, std::string_view sql);

  /// Values of the parameters ?1, ?2, ... in order.
  SqliteStatement& bind(std::string_view text);
  SqliteStatement& bind(std::int64_t number);
  SqliteStatement& bind_bytes(std::string_view bytes);
  SqliteStatement& bind_nothing();

  /// The next row. @return false after the last
  bool step();
  std::string text(int column) const;
  std::int64_t integer(int column) const;
  bool is_null(int column) const;

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  SqliteDatabase& database_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  int bound_ = 0;
};

/// A database file. Messages are about the file.
class SqliteDatabase {
 public:
  enum class Access { read, write, create };
  /// @throws InputError if the file cannot be opened, or is no database
  SqliteDatabase(std::string path, Access access);

  void run(std::string_view sql);
  const std::string& path() const { return path_; }
  sqlite3* handle() const { return handle_.get(); }
  /// Throws InputError for a result of SQLite that is no success: busy for a long time, a full disk, damaged.
  [[noreturn]] void fail(int result) const;

 private:
  struct Close {
    void operator()(sqlite3* handle) const;
  };
  std::string path_;
  std::unique_ptr<sqlite3, Close> handle_;
};

/// Everything until commit(), or nothing of it. Other writers wait.
class SqliteTransaction {
 public:
  explicit SqliteTransaction(SqliteDatabase& database);
  ~SqliteTransaction();
  SqliteTransaction(const SqliteTransaction&) = delete;
  SqliteTransaction& operator=(const SqliteTransaction&) = delete;
  void commit();

 private:
  SqliteDatabase& database_;
  bool is_open_ = true;
};

}  // namespace abbe
