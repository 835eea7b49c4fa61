// SPDX-License-Identifier: MIT
// Reads the messages of .db3 files; declared in bag.h.
#include <map>

#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/formats/rosbag/bag.h"
#ifdef E2LF_HAVE_SQLITE
#include <sqlite3.h>
#endif

namespace e2lf::formats::rosbag {

#ifdef E2LF_HAVE_SQLITE
namespace {

/// Pages of a damaged database may form a cycle. A statement that takes more steps than this between two rows is
/// aborted, and also after a stop request.
constexpr int kStepsPerLook = 1'000'000;
constexpr int kMaxLooks = 20;

struct Closer {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, Closer>;
using Statement = std::unique_ptr<sqlite3_stmt, Closer>;

/// Returns the path as a URI, in which special characters are escaped.
std::string uri_of(const std::filesystem::path& path) {
  std::string uri = "file:";
  for (const char c : std::filesystem::absolute(path).string()) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 || c == '/' || c == '.' || c == '_' || c == '-') {
      uri += c;
    } else {
      uri += formatted("%%%02X", byte);
    }
  }
  // A recorder that was killed left the last messages in a journal, which only a writable database reads.
  std::error_code error;
  std::filesystem::path journal = path;
  journal += "-wal";
  return uri + (std::filesystem::exists(journal, error) ? "?mode=ro" : "?mode=ro&immutable=1");
}

class SqliteBag final : public Bag {
 public:
  SqliteBag(SourcePtr source) : name_(source->name()), source_(std::move(source)) {}

  Result<void> open() {
    sqlite3* database = nullptr;
    const bool is_file = !source_->path().empty();
    const std::string uri = is_file ? uri_of(source_->path()) : ":memory:";
    const int flags = SQLITE_OPEN_URI | (is_file ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE);
    const int state = sqlite3_open_v2(uri.c_str(), &database, flags, nullptr);
    database_.reset(database);
    if (state != SQLITE_OK) return failure();
    if (!is_file) E2LF_RETURN_IF_ERROR(read_into_memory());
    // The file has no control: no code of its schema is run, and nothing larger than a message is allocated.
    sqlite3_db_config(database, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(database, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
    sqlite3_limit(database, SQLITE_LIMIT_LENGTH, static_cast<int>(kMaxMessageBytes));
    sqlite3_progress_handler(database, kStepsPerLook, &SqliteBag::look, this);
    E2LF_RETURN_IF_ERROR(read_topics());
    return rewind();
  }

  std::vector<Topic> topics() const override {
    std::vector<Topic> all;
    for (const auto& [id, topic] : topics_) all.push_back(topic);
    return all;
  }

  Result<bool> next(BagMessage& message, DecodeSummary& summary) override {
    while (messages_ != nullptr) {
      looks_ = 0;
      const int state = sqlite3_step(messages_.get());
      if (state != SQLITE_ROW) {
        messages_.reset();
        if (state != SQLITE_DONE && !stop_requested()) summary.add(Violation::kTruncated, row_);
        return false;
      }
      row_ = static_cast<uint64_t>(sqlite3_column_int64(messages_.get(), 0));
      const auto topic = topics_.find(sqlite3_column_int64(messages_.get(), 1));
      if (topic == topics_.end()) continue;
      const void* const data = sqlite3_column_blob(messages_.get(), 2);
      const auto size = static_cast<size_t>(sqlite3_column_bytes(messages_.get(), 2));
      message = {&topic->second, {static_cast<const uint8_t*>(data), data == nullptr ? 0 : size}, row_};
      return true;
    }
    return false;
  }

  Result<void> rewind() override { return prepare("SELECT id, topic_id, data FROM messages ORDER BY id", messages_); }

 private:
  static int look(void* self) {
    auto* const bag = static_cast<SqliteBag*>(self);
    return ++bag->looks_ > kMaxLooks || stop_requested() ? 1 : 0;
  }

  Error failure() const {
    const char* const why = database_ == nullptr ? "no memory" : sqlite3_errmsg(database_.get());
    return fail(ErrorCode::kFormat, name_, "SQLite cannot read this as a bag of ROS 2 (", why,
                "); it is not one, or incomplete; copy it again");
  }

  Result<void> prepare(const char* query, Statement& statement) const {
    sqlite3_stmt* prepared = nullptr;
    const int state = sqlite3_prepare_v2(database_.get(), query, -1, &prepared, nullptr);
    statement.reset(prepared);
    return state == SQLITE_OK ? Result<void>() : failure();
  }

  Result<void> read_into_memory() {
    E2LF_ASSIGN_OR_RETURN(bytes_, read_rest(*source_));
    const auto size = static_cast<sqlite3_int64>(bytes_.size());
    const int state =
        sqlite3_deserialize(database_.get(), "main", bytes_.data(), size, size, SQLITE_DESERIALIZE_READONLY);
    return state == SQLITE_OK ? Result<void>() : failure();
  }

  Result<void> read_topics() {
    Statement statement;
    E2LF_RETURN_IF_ERROR(prepare("SELECT id, name, type FROM topics ORDER BY id LIMIT 10000", statement));
    const auto text = [&statement](int column) {
      const auto* const value = reinterpret_cast<const char*>(sqlite3_column_text(statement.get(), column));
      return std::string(value == nullptr ? "" : value);
    };
    int state = SQLITE_ROW;
    while ((state = sqlite3_step(statement.get())) == SQLITE_ROW) {
      Topic topic{text(1), text(2)};
      if (is_event_type(topic.type)) topics_[sqlite3_column_int64(statement.get(), 0)] = std::move(topic);
    }
    return state == SQLITE_DONE ? Result<void>() : failure();
  }

  std::string name_;
  SourcePtr source_;
  std::vector<uint8_t> bytes_;  ///< of a database that is in memory; outlives it
  Database database_;
  Statement messages_;  ///< null after the last one
  std::map<int64_t, Topic> topics_;
  uint64_t row_ = 0;
  int looks_ = 0;
};

}  // namespace

Result<BagPtr> open_sqlite_bag(SourcePtr source) {
  auto bag = std::make_unique<SqliteBag>(std::move(source));
  E2LF_RETURN_IF_ERROR(bag->open());
  return BagPtr(std::move(bag));
}

#else

Result<BagPtr> open_sqlite_bag(SourcePtr source) {
  return fail(ErrorCode::kMissingDependency, source->name(),
              "this is a bag of ROS 2 stored by SQLite; build with libsqlite3-dev installed, or convert it to MCAP");
}

#endif

}  // namespace e2lf::formats::rosbag
